# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fits: the values of attributes with which scenes repeat measured curves (docs/calibration.md)."""

import contextlib
import dataclasses
import json
import math
import os
import pathlib
import sys

import numpy as np

from . import command, confidence, curve, picture
from .command import Report, TerminalReport, file_error, usage_error
from .options import Parser, add_jobs, add_scene, names, num_jobs, number, whole_number

FIRST_STEP = 0.2  # of the range: how far it looks around
SLOPE_STEP = 0.01  # of the range, for differences
ENOUGH = 1e-5  # of the range: steps that are smaller tell nothing more
PERFECT = 1e-7  # root mean square that no measurement comes near
NO_GAIN = 1e-2  # decrease of the sum of squares, in the variance of one row: a tenth of a value's standard deviation
MAX_WEIGHTINGS = 3  # searches with weights from the noise of the one before
MIN_NOISE = 1e-3  # of the noisiest column: one that has less weighs no more
SAME_NOISE = 1.3  # factor between columns up to which weights change nothing worthwhile
NO_NOISE = 1e-6  # of the largest value
CLOSENESS = 0.01  # of the largest value: by how much the curve changes for a value to be told from another
HARDLY_KNOWN = 0.5  # of the range: a value that may move so far is not determined
AT_LIMIT = 1e-3  # of the range
SPANS_DECADES = 10  # factor between the limits from which on the scale is logarithmic
FREE_FORM = "must be PATH.attribute=lo:hi, PATH.attribute=lo:hi:log or PATH.attribute=lo:hi:linear"


def written(value):
    return f"{value:.6g}"


@dataclasses.dataclass
class Free:
    """A number of the scenes that the fit chooses between limits. Its fraction of the range is in [0, 1]: of the difference or,
    on a logarithmic scale, of the factor."""

    option: str
    name: str
    least: float
    most: float
    is_logarithmic: bool
    unit: str = ""
    given: float = None  # value of the scene, if it is within the limits

    def value(self, fraction):
        if self.is_logarithmic:
            return self.least * math.pow(self.most / self.least, fraction)
        return self.least + (self.most - self.least) * fraction

    def fraction(self, value):
        if self.is_logarithmic:
            return math.log(value / self.least) / math.log(self.most / self.least)
        return (value - self.least) / (self.most - self.least)

    @property
    def start(self):
        return 0.5 if self.given is None else self.fraction(self.given)


def parse_free(text):
    """Of PATH.attribute=lo:hi[:log|:linear]. Raises UsageError."""
    option = f"--free {text}"
    name, equals, given = text.partition("=")
    low, colon, high = given.partition(":")
    high, _, scale = high.partition(":")
    if not equals or not colon or scale not in ("", "log", "linear") or given.count(":") != (2 if scale else 1):
        raise usage_error(f"{option}: {FREE_FORM}")
    low, high = number(low, option), number(high, option)
    if not low < high:
        raise usage_error(f"{option}: lo must be less than hi, {low:g} is not less than {high:g}")
    is_logarithmic = scale == "log" if scale else low > 0 and high >= SPANS_DECADES * low
    if is_logarithmic and low <= 0:
        raise usage_error(f"{option}: a logarithmic scale needs limits greater than 0")
    return Free(option, name, low, high, is_logarithmic)


@dataclasses.dataclass
class Experiment:
    """A scene and its curve."""

    scene: str
    file: str
    compare: list
    overrides: list
    own: list  # the overrides of this experiment alone
    words: list  # of the scene, on a command line
    scene_hash: str = ""
    target: curve.Target = None
    moments: list = None  # [s] per row

    @staticmethod
    def of(scene, file, compare, common, own, *places):
        """places: mesh_path, plugins, plugin_path."""
        return Experiment(scene, file, compare, common + own, own, command.scene_words(scene, common + own, *places))

    def title(self):
        return pathlib.Path(self.scene).stem


@dataclasses.dataclass
class Question:
    """What a run of an experiment has to answer; for executors that pass it to other processes and machines."""

    words: list
    threads: int
    steps: int
    dt: float
    moments: list
    columns: list  # (is_probe, name)


def question_of(experiment, threads, dt):
    steps = max(math.ceil(experiment.moments[-1] / dt - curve.SAME_MOMENT), 0)
    columns = [(column.is_probe, column.name if column.is_probe else column.measure) for column in experiment.target.columns]
    return Question(experiment.words, threads, steps, dt, experiment.moments, columns)


def answer(question, assignments):
    """The values of all columns, one after the other, of a run with assignments. Returns exit code, values (None: there are
    none) and messages."""
    from . import states
    found, values = {}, None

    def read(stream):
        with contextlib.suppress(states.EndOfRun):  # the exit code tells it
            of_run = states.Stream(stream)
            rows = list(of_run)
            found.update(times=np.array([row["time"] for row in rows]))
            for kind in ("probes", "measures"):
                for c, name in enumerate(of_run.head[kind]):
                    found[kind == "probes", name] = np.array([row[kind][c] for row in rows])

    measures = [name for is_probe, name in question.columns if not is_probe]
    words = [*(["--measure", ",".join(measures)] if measures else []), "--steps", str(question.steps), "--threads",
             str(question.threads), *[word for assignment in assignments for word in ("--set", assignment)]]
    # the scene's own --set come first: those of the fit count
    scene = question.words.index("--")
    with open(os.memfd_create("messages"), "w+", errors="replace") as messages:  # a disk may be full
        code = command.run([*question.words[:scene], *words, *question.words[scene:]], messages, read)
        messages.seek(0)
        text = messages.read().strip()
    if code == 0:
        # linear between steps; none beyond the end
        ends = found["times"][-1] + curve.SAME_MOMENT * question.dt
        values = np.concatenate([np.interp(question.moments, found["times"], found[column]) for column in question.columns])
        if question.moments[-1] > ends or not np.all(np.isfinite(values)):
            code, values, text = 4, None, "the run has no numbers at the moments of the curve"
    return code, values, text


class OutOfEvaluations(Exception):
    pass


class IsPerfect(Exception):
    pass


class Evaluations:
    """Runs of the experiments at points (fractions of the ranges), several at the same time; none is repeated."""

    def __init__(self, free, questions, executor, most, progress):
        self._free, self._questions, self._executor = free, questions, executor
        self._most, self._progress, self._known = most, progress, {}
        self.num = self.num_failed = 0

    def assignments(self, point):
        return tuple(f"{one.name}={written(one.value(x))}" for one, x in zip(self._free, point))

    def first(self, point):
        """What is wrong with the scene is raised."""
        return self._values([self.assignments(point)], True, True)[0]

    def at(self, points, is_counted=True):
        """Values of all columns per point; None where a scene does not run. is_counted: they belong to the search, whose number
        is limited. Raises OutOfEvaluations, FileError."""
        asked = [self.assignments(point) for point in points]
        if is_counted and self.num + len({one for one in asked if one not in self._known}) > self._most:
            raise OutOfEvaluations
        return self._values(asked, False, is_counted)

    def _values(self, asked, is_first, is_counted):
        new = list(dict.fromkeys(one for one in asked if one not in self._known))
        waiting = [[self._executor.submit(answer, question, list(one)) for question in self._questions] for one in new]
        try:
            for one, futures in zip(new, waiting):
                answers = [future.result() for future in futures]
                for code, _, text in answers:
                    if code != 0 and is_first:
                        raise command.error_of(code, text)
                    if code not in (0, 2, 3, 4):
                        raise file_error(f"a run of the fit has ended with {code}: {text}")
                values = None if any(code for code, *_ in answers) else np.concatenate([found for _, found, _ in answers])
                self._known[one] = values
                self.num += is_counted
                self.num_failed += is_counted and values is None
                self._progress(self.num)
        except BaseException:
            for future in (future for futures in waiting for future in futures):
                future.cancel()
            raise
        return [self._known[one] for one in asked]


class Search:
    """The point of least squares, by scipy.optimize.least_squares with slopes by differences, and what is known of it."""

    def __init__(self, experiments, free, evaluations, report):
        self._columns = [column for one in experiments for column in one.target.columns]
        self.num_rows = [len(column.values) for column in self._columns]
        self._wanted = np.concatenate([column.values for column in self._columns])
        self._greatest = np.repeat([column.greatest for column in self._columns], self.num_rows)
        self._free, self._evaluations, self._report = free, evaluations, report
        self.weights = self._first_weights()
        self.is_converged = False

    def differences(self, values):
        """As fractions of the largest value of each column."""
        return (values - self._wanted) / self._greatest

    def _weighted(self, values):
        return None if values is None else self.differences(values) * np.repeat(self.weights, self.num_rows)

    def carry_out(self, most):
        point = [one.start for one in self._free]
        self.start = self._evaluations.first(point)
        self._find_best(point, True)
        self._find_slopes()
        for _ in range(MAX_WEIGHTINGS if len(self.weights) > 1 else 0):
            found = self.confidence()
            weights = self._weights_by(found.noise) if found.has_noise else None
            if weights is None or self._evaluations.num >= most:
                break
            self.weights = weights
            self._find_best(self.best, False)
            self._find_slopes()
        self.fitted = self._evaluations.first(self.best)

    # ---- the search

    def _take(self, points):
        """Residuals at points, of which the best one is kept, the first of equal ones."""
        found = [self._weighted(values) for values in self._evaluations.at(points)]
        for point, residuals in zip(points, found):
            if residuals is not None and (self.best is None or residuals @ residuals < self.residuals @ self.residuals):
                self.best, self.residuals = [float(x) for x in point], residuals
        if self.residuals is not None and self.rms <= PERFECT:
            raise IsPerfect
        return found

    @property
    def rms(self):
        return math.sqrt(np.mean(self.residuals**2))

    def _find_best(self, start, looks_around):
        from scipy.optimize import least_squares
        self.best = self.residuals = None
        self.is_converged = False

        def residuals_at(x):
            found = self._take([x])[0]
            return np.full(len(self._wanted), np.nan) if found is None else found

        def slopes_at(x):
            return self._slopes_at(x, residuals_at(x), self._take)

        try:
            self._take([start])
            if looks_around:
                self._take(neighbours_of(self.best, FIRST_STEP))
            found = least_squares(residuals_at, self.best, slopes_at, (0, 1), ftol=NO_GAIN / len(self._wanted), xtol=ENOUGH,
                                  gtol=1e-15)
            self.is_converged = found.status > 0
        except IsPerfect:
            self.is_converged = True
        except OutOfEvaluations:
            pass

    def _find_slopes(self):
        def take(points):
            return [self._weighted(values) for values in self._evaluations.at(points, False)]
        self.slopes = self._slopes_at(self.best, self.residuals, take)

    @staticmethod
    def _slopes_at(at, residuals, take):
        """By differences from both sides, where both are within the range and have results."""
        points = neighbours_of(at, SLOPE_STEP)
        beside = take(points)
        slopes = np.zeros((len(residuals), len(at)))
        for p in range(len(at)):
            low = high = (at[p], residuals)
            for point, found in zip(points, beside):
                if found is not None and point[p] < at[p]:
                    low = (point[p], found)
                elif found is not None and point[p] > at[p]:
                    high = (point[p], found)
            if high[0] > low[0]:
                slopes[:, p] = (high[1] - low[1]) / (high[0] - low[0])
        return slopes

    # ---- weights

    def _first_weights(self):
        """By the noise that curves show by themselves: how far rows lie from the middle of their neighbours, in the median. A
        search that begins with them does not follow the noise of one column away from what another one tells."""
        deviations = []
        for column in self._columns:
            values = np.array(column.values)
            bends = np.sort(np.append(np.abs(values[1:-1] - (values[:-2] + values[2:]) / 2), 0.0))
            deviations.append(bends[len(bends) // 2] / column.greatest)
        return _inverse(np.array(deviations))

    def _weights_by(self, noise):
        """By the noise that a fit has left; None where they would be much the same."""
        weights = _inverse(np.array([one.deviation for one in noise]) / self.weights)
        factors = weights / self.weights / (weights[0] / self.weights[0])
        return None if max(factors.max(), 1 / factors.min()) < SAME_NOISE else weights

    # ---- what is known

    def confidence(self):
        estimated = [p for p, x in enumerate(self.best) if not is_limit(x)]
        return confidence.confidence_of(self.slopes, self.residuals, self.num_rows, estimated, HARDLY_KNOWN)

    def leeways(self):
        return confidence.leeways(self.slopes / np.repeat(self.weights, self.num_rows)[:, None], CLOSENESS)


def neighbours_of(at, distance):
    points = []
    for p in range(len(at)):
        for step in (-distance, distance):
            moved = [float(x) for x in at]
            moved[p] = min(max(moved[p] + step, 0.0), 1.0)
            if moved[p] != at[p]:
                points.append(moved)
    return points


def _inverse(deviations):
    most = deviations.max()
    return most / np.maximum(deviations, MIN_NOISE * most) if most > NO_NOISE else np.ones(len(deviations))


def is_limit(fraction):
    return fraction < AT_LIMIT or fraction > 1 - AT_LIMIT


@dataclasses.dataclass
class Found:
    """What is known of a free attribute; distances as fractions of its range."""

    free: Free
    value: float
    alone: float  # leeway within 1 % of the curve
    together: float
    half_width: float  # of the 95 % interval; inf: none

    @property
    def is_at_limit(self):
        return is_limit(self.free.fraction(self.value))

    @property
    def has_interval(self):
        return math.isfinite(self.half_width) and not self.is_at_limit

    def moved(self, distance):
        return self.free.value(min(max(self.free.fraction(self.value) + distance, 0.0), 1.0))


class Result:
    """What a fit has found, as text, JSON and picture."""

    def __init__(self, experiments, free, search, evaluations, most):
        self.experiments, self.search, self.evaluations, self.most = experiments, search, evaluations, most
        self.confidence = search.confidence()
        self.found = [Found(one, float(written(one.value(x))), *leeways, half_width) for one, x, leeways, half_width in
                      zip(free, search.best, search.leeways(), self.confidence.half_width)]
        differences = search.differences(search.fitted)
        self.relative_rms = math.sqrt(np.mean(differences**2))
        self.columns = [(one, column) for one in experiments for column in one.target.columns]
        parts = np.split(differences, np.cumsum(search.num_rows)[:-1])
        self.rms = [column.greatest * math.sqrt(np.mean(part**2)) for (_, column), part in zip(self.columns, parts)]
        for noise, (_, column), weight in zip(self.confidence.noise, self.columns, search.weights):
            noise.deviation *= column.greatest / weight

    @property
    def set_words(self):
        return " ".join(f"--set {one.free.name}={written(one.value)}" for one in self.found)

    def name_of(self, experiment, column):
        return column.name if len(self.experiments) == 1 else f"{column.name} of {experiment.file}"

    def warnings(self):
        percent = f"{100 * CLOSENESS:g} %"
        for one in self.found:
            def span(distance, one=one):
                return f"anywhere from {written(one.moved(-distance))} to {written(one.moved(distance))} {one.free.unit}"
            name = one.free.name
            if one.alone > HARDLY_KNOWN:
                yield f"{name} hardly matters here: the curve stays within {percent} of itself {span(one.together)}"
            elif one.together > HARDLY_KNOWN:
                yield (f"{name} cannot be told apart from the others: with them adjusted, the curve stays within {percent} of "
                       f"itself {span(one.together)}")
            elif one.has_interval and one.half_width > HARDLY_KNOWN:
                yield f"{name} is lost in the noise: its 95 % interval is {span(one.half_width)}"
            if one.is_at_limit:
                yield (f"{name} is at its limit: the best value may lie beyond; it has no 95 % interval, and those of the "
                       "others are for this value of it")
        for step in self.confidence.undetermined:
            if sum(abs(part) > 0.1 for part in step) > 1:
                yield f"the curve does not determine {self._combination(step)}: they may change so at the same time"
        if not self.confidence.has_noise:
            yield ("the curve has not more rows than parameters: nothing is known of its noise, and there are no 95 % "
                   "intervals")
        for noise, rows, (experiment, column) in zip(self.confidence.noise, self.search.num_rows, self.columns):
            # more alike than independent ones are in 99 of 100 cases
            if self.confidence.has_noise and noise.correlation > 2.33 / math.sqrt(rows):
                yield (f"the differences in {self.name_of(experiment, column)} are alike from row to row (correlation "
                       f"{noise.correlation:.2f}): the scene cannot repeat the curve as it is, or its noise is slow. The "
                       "intervals are wider for it")
        if not self.search.is_converged:
            yield (f"stopped after {self.evaluations.num} evaluations before it had settled; --evaluations allows more, "
                   f"now {self.most}")
        if self.evaluations.num_failed:
            yield (f"{self.evaluations.num_failed} of {self.evaluations.num} evaluations failed: the limits hold values with "
                   "which the scene does not run")

    def _combination(self, step):
        """How the values of a direction change together, for the one that changes most by a tenth of its range."""
        most = max(step, key=abs)
        words = []
        for one, part in zip(self.found, step):
            if abs(part) < 0.1 * abs(most):
                continue
            free, fraction = one.free, 0.1 * part / most
            words.append(f"{free.name} times {math.pow(free.most / free.least, fraction):.3g}" if free.is_logarithmic else
                         f"{free.name} {fraction * (free.most - free.least):+.3g}{' ' * bool(free.unit)}{free.unit}")
        return " together with ".join(words)

    def text(self):
        lines = [f"{one.title()}: fitted to {one.file}, {len(one.target.lines)} rows" for one in self.experiments]
        width = max(len(one.free.name) for one in self.found)
        for one in self.found:
            interval = ("at its limit" if one.is_at_limit else "95 %: not determined" if not one.has_interval else
                        f"95 %: {written(one.moved(-one.half_width))} to {written(one.moved(one.half_width))}")
            lines.append(f"  {one.free.name:<{width}}  {written(one.value)} {one.free.unit}  ({interval}; within "
                         f"{100 * CLOSENESS:g} % of the curve: {written(one.moved(-one.together))} to "
                         f"{written(one.moved(one.together))})")
        for rms, noise, (experiment, column) in zip(self.rms, self.confidence.noise, self.columns):
            of_noise = (f"; noise {written(noise.deviation)}, correlation {noise.correlation:.2f} from row to row"
                        if self.confidence.has_noise else "")
            lines.append(f"  {self.name_of(experiment, column):<{width}}  {written(rms)} {column.unit} root mean "
                         f"square{of_noise}")
        lines.append(f"  {'residual':<{width}}  {100 * self.relative_rms:.4f} % of the largest value")
        lines.append(f"  {'evaluations':<{width}}  {self.evaluations.num}")
        return "\n".join([*lines, self.set_words])

    def json(self, warnings):
        def entry_of(one):
            return {"scene": one.scene, "scene_hash": one.scene_hash, "overrides": one.overrides, "target": one.file,
                    "rows": len(one.target.lines)}

        def finite(number):
            return number if math.isfinite(number) else None

        has_noise = self.confidence.has_noise
        parameters = [{"attribute": one.free.name, "unit": one.free.unit, "value": one.value, "least": one.free.least,
                       "most": one.free.most, "scale": "log" if one.free.is_logarithmic else "linear",
                       "start": one.free.value(one.free.start), "at_limit": one.is_at_limit,
                       "confidence_from": one.moved(-one.half_width) if one.has_interval else None,
                       "confidence_to": one.moved(one.half_width) if one.has_interval else None,
                       "known_from": one.moved(-one.together), "known_to": one.moved(one.together),
                       "leeway_alone": finite(one.alone), "leeway_together": finite(one.together)} for one in self.found]
        correlation = [[float(self.confidence.correlation[p, q]) if one.has_interval and other.has_interval else None
                        for q, other in enumerate(self.found)] for p, one in enumerate(self.found)]
        columns = [{"name": column.name, "target": experiment.file, "unit": column.unit, "rms": rms,
                    "noise": noise.deviation if has_noise else None,
                    "noise_correlation": noise.correlation if has_noise else None}
                   for (experiment, column), rms, noise in zip(self.columns, self.rms, self.confidence.noise)]
        found = {**entry_of(self.experiments[0]), "further_experiments": [entry_of(one) for one in self.experiments[1:]],
                 "relative_rms": self.relative_rms, "columns": columns, "evaluations": self.evaluations.num,
                 "failed_evaluations": self.evaluations.num_failed, "converged": self.search.is_converged,
                 "parameters": parameters, "correlation": correlation, "undetermined": self.confidence.undetermined,
                 "set": self.set_words, "warnings": warnings}
        return json.dumps(found, indent=1, allow_nan=False) + "\n"

    def picture(self):
        rows, begin = [], 0
        for (experiment, column), count in zip(self.columns, self.search.num_rows):
            target = experiment.target
            of_column = slice(begin, begin + count)
            begin += count

            def scaled(values, column=column):
                return [column.shown_scale * float(value) for value in values]

            curves = [picture.Curve("before", picture.PALE, scaled(self.search.start[of_column])),
                      picture.Curve("target", picture.FIRST, scaled(column.values), False, True),
                      picture.Curve("fitted", picture.SECOND, scaled(self.search.fitted[of_column]))]
            label = column.label if len(self.experiments) == 1 else f"{column.label}, {pathlib.Path(experiment.file).stem}"
            rows.append(picture.Row(label, "time [s]" if target.times else "force [N]",
                                    [picture.Plot("", target.times or target.forces, curves)]))
        return picture.picture(self.experiments[0].title(), rows)


def prepare(experiments, free):
    """Looks up the attributes and reads the curves."""
    asked = [{"option": one.option, "attribute": one.name, "limits": [one.least, one.most]} for one in free]
    for k, experiment in enumerate(experiments):
        try:
            found = command.describe(experiment.words, {"free": asked})
        except command.UsageError as error:
            raise error if len(experiments) == 1 else command.UsageError(f"{error} (of the scene {experiment.scene})") from None
        experiment.scene_hash = found["scene_hash"]
        for one, of_scene in zip(free, found["free"]):
            for own in experiment.own:
                if own.startswith(one.name + "="):
                    raise usage_error(f"--experiment {experiment.scene} {experiment.file}: {own}: must not be a free "
                                      "attribute, which has the same value in all experiments")
            if k == 0:
                one.unit = of_scene["unit"]
                given = of_scene["given"]
                one.given = given if given is not None and one.least <= given <= one.most else None
    for name in (one.name for one in free):
        if sum(one.name == name for one in free) > 1:
            option = [one.option for one in free if one.name == name][1]
            raise usage_error(f"{option}: this attribute is free already")
    for experiment in experiments:
        experiment.target = curve.read_target(experiment.file, experiment.compare)


def find_moments(experiments, free, steps, outputs):
    """What all runs are asked: a function from the number of threads to questions. Refuses outputs that are inputs."""
    start = [f"{one.name}={written(one.value(one.start))}" for one in free]
    dts = []
    for experiment in experiments:
        target = experiment.target
        found = command.describe(experiment.words, {"outputs": outputs, "curve": {
            "steps": steps, "pulls": not target.times, "assignments": start}})
        curve.find_columns(target, found["curve"])
        dts.append(found["curve"]["dt"])
        experiment.moments = target.times or curve.moments_of(target, found["curve"]["pulls"], dts[-1])
        same = [place for output in outputs for place in (output, output + ".part")
                if os.path.exists(place) and os.path.samefile(place, experiment.file)]
        if lost := [found["input"]] * bool(found["input"]) + same:
            raise file_error(f"{lost[0]}: is an input, and will not be written over")
    return lambda threads: [question_of(one, threads, dt) for one, dt in zip(experiments, dts)]


def carry_out_fit(experiments, free, executor, *, out, steps, jobs, threads, evaluations, force, report):
    """Returns the result; prints and writes it."""
    prepare(experiments, free)
    with contextlib.ExitStack() as stack:
        files = []
        if out:
            out = pathlib.Path(out)
            stack.enter_context(command.locked(out))
            for name in ("fit.json", "fit.svg"):
                if (out / name).exists() and not force:
                    raise file_error(f"{out}: holds an earlier fit ({name}); --force replaces it")
        places = [str(out / name) for name in ("fit.json", "fit.svg")] if out else []
        questions = find_moments(experiments, free, steps, places)
        if out:
            # opened before the first run, so that a long fit does not end in a file that cannot be written
            files = [stack.enter_context(command.WholeFile(place)) for place in places]
        processors = len(os.sched_getaffinity(0))
        num = min(num_jobs(jobs, threads), 2 * len(free) * len(experiments))
        with command.workers(executor, num) as workers:
            runs = Evaluations(free, questions(threads or (1 if executor else max(1, processors // num))), workers, evaluations,
                               lambda done: report.progress(done, evaluations, "evaluations at most"))
            search = Search(experiments, free, runs, report)
            search.carry_out(evaluations)
        result = Result(experiments, free, search, runs, evaluations)
        warnings = list(result.warnings())
        report.say(result.text())
        if out:
            files[0].commit(result.json(warnings))
            files[1].commit(result.picture())
        for warning in warnings:
            report.warn(warning)


# ---- for Python

class Fit(dict):
    """The content of fit.json (docs/calibration.md)."""

    @property
    def values_found(self):
        """PATH.attribute and the value that was found."""
        return {one["attribute"]: one["value"] for one in self["parameters"]}


def fit(scene, target, free, executor=None, *, out, jobs=None, compare=(), experiments=(), evaluations=200, steps=None,
        overrides=None, force=False, mesh_path=(), plugins=(), plugin_path=()):
    """Finds the values of attributes with which a scene repeats a measured curve, as `hexaplast fit` does. Returns a Fit.

    free: PATH.attribute and its limits: a pair, or a text lo:hi[:log|:linear]. executor: any of concurrent.futures, which
    carries out the runs; without one, `jobs` at a time on this machine. The result does not depend on them. Every worker must
    reach scene and target by the same paths. experiments: further scenes with a curve each, which the same values must repeat:
    dicts with "scene" and "target", and where wanted "compare" and "overrides", which hold for this one.
    """
    def experiment(scene, target, compare=(), overrides=None):
        scene, target = (str(pathlib.Path(path).absolute()) for path in (scene, target))
        return Experiment.of(scene, target, list(compare), common, command.assignments(overrides), mesh_path, plugins,
                             plugin_path)

    common = command.assignments(overrides)
    all_experiments = [experiment(scene, target, compare), *[experiment(**one) for one in experiments]]
    parsed = [parse_free(f"{name}={limits if isinstance(limits, str) else ':'.join(map(command.text_of, limits))}")
              for name, limits in free.items()]
    carry_out_fit(all_experiments, parsed, executor, out=out, steps=steps, jobs=jobs, threads=None, evaluations=evaluations,
                  force=force, report=Report())
    return Fit(json.loads(pathlib.Path(out, "fit.json").read_text()))


# ---- the program

def parse(arguments):
    parser = Parser("fit", "Find the attribute values with which a scene repeats a measured curve.")
    add_scene(parser, True)
    parser.add_argument("--target", required=True, metavar="CURVE.csv",
                        help="CSV with columns time or force, and what is compared (docs/calibration.md)")
    parser.add_argument("--compare", type=names, default=[], metavar="COLUMN,...",
                        help="columns of it that are compared; default: all")
    parser.add_argument("--experiment", nargs="+", action="append", default=[], metavar="WORD",
                        help="a further scene and its curve, which the same values must repeat: SCENE CURVE.csv [COLUMN,...] "
                             "[PATH.attribute=VALUE ...]: columns that are compared (default: all), and attributes that are "
                             "other ones here; may be repeated")
    parser.add_argument("--free", action="append", required=True, metavar="PATH.attribute=lo:hi[:log|:linear]",
                        help="a number of every scene that is looked for between lo and hi, on a logarithmic scale where these "
                             "span a decade or as told; may be repeated")
    parser.add_argument("--evaluations", type=whole_number(2, 10**6), default=200, metavar="N",
                        help="runs of the scene at most; default 200")
    parser.add_argument("--out", metavar="DIR", help="write fit.json and fit.svg into this directory")
    parser.add_argument("--steps", type=whole_number(1, 10**6), metavar="N",
                        help="steps of the run that a curve over force is compared with; default: those of the scene's "
                             "RunSettings")
    add_jobs(parser)
    parser.add_argument("--force", action="store_true", help="write over an earlier fit")
    given = parser.read(arguments)
    if given.force and not given.out:
        parser.error("--force requires --out")
    return given


def experiments_of(given):
    def experiment(scene, file, compare, own):
        return Experiment.of(scene, file, compare, given.set, own, given.mesh_path, given.plugin, given.plugin_path)

    found = [experiment(given.scene, given.target, given.compare, [])]
    for words in given.experiment:
        if len(words) < 2:
            raise usage_error(f"--experiment {' '.join(words)}: must be SCENE CURVE.csv [COLUMN,...] [PATH.attribute=VALUE ...]")
        compare = [column for word in words[2:] if "=" not in word for column in word.split(",")]
        found.append(experiment(*words[:2], compare, [word for word in words[2:] if "=" in word]))
    return found


def main():
    given = parse(sys.argv[1:])
    report = TerminalReport()

    def carry_out():
        carry_out_fit(experiments_of(given), [parse_free(text) for text in given.free], None, out=given.out, steps=given.steps,
                      jobs=given.jobs, threads=given.threads, evaluations=given.evaluations, force=given.force, report=report)
        return 0

    return command.run_program(carry_out, report, "nothing is written")
