# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sweeps: a scene for every combination of attribute values. A run is a directory that is renamed when it is complete: it is
complete or not there, whenever a sweep is killed."""

import contextlib
import csv
import dataclasses
import hashlib
import io
import json
import math
import os
import pathlib
import queue
import re
import shutil
import sys
import time

from . import command, picture
from .command import Report, TerminalReport, file_error, usage_error
from .options import Parser, add_jobs, add_scene, names, num_jobs, number, whole_number

MAX_RUNS, MAX_VALUES, MAX_SHARDS = 100_000, 10_000, 100_000
FORM = "must be PATH.attribute=a:b:n, PATH.attribute=a:b:n:log or PATH.attribute=v1,v2,..."
FINAL_CODES = (0, 3, 4)  # of runs that would end in the same way again
ENDS = ("plastic_elongation", "plastic_twist_deg", "current_elongation", "current_twist_deg")
RESULTS = ("volume_error", "largest_plastic_strain", "elastic_energy", "kinetic_energy", "dissipated_energy", "removed",
           "opened", "state_hash")
DATA = "states.h5"
TABLE_INTERVAL = 0.5  # [s] between two tables during a sweep
FILES = ("sweep.json", "sweep.csv", "sweep_times.csv", "sweep.svg", "sweep.h5")
DIFFERENCES = {"vary": "the varied attributes or their values differ", "steps": "the number of steps differs",
               "strict": "--strict is given to one of them only",
               "scene_hash": "the scene, or what --set makes of it, differs",
               "version": "the version of Hexaplast differs", "simd": "the instruction set differs",
               "fields": "--fields or --every differ", "every": "--fields or --every differ"}
MAY_BE_ABSENT = ("fields", "every")


@dataclasses.dataclass
class Factor:
    """A varied attribute. numbers: its values, if all are."""

    attribute: str
    values: list
    is_logarithmic: bool = False

    @property
    def numbers(self):
        try:
            return [float(value) for value in self.values]
        except ValueError:
            return None


def parse_factor(text):
    """Of PATH.attribute=a:b:n, a:b:n:log or v1,v2,... Raises UsageError."""

    def refuse(what):
        raise usage_error(f"--vary {text}: {what}")

    attribute, equals, given = text.partition("=")
    if not equals or not attribute:
        refuse(FORM)
    parts = given.split(":")
    if len(parts) == 1:
        return factor_of(attribute, given.split(","), False, text)
    is_logarithmic = len(parts) == 4 and parts[3] == "log"
    if len(parts) != 3 and not is_logarithmic:
        refuse(FORM)
    a, b = (number(part, f"--vary {text}") for part in parts[:2])
    if is_logarithmic and not (a > 0 and b > 0):
        refuse("equal factors need limits greater than 0")
    if not parts[2].isdecimal() or not 2 <= int(parts[2]) <= MAX_VALUES:
        refuse(f"'{parts[2]}' values: must be a whole number from 2 to {MAX_VALUES}")
    n = int(parts[2])
    at = [i / (n - 1) for i in range(n - 1)]
    values = [a * math.pow(b / a, s) for s in at] if is_logarithmic else [a * (1 - s) + b * s for s in at]
    return factor_of(attribute, [f"{value:.12g}" for value in [*values, b]], is_logarithmic, text)


def factor_of(attribute, values, is_logarithmic, text):
    for place, value in enumerate(values):
        if not value:
            raise usage_error(f"--vary {text}: a value is empty")
        if value in values[:place]:
            raise usage_error(f"--vary {text}: the value {value} comes twice")
    return Factor(attribute, values, is_logarithmic)


class Grid:
    """All combinations of the values of factors; the last factor changes fastest. Runs are numbered from 1."""

    def __init__(self, factors):
        self.factors = factors
        self.num_runs = math.prod(len(factor.values) for factor in factors)
        if self.num_runs > MAX_RUNS:
            raise usage_error(f"more than {MAX_RUNS} runs")
        names = [factor.attribute for factor in factors]
        for name in names:
            if names.count(name) > 1:
                raise usage_error(f"--vary {name}: this attribute is varied already")

    def choice(self, run):
        """The place of the value of each factor."""
        found, left = [], run - 1
        for factor in reversed(self.factors):
            left, k = divmod(left, len(factor.values))
            found.append(k)
        return found[::-1]

    def values(self, run):
        return {factor.attribute: factor.values[k] for factor, k in zip(self.factors, self.choice(run))}

    def shard(self, index, count):
        """The runs of a shard: by a hash of their values, so that runs stay in their shards when values are added."""
        def number(run):
            words = "".join(f"{name}={value}\0" for name, value in self.values(run).items())
            return int.from_bytes(hashlib.sha256(words.encode()).digest()[:8], "little")
        return [run for run in range(1, self.num_runs + 1) if number(run) % count == index - 1]


def parse_shard(text):
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]) <= MAX_SHARDS:
        raise usage_error(f"--shard {text}: must be i/n with i from 1 to n, and n at most {MAX_SHARDS}")
    return int(found[1]), int(found[2])


# ---- one run

@dataclasses.dataclass
class Task:
    """A run, for executors that pass it to other processes and machines."""

    out: str
    number: int
    values: dict
    words: list  # of `hexaplast run`, without the values
    has_data: bool


def carry_out(task):
    """Carries out a run in a directory, which gets its name when the run is complete. Returns exit code, what case.json
    holds (None: the run must be repeated), the first line of its messages, and its doubts."""
    place = pathlib.Path(task.out, f"run_{task.number}")
    part = place.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    # after the --set of the scene: of several for one attribute the last one counts
    scene = task.words.index("--")
    words = [*task.words[:scene], *[word for name, value in task.values.items() for word in ("--set", f"{name}={value}")],
             "--summary", str(part / "summary.json"), *task.words[scene:]]

    def read(stream):
        from . import states
        with contextlib.suppress(states.EndOfRun):  # the exit code tells it
            states.write_states(stream, part / DATA)

    with open(part / "messages.txt", "x") as messages:
        code = command.run(words, messages, read if task.has_data else None)
    messages = (part / "messages.txt").read_text(errors="replace")
    line = messages.splitlines()[0] if messages else ""
    if code not in FINAL_CODES:
        if command.is_ended():
            shutil.rmtree(part)
        return code, None, line, []
    case = {"values": task.values, "exit_code": code, "results": None, "files": {}, "step_ms": None}
    doubts = []
    if code == 0:
        summary = json.loads((part / "summary.json").read_text())
        doubts = summary.pop("doubts")
        case["step_ms"] = summary.pop("step_ms")
        case["results"] = {name: summary[name] for name in (*ENDS, *RESULTS) if name in summary}
        for name, value in summary["probes"].items():
            column, extremes = f"probe_{name.removeprefix('probe_')}", summary["probe_extremes"][name]
            case["results"] |= {column: value, f"min_{column}": extremes["min"], f"max_{column}": extremes["max"]}
        (part / "messages.txt").unlink()
    elif task.has_data:
        (part / DATA).unlink(missing_ok=True)
    (part / "summary.json").unlink(missing_ok=True)
    if code == 0 and task.has_data:
        case["files"][DATA] = checksum(part / DATA)
        sync(part / DATA)
    (part / "case.json").write_text(json.dumps(case, indent=1, allow_nan=False) + "\n")
    sync(part / "case.json")
    command.sync_directory(part)
    part.rename(place)
    command.sync_directory(part.parent)
    return code, case, line, doubts


def sync(path):
    with open(path, "rb") as file:
        os.fsync(file.fileno())


def checksum(path):
    """SHA-256, as sha256sum prints it."""
    found = hashlib.sha256()
    with open(path, "rb") as file:
        while data := file.read(1 << 20):
            found.update(data)
    return found.hexdigest()


def read_case(place, values, has_data):
    """case.json of a complete run. Raises FileError if it is not the run with these values, or its data have changed."""
    advice = f"remove {place}, and the same command carries the run out again"
    try:
        case = json.loads((place / "case.json").read_text())
        found, code, files = case["values"], case["exit_code"], case["files"]
        results, _ = case["results"], case["step_ms"]
        is_well = code in FINAL_CODES and (results is None) == (code != 0) and (code != 0 or set(RESULTS) <= set(results))
        if not is_well or (has_data and code == 0 and DATA not in files):
            raise ValueError
    except (OSError, ValueError, KeyError, TypeError):
        raise file_error(f"{place}/case.json: is not that of a complete run; {advice}") from None
    if found != values:
        raise file_error(f"{place}/case.json: is of a run with other values; {advice}")
    for name, expected in files.items():
        if not (place / name).is_file():
            raise file_error(f"{place / name}: is missing, though the run is done; {advice}")
        if checksum(place / name) != expected:
            raise file_error(f"{place / name}: has changed since its run (its SHA-256 is not that of case.json); {advice}")
    return case


# ---- the directory of a sweep

class Directory:
    """Plan, table, picture, and a directory for each run."""

    def __init__(self, path, plan):
        self.path, self.plan = pathlib.Path(path), plan
        self.grid = Grid([Factor(one["attribute"], one["values"], one.get("logarithmic", False)) for one in plan["vary"]])
        self.has_data = "fields" in plan
        shard = plan.get("shard")
        self.own = self.grid.shard(*parse_shard(shard)) if shard else range(1, self.grid.num_runs + 1)
        self.cases = {}

    def place(self, run):
        return self.path / f"run_{run}"

    def open(self, force):
        """Takes up the sweep that is there, or begins one. Raises FileError where there is another one, or something that is
        none."""
        own = set(self.own)
        names = {f"run_{run}{end}" for run in own for end in ("", ".part")}
        contents = [self.path / name for name in FILES] + [self.path / name for name in sorted(
            entry.name for entry in os.scandir(self.path) if entry.name in names)]
        for place in contents:
            if place.is_symlink():
                raise file_error(f"{place}{command.IS_LINK}")
        if (self.path / "sweep.json").exists() and not force:
            self._refuse_another()
            for run in self.own:
                if self.place(run).exists():
                    self.cases[run] = read_case(self.place(run), self.grid.values(run), self.has_data)
            return
        for place in contents:
            if place.exists() and not force:
                raise file_error(f"{place}: is there without a plan; --force replaces it")
        for place in contents[5:]:
            if not place.is_dir() or not ((place / "case.json").exists() or place.suffix == ".part"):
                raise file_error(f"{place}: is no run of a sweep, and not replaced: move it away")
        # the plan last, so that runs never stand beside the plan of another sweep
        for place in contents[5:]:
            shutil.rmtree(place)
        for place in contents[1:5]:
            place.unlink(missing_ok=True)
        command.write_whole(self.path / "sweep.json", json.dumps(self.plan, indent=1) + "\n")

    def _refuse_another(self):
        found = read_plan(self.path)
        difference = difference_of(found, self.plan)
        if not difference and found.get("shard") != self.plan.get("shard"):
            difference = "the shard differs"
        if difference:
            raise file_error(f"{self.path}: holds another sweep: {difference}; --force replaces it")

    # ---- the table

    def columns(self):
        """Names of results: elongation and twist of scenes that measure them, and probes of scenes that have any."""
        names = {name: None for case in self.cases.values() if case["results"] for name in case["results"]}
        probes = [name for name in names if name.removeprefix("min_").removeprefix("max_").startswith("probe_")]
        return [name for name in ENDS if name in names] + list(RESULTS) + probes

    def rows(self):
        names = self.columns()
        yield ["run", *[factor.attribute for factor in self.grid.factors], "exit_code", *names]
        for run in sorted(self.cases):
            case = self.cases[run]
            results = case["results"] or {}
            yield [run, *self.grid.values(run).values(), case["exit_code"],
                   *["" if results.get(name) is None else results[name] for name in names]]

    def write_table(self):
        command.write_whole(self.path / "sweep.csv", csv_text(self.rows()))
        times = [[run, self.cases[run]["step_ms"]] for run in sorted(self.cases) if self.cases[run]["step_ms"] is not None]
        command.write_whole(self.path / "sweep_times.csv", csv_text([["run", "step_ms"], *times]))

    def result(self, run, name):
        """As a number; NaN where the run failed or is not there."""
        results = self.cases[run]["results"] if run in self.cases else None
        value = (results or {}).get(name)
        return math.nan if value is None else float(value)

    @property
    def num_failed(self):
        return sum(case["exit_code"] != 0 for case in self.cases.values())

    def write_overviews(self, warn):
        if warning := picture.draw_sweep(self):
            warn(warning)
        if not self.has_data:
            return
        from . import states
        runs = range(1, self.grid.num_runs + 1)
        is_done = {run: run in self.cases and self.cases[run]["exit_code"] == 0 for run in runs}
        columns = [("run", "", [float(run) for run in runs])]
        for factor, unit in zip(self.grid.factors, self.plan["units"]):
            numbers = dict(zip(factor.values, factor.numbers or factor.values))
            values = [numbers[self.grid.values(run)[factor.attribute]] for run in runs]
            columns.append((f"vary/{factor.attribute}", unit, values))
        codes = [float(self.cases[run]["exit_code"]) if run in self.cases else math.nan for run in runs]
        columns.append(("exit_code", "", codes))
        for name in self.columns():
            values = [(self.cases[run]["results"]["state_hash"] if is_done[run] else "") if name == "state_hash" else
                      self.result(run, name) for run in runs]
            columns.append((f"results/{name}", "", values))
        attributes = {"format": "hexaplast sweep 2", "scene": pathlib.Path(self.plan["scene"]).name,
                      **{key: self.plan[key] for key in ("scene_hash", "version", "simd")}}
        with command.WholeFile(self.path / "sweep.h5") as file:
            differing = states.write_overview(file.part, self.path,
                                              [f"run_{run}/{DATA}" if is_done[run] else None for run in runs], columns,
                                              attributes)
            file.commit()
        for name in differing:
            warn(f"{self.path / 'sweep.h5'}: does not have /{name}: its shape is not the same in all runs")

    def conclude(self, report):
        """Says how many runs are done and have failed. Returns the exit code."""
        title, num_own = self.plan["title"], len(self.own)
        report.say(f"{title}: {len(self.cases)} of {num_own} runs done, {self.num_failed} failed: {self.path / 'sweep.csv'}")
        if self.num_failed:
            report.error(f"{title}: error: {self.num_failed} of {num_own} runs failed")
        codes = {case["exit_code"] for case in self.cases.values()}
        return 0 if not self.num_failed else codes.pop() if len(codes) == 1 and len(self.cases) == num_own else 4


def csv_text(rows):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def read_plan(path):
    file = pathlib.Path(path, "sweep.json")
    if file.exists() and not file.is_file():
        raise file_error(f"{file}: is not a file")
    try:
        plan = json.loads(file.read_text())
    except OSError as error:
        raise file_error(f"{file}: {error.strerror}") from None
    except ValueError:
        plan = None
    if not isinstance(plan, dict):
        raise file_error(f"{file}: is no plan of a sweep; --force begins anew")
    return plan


def difference_of(plan, other):
    """Why two plans are not of the same sweep; empty: they are. Shards are not compared."""
    for key, difference in DIFFERENCES.items():
        is_there = key in plan and key in other
        if plan.get(key) != other.get(key) or not (is_there or key in MAY_BE_ABSENT):
            return difference
    return ""


# ---- sweeps

def plan_of(scene, words, factors, *, steps, strict, fields, every, shard, out):
    """What makes two sweeps the same. Checks every value, so that no run is spent on a mistyped one."""
    asked = [{"option": "--vary", "attribute": factor.attribute, "values": factor.values} for factor in factors]
    places = [str(out / name) for name in FILES] + [str(file) for run in out.glob("run_*") for file in (run, *run.rglob("*"))]
    found = command.describe(words, {"vary": asked, "fields": list(fields or ()), "outputs": places})
    if found["input"]:
        raise file_error(f"{found['input']}: is an input of this sweep")
    if steps is None and found["steps"] is None:
        raise usage_error("the number of steps is not given: neither --steps nor RunSettings.steps in the scene")
    plan = {"title": pathlib.Path(scene).stem, "scene": str(scene), "scene_hash": found["scene_hash"],
            "version": found["version"], "simd": found["simd"], "steps": steps, "strict": strict,
            "vary": [{"attribute": factor.attribute, "values": factor.values,
                      **({"logarithmic": True} if factor.is_logarithmic else {})} for factor in factors],
            "units": [one["unit"] for one in found["vary"]]}
    if fields:
        plan.update(fields=list(fields), every=every)
    if shard:
        plan["shard"] = shard
    return plan


def figures_of(case):
    """For a line of a run."""
    results, found = case["results"], []
    if ENDS[0] in results:
        found += [f"plastic elongation {round(100 * results[ENDS[0]], 3) + 0.0:+.3f} %",
                  f"twist {round(results[ENDS[1]], 3) + 0.0:+.3f} deg"]
    found += [f"{name.removeprefix('probe_')} {value:.6g}" for name, value in results.items()
              if name.startswith("probe_") and value is not None]
    return ", ".join([*found, f"{case['step_ms']:.3f} ms per step"])


def carry_out_all(directory, words, executor, report):
    """Carries out what is not complete. Returns how many runs came to no end."""
    waiting, done = {}, queue.SimpleQueue()
    num_lost, num_failed, num_own = 0, directory.num_failed, len(directory.own)
    written, is_written = -math.inf, True
    try:
        for run in directory.own:
            if run in directory.cases:
                continue
            task = Task(str(directory.path), run, directory.grid.values(run), words, directory.has_data)
            future = executor.submit(carry_out, task)
            waiting[future] = task
            future.add_done_callback(done.put)
        while waiting:
            with contextlib.suppress(queue.Empty):
                future = done.get(timeout=None if is_written else TABLE_INTERVAL)
                task = waiting.pop(future)
                code, case, line, doubts = future.result()
                if case is None:
                    num_lost += 1
                else:
                    directory.cases[task.number] = case
                    is_written = False
                which = (f"run {task.number} of {directory.grid.num_runs}: "
                         + " ".join(f"{name}={value}" for name, value in task.values.items()))
                if code != 0:
                    report.warn(f"{which}: ended with {code}: {line}")
                else:
                    for doubt in doubts:
                        report.warn(f"{which}: {doubt}")
                    if not report.is_terminal:
                        report.say(f"{which}: {figures_of(case)}")
                num_failed += code != 0
                report.progress(len(directory.cases), num_own, f"{num_failed} failed")
            if not is_written and time.monotonic() - written > TABLE_INTERVAL:
                directory.write_table()
                written, is_written = time.monotonic(), True
    except BaseException:
        for future in waiting:
            future.cancel()
        raise
    finally:
        directory.write_table()
    return num_lost


def carry_out_sweep(scene, words, factors, executor, *, out, steps, strict, fields, every, shard, jobs, threads, force,
                    report):
    """A sweep in its directory. Returns the directory, how many runs are missing, and the exit code."""
    options = ["--threads", str(threads or 1), *["--strict"] * bool(strict)]
    if steps is not None:
        options += ["--steps", str(steps)]
    if fields:
        options += ["--fields", ",".join(fields), "--every", str(every)]
    if shard:
        parse_shard(shard)
    Grid(factors)
    out = pathlib.Path(out)
    plan = plan_of(scene, words, factors, steps=steps, strict=strict, fields=fields, every=every, shard=shard, out=out)
    with command.locked(out):
        directory = Directory(out, plan)
        directory.open(force)
        if directory.cases:
            report.say(f"{len(directory.cases)} of {len(directory.own)} runs are done already")
        directory.write_table()
        with command.workers(executor, num_jobs(jobs, threads)) as executor:
            num_lost = carry_out_all(directory, options + words, executor, report)
        if not shard:
            directory.write_overviews(report.warn)
        return directory, num_lost, directory.conclude(report)


def merge(shards, out, force, report):
    """Gathers the runs of shards. Returns the directory and how many runs are missing. Raises FileError."""
    shards, out = [pathlib.Path(shard) for shard in shards], pathlib.Path(out)
    plan = read_plan(shards[0])
    for key in ("title", "units", "scene", "scene_hash", "version", "simd", "steps", "strict", "vary"):
        if key not in plan:
            raise file_error(f"{shards[0]}/sweep.json: is no plan of a sweep that can be merged: it has no {key}")
    if not isinstance(plan["units"], list) or not isinstance(plan["vary"], list) or len(plan["units"]) != len(plan["vary"]):
        raise file_error(f"{shards[0]}/sweep.json: is no plan of a sweep that can be merged: units must have as many entries "
                         "as vary")
    for shard in shards[1:]:
        if difference := difference_of(plan, read_plan(shard)):
            raise file_error(f"{shards[0]} and {shard} are not of one sweep: {difference}")
    plan.pop("shard", None)
    try:
        directory = Directory(out, plan)
    except (command.UsageError, KeyError, TypeError, AttributeError):
        raise file_error(f"{shards[0]}/sweep.json: is no plan of a sweep") from None
    with command.locked(out):
        for shard in shards:
            if shard.samefile(out):
                raise file_error(f"{out}: is one of the directories to merge")
        directory.open(force)
        origin = {run: out for run in directory.cases}
        for shard in shards:
            take_runs(shard, directory, origin)
        directory.write_table()
        directory.write_overviews(report.warn)
        code = directory.conclude(report)
    num_missing = directory.grid.num_runs - len(directory.cases)
    if num_missing:
        report.error(f"{out}: error: {num_missing} of {directory.grid.num_runs} runs are missing: complete the shards and "
                     "merge again")
    return directory, num_missing, code


def take_runs(shard, directory, origin):
    """Those of a shard, into the directory of all. Files are linked where the file system allows it."""
    def link(source, target):
        try:
            os.link(source, target)
        except OSError:
            shutil.copy2(source, target)

    for run in sorted(int(entry.name[4:]) for entry in os.scandir(shard) if re.fullmatch(r"run_[1-9]\d{0,6}", entry.name)):
        if run > directory.grid.num_runs:
            raise file_error(f"{shard}/run_{run}: is no run of this sweep")
        case = read_case(shard / f"run_{run}", directory.grid.values(run), directory.has_data)
        known = directory.cases.get(run)
        if known and any(known[key] != case[key] for key in ("exit_code", "results", "files")):
            raise file_error(f"run {run} has other results in {shard} than in {origin[run]}: they are not of one version or "
                             "one instruction set")
        if known:
            continue
        part = directory.path / f"run_{run}.part"
        shutil.rmtree(part, ignore_errors=True)
        shutil.copytree(shard / f"run_{run}", part, copy_function=link)
        part.rename(directory.place(run))
        directory.cases[run], origin[run] = case, shard
    command.sync_directory(directory.path)


# ---- for Python

class Sweep:
    """The results of a sweep: `sweep["yieldStress"]` is a column of sweep.csv, one value per run.

    Numbers are float64, NaN where a run failed; other columns are lists of texts.
    """

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        with open(self.directory / "sweep.csv", newline="") as file:
            head, *rows = csv.reader(file)
        self.names = tuple(head)
        self._columns = {name: _numbers([row[c] for row in rows]) for c, name in enumerate(head)}

    def __getitem__(self, name):
        return self._columns[name]

    def __len__(self):
        return len(self._columns["run"])

    @property
    def failed(self):
        """Mask of the runs that failed; their directories have their messages."""
        return self["exit_code"] != 0

    @property
    def data(self):
        """HDF5 file with the fields of all runs; None: the sweep has no fields."""
        file = self.directory / "sweep.h5"
        return file if file.exists() else None


def _numbers(texts):
    import numpy as np
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return texts


def sweep(scene, grid, executor=None, *, out, steps=None, overrides=None, fields=(), every=1, strict=False, threads=1,
          jobs=None, force=False, mesh_path=(), plugins=(), plugin_path=()):
    """Runs a scene for every combination of values, as `hexaplast sweep` does, and returns a Sweep.

    grid: PATH.attribute and its values: a sequence, or a text a:b:n or a:b:n:log. executor: any of concurrent.futures, which
    carries out one run per task; without one, `jobs` runs at a time on this machine (default: as many as processors). out: a
    directory that all workers reach; the same call continues what was interrupted. fields, every: see `hexaplast sweep`.

    Runs that fail are rows with their exit code. Raises ValueError for a scene, an attribute or a value that is not accepted,
    OSError for files, and OSError if runs were killed: `out` has the others, and the same call carries out what is missing.
    """
    scene, out = pathlib.Path(scene).absolute(), pathlib.Path(out).absolute()
    words = command.scene_words(scene, command.assignments(overrides), mesh_path, plugins, plugin_path)
    factors = []
    for name, values in grid.items():
        if isinstance(values, str):
            factors.append(parse_factor(f"{name}={values}"))
        elif len(values) == 0:
            raise usage_error(f"{name}: there are no values: at least one is needed")
        else:
            factors.append(factor_of(name, [command.text_of(value) for value in values], False, name))
    if not factors:
        raise usage_error("nothing is varied")
    directory, num_lost, _ = carry_out_sweep(scene, words, factors, executor, out=out, steps=steps, strict=strict,
                                             fields=fields, every=every, shard=None, jobs=jobs, threads=threads, force=force,
                                             report=Report())
    if num_lost:
        raise file_error(f"{out}: {num_lost} of {directory.grid.num_runs} runs are missing: the same call carries them out")
    return Sweep(out)


# ---- the program

def parse(arguments):
    parser = Parser("sweep", "Run a scene for every combination of attribute values; continues what was begun.")
    add_scene(parser, False)
    parser.add_argument("--vary", action="append", default=[], metavar="PATH.attribute=a:b:n|a:b:n:log|v1,v2,...",
                        help="values of an attribute: n from a to b, the same in equal factors (:log), or a list; may be "
                             "repeated")
    parser.add_argument("--out", required=True, metavar="DIR", help="directory of sweep.csv, sweep.svg and the runs")
    parser.add_argument("--shard", metavar="i/n", help="only the runs of shard i of n, which depend on their values alone; "
                                                       "--merge gathers the shards")
    parser.add_argument("--merge", nargs="+", metavar="DIR", help="gather the runs of one sweep from the directories of its "
                                                                  "shards; without SCENE and --vary")
    parser.add_argument("--fields", type=names, metavar="FIELD,...", help="write a data set of each run (HDF5) with these "
                                                                          "fields, as hexaplast run")
    parser.add_argument("--every", type=whole_number(1, 10**9), metavar="N",
                        help="steps between two states in data sets; default 1")
    parser.add_argument("--steps", type=whole_number(0, 10**9), metavar="N",
                        help="number of time steps; default: that of the scene's RunSettings")
    add_jobs(parser)
    parser.add_argument("--strict", action="store_true", help="runs whose results may be wrong have failed, as of hexaplast "
                                                              "run")
    parser.add_argument("--force", action="store_true", help="begin anew in a directory that holds a sweep")
    return parser.read(arguments)


def main():
    given = parse(sys.argv[1:])
    report = TerminalReport()

    def carry_out_merge():
        others = {**vars(given), "out": None, "merge": None, "force": None}
        if any(value not in (None, False, []) for value in others.values()):
            raise usage_error("--merge takes --out and --force alone: what the sweep is, its shards know")
        _, num_missing, code = merge(given.merge, given.out, given.force, report)
        return 5 if num_missing else code

    def carry_out_new():
        if not given.scene:
            raise usage_error("SCENE is required, or --merge")
        if not given.vary:
            raise usage_error("--vary is required, or --merge")
        if given.every and not given.fields:
            raise usage_error("--every requires --fields")
        words = command.scene_words(given.scene, given.set, given.mesh_path, given.plugin, given.plugin_path)
        directory, num_lost, code = carry_out_sweep(
            given.scene, words, [parse_factor(text) for text in given.vary], None, out=given.out, steps=given.steps,
            strict=given.strict, fields=given.fields, every=given.every or 1, shard=given.shard, jobs=given.jobs,
            threads=given.threads, force=given.force, report=report)
        if num_lost:
            report.error(f"{directory.plan['title']}: error: {num_lost} of {len(directory.own)} runs are missing: the same "
                         "command carries them out")
            return 5
        return code

    return command.run_program(carry_out_merge if given.merge else carry_out_new, report, "the same command resumes it")
