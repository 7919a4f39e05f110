# SPDX-License-Identifier: LGPL-2.1-or-later
"""Measured curves, and the moments of a run that their rows belong to."""

import dataclasses
import math
import pathlib

from .command import FileError, SceneError

QUANTITIES = {  # name: unit, label in pictures, factor from the unit to that of the label
    "elongation": ("", "elongation [%]", 100), "plastic_elongation": ("", "plastic elongation [%]", 100),
    "twist_deg": ("deg", "twist [°]", 1), "plastic_twist_deg": ("deg", "plastic twist [°]", 1),
    "force": ("N", "force [N]", 1)}
OF_CURRENT = ("elongation", "twist_deg")  # history.csv calls them current_...
MIN_ROWS = 2
SAME_MOMENT = 1e-6  # of a step: the running time is rounded
SAME_FORCE = 1e-9  # of the largest


@dataclasses.dataclass
class Column:
    """unit and label of a probe are known when the scene is."""

    name: str
    is_probe: bool
    unit: str
    label: str
    shown_scale: float = 1
    values: list = dataclasses.field(default_factory=list)

    @property
    def greatest(self):
        """Size of the largest value."""
        return max(map(abs, self.values))

    @property
    def measure(self):
        """Its name in streams of states."""
        return f"current_{self.name}" if self.name in OF_CURRENT else self.name


def column_named(text):
    name = text.removeprefix("current_") if text.removeprefix("current_") in OF_CURRENT else text
    if name in QUANTITIES:
        unit, label, scale = QUANTITIES[name]
        return Column(name, False, unit, label, scale)
    name = text.removeprefix("probe_")
    return Column(name, True, "", name)


@dataclasses.dataclass
class Target:
    """A curve over time, or, without times, over force."""

    file: str
    head_line: int
    columns: list
    lines: list = dataclasses.field(default_factory=list)  # of the file, per row
    times: list = dataclasses.field(default_factory=list)  # [s] ascending
    forces: list = dataclasses.field(default_factory=list)  # [N] in the order of the experiment

    def refuse(self, line, what):
        refuse(self.file, line, what)


def refuse(file, line, what):
    raise SceneError(f"{file}:{line}: error: {what}" if line else f"{file}: error: {what}")


def read_target(file, compare):
    """Reads a CSV file: a line of column names, then rows of numbers; empty lines and those that begin with # are passed over.
    compare: the columns that are compared; empty: all but the first of time and force. Raises FileError, and SceneError with
    file and line."""
    if pathlib.Path(file).exists() and not pathlib.Path(file).is_file():
        raise FileError(f"{file}: error: cannot be read: is not a file")
    try:
        lines = pathlib.Path(file).read_text("utf-8-sig", errors="replace").split("\n")
    except OSError as error:
        raise FileError(f"{file}: error: cannot be read: {error.strerror}") from None
    rows = [(number, [field.strip(" \t") for field in line.rstrip("\r ").split(",")])
            for number, line in enumerate(lines, 1) if line.rstrip("\r ") and not line.startswith("#")]
    if not rows:
        refuse(file, 0, "is empty: a line of column names and rows of numbers are needed")
    (head_line, names), *rows = rows
    if "time" not in names and "force" not in names:
        refuse(file, head_line, "no column is called time or force: the curve is over neither (the first line names columns)")
    is_over_time = "time" in names
    along = names.index("time" if is_over_time else "force")
    compare = [f"probe_{name}" if name not in names and f"probe_{name}" in names else name for name in compare]
    for name in compare:
        if name not in names or names.index(name) == along:
            refuse(file, head_line, f"no column that could be compared is called '{name}' (--compare)")
    compared = [names.index(name) for name in compare] or [c for c in range(len(names)) if c != along]
    target = Target(str(file), head_line, [])
    for c in compared:
        column = column_named(names[c])
        if column.name in [other.name for other in target.columns]:
            refuse(file, head_line, f"{column.name} is there twice")
        target.columns.append(column)
    if not compared:
        refuse(file, head_line, "no column to compare")

    axis = target.times if is_over_time else target.forces
    for line, fields in rows:
        def number(c, line=line, fields=fields):
            try:
                value = float(fields[c]) if "_" not in fields[c] else math.nan
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                refuse(file, line, f"{names[c]}: '{fields[c]}': must be a finite number")
            return value
        if len(fields) != len(names):
            refuse(file, line, f"{len(fields)} fields, must be {len(names)} as in the first line")
        at = number(along)
        if is_over_time and at < 0:
            refuse(file, line, f"time {at:g}: must not be negative")
        if is_over_time and axis and at <= axis[-1]:
            refuse(file, line, f"time {at:g} does not come after {axis[-1]:g}")
        axis.append(at)
        target.lines.append(line)
        for column, c in zip(target.columns, compared):
            column.values.append(number(c))
    if len(target.lines) < MIN_ROWS:
        refuse(file, 0, f"at least {MIN_ROWS} rows are needed")
    for column in target.columns:
        if not any(column.values):
            refuse(file, 0, f"{column.name} is zero in every row: nothing to fit to")
    return target


def find_columns(target, scene):
    """Gives columns of probes the units of the scene (as `hexaplast describe` tells it). Refuses what it does not measure."""
    units = {probe["name"]: probe["unit"] for probe in scene["probes"]}
    for column in target.columns:
        if column.is_probe and column.name not in units and f"probe_{column.name}" in units:
            column.name = column.label = f"probe_{column.name}"
        if column.is_probe and column.name not in units:
            target.refuse(target.head_line, f"column '{column.name}' is not known; comparable are "
                          f"{', '.join([*QUANTITIES, *units])}, and probes of the scene. --compare chooses some columns of "
                          "many")
        if column.is_probe and units[column.name]:
            column.unit = units[column.name]
            column.label = f"{column.name} [{column.unit}]"
    if scene["bodies"] > 1 and (not target.times or any(column.name == "force" and not column.is_probe
                                                        for column in target.columns)):
        target.refuse(target.head_line, f"column 'force': is that of the only body, and the scene has {scene['bodies']}; a "
                      "Probe of the scene can be compared over time")
    for column in target.columns:
        if not column.is_probe and column.name != "force" and not scene["ends"]:
            target.refuse(target.head_line, f"column '{column.name}': the scene does not stretch or twist its body by the two "
                          "ends, so that it has no elongation and twist; a Probe of the scene can be compared, or RunSettings "
                          "endSections=\"yes\" measures them all the same")


def moments_of(target, pulls, dt):
    """Times [s] of the rows of a curve over force: the first one, from that of the row before on, at which the loads have that
    force. pulls: of the loads per step [N]."""
    low, high = min(pulls), max(pulls)
    slack = SAME_FORCE * max(abs(low), abs(high))
    moments, start = [], 0.0  # in steps
    for force, line in zip(target.forces, target.lines):
        found = None
        for step in range(int(start), len(pulls) - 1):
            begin, end = pulls[step:step + 2]
            if force < min(begin, end) - slack or force > max(begin, end) + slack:
                continue
            is_held = abs(end - begin) <= slack
            at = step + (0 if is_held else min(max((force - begin) / (end - begin), 0.0), 1.0))
            if at >= start - SAME_MOMENT or is_held:
                found = max(at, start)
                break
        if found is None:
            target.refuse(line, f"force {force:g} N: the loads of the scene do not have this pull at {start * dt:.6g} s or "
                          f"later; in {len(pulls) - 1} steps of {dt:.6g} s it lies between {low:g} and {high:g} N")
        start = found
        moments.append(start * dt)
    return moments
