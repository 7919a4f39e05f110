# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of many runs, by any executor of concurrent.futures: of processes, of MPI, of Dask.

Every run is one of the command `hexaplast`, in a process of its own: it has the bits of the command, and one that dies
takes nothing else with it.
"""

import atexit
import concurrent.futures
import contextlib
import csv
import json
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import threading
import uuid

import numpy as np

__all__ = ["Fit", "Sweep", "fit", "sweep"]


def _command():
    """The command that belongs to this module, in a build tree or an installation."""
    named = os.environ.get("HEXAPLAST_COMMAND")
    place = pathlib.Path(named) if named else pathlib.Path(__file__).resolve().parents[4] / "bin" / "hexaplast"
    if not place.is_file():
        raise FileNotFoundError(f"{place}: the command hexaplast is not there; HEXAPLAST_COMMAND names another place")
    return str(place)


def _environment():
    # what Python loads for its own sake, a sanitizer say, is none of the command's
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def _run(words):
    """Runs `hexaplast sweep`. Returns its exit code and messages; for executors, which pass it to other processes.

    It ends when this process does, whose end of the pipe is gone then.
    """
    theirs, ours = os.pipe()
    try:
        ended = subprocess.run([_command(), *words], env=_environment(), stdin=theirs,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    finally:
        os.close(theirs)
        os.close(ours)
    return ended.returncode, ended.stderr


def _raise(code, messages):
    error = {5: OSError, 6: ImportError, 4: ArithmeticError}.get(code, ValueError)
    raise error(messages.strip() or f"hexaplast ended with {code}")


def _text(value):
    """As a scene writes it."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if np.ndim(value) > 0:
        return " ".join(_text(entry) for entry in np.ravel(value))
    return repr(value.item() if isinstance(value, np.generic) else value)


def _scene_words(scene, steps, overrides, mesh_path, plugins, plugin_path):
    words = [str(pathlib.Path(scene).resolve())]
    if steps is not None:
        words += ["--steps", str(steps)]
    for name, value in (overrides or {}).items():
        words += ["--set", f"{name}={_text(value)}"]
    for directory in mesh_path:
        words += ["--mesh-path", str(pathlib.Path(directory).resolve())]
    for plugin in plugins:
        words += ["--plugin", plugin]
    for directory in plugin_path:
        words += ["--plugin-path", str(pathlib.Path(directory).resolve())]
    return words


class Sweep:
    """What the runs of a sweep came to: `sweep["yieldStress"]` is a column of sweep.csv, one value per run.

    Numbers are float64, with nan where a run failed; other columns are lists of texts.
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
        """Mask of the runs that failed; the directory has their messages."""
        return self["exit_code"] != 0

    @property
    def data(self):
        """HDF5 file with the fields of all runs; None: the sweep has no fields."""
        file = self.directory / "sweep.h5"
        return file if file.exists() else None


def _numbers(texts):
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return texts


def sweep(scene, grid, executor=None, *, out, steps=None, overrides=None, fields=(), every=1, strict=False,
          threads=1, shards=None, force=False, mesh_path=(), plugins=(), plugin_path=()):
    """Runs a scene for every combination of values, as `hexaplast sweep` does, and returns a Sweep.

    grid: PATH.attribute and its values: a sequence, or a text a:b:n or a:b:n:log. executor: any of concurrent.futures,
    otherwise one run at a time in this process. out: a directory that all workers reach. It holds afterwards what
    `hexaplast sweep` leaves; the same call continues what was interrupted. shards: tasks for the executor, among which
    the runs are spread by their hash; by default as many as there are runs, at most 256. fields, every: see
    `hexaplast sweep --fields`.

    Runs that fail are rows with their exit code. Raises ValueError for a scene, an attribute or a value that is not
    accepted, and OSError for files. Raises OSError also where runs are missing because they were killed: `out` holds
    the others, and the same call carries out what is missing.
    """
    out = pathlib.Path(out).resolve()
    words = _scene_words(scene, steps, overrides, mesh_path, plugins, plugin_path)
    num_runs = 1
    for name, values in grid.items():
        text, count = _values(name, values)
        num_runs *= count
        words += ["--vary", f"{name}={text}"]
    if fields:
        words += ["--fields", ",".join(fields), "--every", str(every)]
    words += ["--strict"] * bool(strict) + ["--force"] * bool(force) + ["--threads", str(threads), "--jobs", "1"]

    count = shards or min(num_runs, 256)
    if executor is None:
        count = shards or 1
    places = [out / f"shard_{index}_of_{count}" for index in range(1, count + 1)]
    tasks = [["sweep", "--ends-with-stdin", *words, "--shard", f"{index}/{count}", "--out", str(place)]
             for index, place in enumerate(places, 1)]
    out.mkdir(parents=True, exist_ok=True)
    if executor is None:
        ended = map(_run, tasks)
    else:
        waiting = [executor.submit(_run, task) for task in tasks]
        try:
            concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_EXCEPTION)
            ended = [future.result() for future in waiting]
        except BaseException:
            for future in waiting:
                future.cancel()
            raise
    for code, messages in ended:
        # a scene that is refused has the code of runs that are; one that ended by a signal has runs that are missing
        if 0 < code < 128 and not re.search(r"error: \d+ of \d+ runs failed$", messages.strip()):
            _raise(code, messages)

    begun = [str(place) for place in places if (place / "sweep.json").exists()]
    if not begun:
        raise OSError(f"{out}: no run was carried out: the processes of the sweep were killed")
    code, messages = _run(["sweep", "--out", str(out), *["--force"] * bool(force), "--merge", *begun])
    if code not in (0, 3, 4):
        raise OSError(messages.strip() or f"hexaplast sweep --merge ended with {code}")
    return Sweep(out)


def _values(name, values):
    """The values of an attribute as the command takes them, and how many they are."""
    if isinstance(values, str):
        parts = values.split(":")
        if len(parts) < 3:
            return values, values.count(",") + 1
        if not parts[2].isdecimal() or int(parts[2]) < 2:
            raise ValueError(f"{name}: {values!r}: must be a:b:n or a:b:n:log, with n of at least 2")
        return values, int(parts[2])
    entries = [_text(value) for value in values]
    if not entries:
        raise ValueError(f"{name}: there are no values: at least one is needed")
    for entry in entries:
        if "," in entry or ":" in entry:
            raise ValueError(f"{name}: {entry!r}: values of a sequence must have no comma and no colon")
    return ",".join(entries), len(entries)


class _Evaluator:
    """A process of `hexaplast fit` that answers questions: values of the parameters, for a curve."""

    def __init__(self, words):
        self.socket, other = socket.socketpair()
        self.process = subprocess.Popen([_command(), "fit", "--worker", *words], stdin=other, stdout=other,
                                        stderr=subprocess.DEVNULL, env=_environment())
        other.close()
        _send(self.socket, struct.pack("=qd", 1, 1))  # one thread

    def ask(self, question):
        self.socket.sendall(question)
        answer = _receive(self.socket)
        if answer is None:
            raise OSError("a process that evaluates has ended by itself")
        return answer

    def close(self):
        _hang_up(self.socket)
        self.process.wait()


def _hang_up(connection):
    """For all copies of the socket that forked processes have, which keep it open otherwise."""
    with contextlib.suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()


def _send(to, message):
    to.sendall(message)


def _receive(connection):
    """A list of numbers as the command passes them: how many (-1: there are none), then each. None: nobody is there."""

    def exactly(size):
        parts = []
        while size > 0:
            part = connection.recv(min(size, 1 << 20))
            if not part:
                return None
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    head = exactly(8)
    if head is None:
        return None
    count = struct.unpack("=q", head)[0]
    rest = exactly(8 * count) if count > 0 else b""
    return None if rest is None else head + rest


_evaluators = {}  # by process and thread, which must not share one (a forked process finds those of its parent)


def _end_evaluators(of=None):
    """Those of this process: all, or those of one fit."""
    for key, (study, _) in list(_evaluators.items()):
        if key[0] == os.getpid() and of in (None, study):
            _evaluators.pop(key)[1].close()


def _evaluate(study, words, question):
    """One evaluation; for executors. The process stays for the next one of the same fit."""
    key = (os.getpid(), threading.get_ident())
    if key in _evaluators and _evaluators[key][0] != study:  # its target or scene may be another one
        _evaluators.pop(key)[1].close()
    if key not in _evaluators:
        atexit.unregister(_end_evaluators)
        atexit.register(_end_evaluators)
        _evaluators[key] = study, _Evaluator(words)
    try:
        return _evaluators[key][1].ask(question)
    except OSError:
        _evaluators.pop(key)[1].close()
        raise


class Fit(dict):
    """The content of fit.json (docs/calibration.md), and `values`: PATH.attribute and the value that was found."""

    @property
    def values_found(self):
        return {one["attribute"]: one["value"] for one in self["parameters"]}


def fit(scene, target, free, executor=None, *, out, jobs=None, compare=(), experiments=(), evaluations=200, steps=None,
        overrides=None, force=False, mesh_path=(), plugins=(), plugin_path=()):
    """Finds the values of attributes with which a scene repeats a measured curve, as `hexaplast fit` does.

    free: PATH.attribute and its limits: a pair, or a text lo:hi[:log|:linear]. The runs of the scene are carried out by
    the executor, `jobs` at a time (by default as many as the fit can use: twice the number of parameters, at least
    four); without one, by processes of this machine. The result does not depend on them. Every worker must reach scene
    and target by the same paths. experiments: further scenes with a curve each, which the same values must repeat: dicts
    with "scene" and "target", and where wanted "compare" and "overrides", which hold for this one. Returns a Fit.
    """
    words = _scene_words(scene, steps, overrides, mesh_path, plugins, plugin_path)
    words += ["--target", str(pathlib.Path(target).resolve()), "--evaluations", str(evaluations)]
    for name, limits in free.items():
        text = limits if isinstance(limits, str) else ":".join(_text(limit) for limit in limits)
        words += ["--free", f"{name}={text}"]
    if compare:
        words += ["--compare", ",".join(compare)]
    for one in experiments:
        words += _experiment_words(**one)
    call = [_command(), "fit", *words, "--out", str(out), *["--force"] * bool(force)]
    if executor is None:
        ended = subprocess.run(call + (["--jobs", str(jobs)] if jobs else []), env=_environment(),
                               stdin=subprocess.DEVNULL, capture_output=True, text=True)
        code, messages = ended.returncode, ended.stderr
    else:
        code, messages = _fit_by(executor, call, words, jobs or max(2 * len(free), 4))
    if code != 0:
        _raise(code, messages)
    return Fit(json.loads((pathlib.Path(out) / "fit.json").read_text()))


def _experiment_words(scene, target, compare=(), overrides=None):
    words = ["--experiment", str(pathlib.Path(scene).resolve()), str(pathlib.Path(target).resolve())]
    words += [",".join(compare)] * bool(compare)
    return words + [f"{name}={_text(value)}" for name, value in (overrides or {}).items()]


def _fit_by(executor, call, words, jobs):
    """The command asks at several sockets, and each question goes to the executor."""
    pairs = [socket.socketpair() for _ in range(jobs)]
    asked = [other.fileno() for _, other in pairs]
    process = subprocess.Popen(call + ["--asks", ",".join(map(str, asked))], pass_fds=asked, env=_environment(),
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    for _, other in pairs:
        other.close()
    failures = []
    study = uuid.uuid4().hex

    def serve(connection):
        try:
            while (question := _receive(connection)) is not None:
                connection.sendall(executor.submit(_evaluate, study, words, question).result())
        except BrokenPipeError:
            pass  # the fit has ended
        except BaseException as failure:  # of the executor, or of a process of it
            failures.append(failure)
        finally:
            _hang_up(connection)

    threads = [threading.Thread(target=serve, args=[connection]) for connection, _ in pairs]
    for thread in threads:
        thread.start()
    try:
        _, messages = process.communicate()
    except BaseException:
        process.send_signal(signal.SIGTERM)
        process.wait()
        raise
    finally:
        for thread in threads:
            thread.join()
        _end_evaluators(study)  # of executors of threads; other processes end theirs with the next fit, or themselves
    if failures and process.returncode != 0:
        raise failures[0]
    return process.returncode, messages
