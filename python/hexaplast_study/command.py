# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command hexaplast, which carries out all runs; and the files that studies write."""

import concurrent.futures
import contextlib
import fcntl
import json
import os
import pathlib
import shutil
import signal
import stat
import subprocess
import sys
import threading
import time

IS_LINK = ": is a symbolic link, which is not followed here"
UNFINISHED = stat.S_ISVTX  # of FILE.part: tells what a killed program has left from a stranger's file


class StudyError(Exception):
    """What the command ends with. The text names the place, as `hexaplast: error: ...`."""

    code = 3


class UsageError(StudyError, ValueError):
    code = 2


class SceneError(StudyError, ValueError):
    code = 3


class NumericalError(StudyError, ArithmeticError):
    code = 4


class FileError(StudyError, OSError):
    code = 5


class PluginError(StudyError, ImportError):
    code = 6


_KINDS = {kind.code: kind for kind in (UsageError, SceneError, NumericalError, FileError, PluginError)}


def error_of(code, text):
    """What a command means that has ended with a code and messages."""
    return _KINDS.get(code, FileError)(text or f"hexaplast: error: the command has ended with {code}")


def usage_error(text):
    return UsageError(f"hexaplast: error: {text}")


def file_error(text):
    return FileError(f"hexaplast: error: {text}")


def run_program(action, report, when_ended):
    """The exit code of a program; errors are printed. when_ended: what a signal means for its files."""
    watch_signals()
    try:
        return action()
    except Ended as ended:
        report.warn(f"ended by signal {ended.number}; {when_ended}")
        return 128 + ended.number
    except StudyError as error:
        print(error, file=sys.stderr)
        return error.code
    except OSError as error:
        print(f"hexaplast: error: {error.filename}: {error.strerror}" if error.filename else f"hexaplast: error: {error}",
              file=sys.stderr)
        return FileError.code


def printable(text):
    """What a terminal shows and does not obey; other characters by their number."""
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)


def command():
    """The command that belongs to these studies: HEXAPLAST_COMMAND, the one of their installation or build tree, or the first
    one on PATH. Raises FileNotFoundError."""
    named = os.environ.get("HEXAPLAST_COMMAND")
    if named:
        if not os.access(named, os.X_OK):
            raise FileNotFoundError(f"{named}: HEXAPLAST_COMMAND names no program")
        return named
    beside = pathlib.Path(__file__).resolve().parents[4] / "bin" / "hexaplast"
    found = str(beside) if os.access(beside, os.X_OK) else shutil.which("hexaplast")
    if not found:
        raise FileNotFoundError("the command hexaplast is not on PATH; HEXAPLAST_COMMAND names another place")
    return found


def _environment():
    # what Python loads for its own sake, such as a sanitizer, is not meant for the command
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def describe(scene_words, request):
    """What `hexaplast describe` answers. Raises what it ends with."""
    ended = subprocess.run([command(), "describe", *scene_words], input=json.dumps(request), env=_environment(),
                           capture_output=True, text=True)
    if ended.returncode != 0:
        raise error_of(ended.returncode, ended.stderr.strip())
    return json.loads(ended.stdout)


def text_of(value):
    """As a scene writes it: numbers with all digits, several with blanks between them."""
    if isinstance(value, str):
        return value
    if hasattr(value, "tolist"):  # of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    return " ".join(text_of(entry) for entry in value)


def assignments(overrides):
    """What --set takes."""
    return [f"{name}={text_of(value)}" for name, value in (overrides or {}).items()]


def scene_words(scene, overrides=(), mesh_path=(), plugins=(), plugin_path=()):
    """The words of a command line for a scene, for programs that run in other directories too."""
    words = [word for assignment in overrides for word in ("--set", assignment)]
    words += [word for directory in mesh_path for word in ("--mesh-path", str(pathlib.Path(directory).absolute()))]
    words += [word for plugin in plugins for word in ("--plugin", plugin)]
    words += [word for directory in plugin_path for word in ("--plugin-path", str(pathlib.Path(directory).absolute()))]
    return [*words, "--", str(scene)]


_running = set()
_is_ended = threading.Event()


def run(words, messages, read=None):
    """Carries out `hexaplast run`, which ends with this process. messages: a file for its errors. read: takes the stream of
    states; what it raises ends the run. Returns the exit code, 128 and its number for a signal."""
    ours = theirs = None
    words = [command(), "run", "--quiet", "--parent", str(os.getpid()), *words]
    if read:
        ours, theirs = os.pipe()
        words[3:3] = ["--stream", str(theirs)]
    try:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=messages,
                                   env=_environment(), pass_fds=[theirs] if read else [])
    except BaseException:
        if read:
            os.close(ours)
        raise
    finally:
        if read:
            os.close(theirs)
    _running.add(process)
    try:
        if _is_ended.is_set():
            process.terminate()
        if read:
            with open(ours, "rb", buffering=1 << 20) as stream:
                read(stream)
        code = process.wait()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        _running.discard(process)
    return 128 - code if code < 0 else code


def end_runs():
    """Ends the runs of this process, after their current step, and those that are yet to begin."""
    _is_ended.set()
    for process in list(_running):
        with contextlib.suppress(ProcessLookupError):
            process.terminate()


def begin_runs():
    """Permits runs again after end_runs."""
    _is_ended.clear()


def is_ended():
    return _is_ended.is_set()


class WholeFile:
    """A file that is complete when it appears under its name; until then its name is FILE.part. Raises FileError.

    Inside of a `with`, text or another program's data go to `part`; the end of the block without an error puts the file in
    place, if `commit` was called.
    """

    def __init__(self, path):
        self.path, self.part = pathlib.Path(path), pathlib.Path(f"{path}.part")
        self._is_committed = False

    def __enter__(self):
        if self.path.is_symlink():
            raise file_error(f"{self.path}{IS_LINK}")
        if self.path.exists() and not self.path.is_file():
            raise file_error(f"{self.path}: is not a regular file and will not be replaced")
        with contextlib.suppress(FileNotFoundError):
            mode = self.part.lstat().st_mode
            if not stat.S_ISREG(mode) or not mode & UNFINISHED:
                raise file_error(f"{self.part}: is in the way, and no unfinished file of a run: give it another name")
            self.part.unlink()
        try:
            self._file = os.open(self.part, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666 | UNFINISHED)
        except OSError as error:
            raise file_error(f"{self.part}: cannot be created: {error.strerror}") from None
        return self

    def commit(self, text=None):
        """text: the content; None: it is in the file."""
        try:
            if text is not None:
                data = text.encode()
                while data:
                    data = data[os.write(self._file, data):]
            os.fsync(self._file)
        except OSError as error:
            raise file_error(f"{self.part}: cannot be written: {error.strerror}") from None
        os.rename(self.part, self.path)
        os.fchmod(self._file, stat.S_IMODE(os.fstat(self._file).st_mode) & ~UNFINISHED)
        self._is_committed = True
        sync_directory(self.path.parent)

    def __exit__(self, *_):
        os.close(self._file)
        if not self._is_committed:
            with contextlib.suppress(FileNotFoundError):
                self.part.unlink()


def write_whole(path, text):
    with WholeFile(path) as file:
        file.commit(text)


def sync_directory(directory):
    """A rename is on disk only when its directory is. Some file systems cannot do that."""
    handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with contextlib.suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)


@contextlib.contextmanager
def locked(directory):
    """Creates a directory and keeps other runs and sweeps out of it. Raises FileError."""
    if directory.exists() and not directory.is_dir():
        raise file_error(f"{directory}: is a file; an output directory is needed")
    try:
        directory.mkdir(parents=True, exist_ok=True)
        handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise file_error(f"{directory}: cannot be created: {error.strerror}") from None
    try:
        if not os.access(directory, os.R_OK | os.W_OK | os.X_OK):
            raise file_error(f"{directory}: cannot be written: Permission denied")
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise file_error(f"{directory}: another run or sweep is at work there: wait for its end, or end it") from None
        except OSError as error:
            print(f"warning: {directory}: cannot be locked ({error.strerror}): nothing keeps a second run out", file=sys.stderr)
        yield
    finally:
        os.close(handle)


# ---- terminals, signals, executors

def duration(seconds):
    """8 s, 2 min 10 s, 1 h 5 min"""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole // 3600} h {whole // 60 % 60} min"


class Report:
    """Where a study says what happens: nowhere, or on the terminal."""

    is_terminal = False

    def say(self, text):
        pass

    warn = error = say

    def progress(self, done, last, words=""):
        pass


class TerminalReport(Report):
    """progress is a line that the next message overwrites; in a log, which is no terminal, a line every ten seconds."""

    BETWEEN_LINES = 10  # [s]

    def __init__(self):
        self.is_terminal = sys.stderr.isatty()
        self._has_line = False
        self._begin = self._latest = time.monotonic()
        self._first = None

    def say(self, text):
        self._clear()
        print("\n".join(map(printable, text.split("\n"))), flush=True)

    def warn(self, text):
        self.error(f"warning: {text}")

    def error(self, text):
        self._clear()
        print(text, file=sys.stderr, flush=True)

    def progress(self, done, last, words=""):
        now = time.monotonic()
        if self._first is None:
            self._first = done - 1  # what was there before this one counts for no time
        left = (now - self._begin) / (done - self._first) * (last - done)
        text = f"{done} of {last}  {words + '  ' if words else ''}{duration(left)} left"
        if self.is_terminal:
            print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
            self._has_line = True
        elif now - self._latest >= self.BETWEEN_LINES:
            print(text, file=sys.stderr, flush=True)
            self._latest = now

    def _clear(self):
        if self._has_line:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
        self._has_line = False


class Ended(BaseException):
    """A signal asks for the end."""

    def __init__(self, number):
        super().__init__(number)
        self.number = number


def watch_signals():
    """SIGINT and SIGTERM raise Ended; a second one ends the program at once."""
    def end(number, _):
        signal.signal(signal.SIGINT, lambda *_: os._exit(128 + number))
        signal.signal(signal.SIGTERM, lambda *_: os._exit(128 + number))
        raise Ended(number)
    signal.signal(signal.SIGINT, end)
    signal.signal(signal.SIGTERM, end)


@contextlib.contextmanager
def workers(executor, jobs):
    """The executor, or else threads, which wait for runs. Left by an exception, it ends the runs of this process."""
    if executor is not None:
        yield executor
        return
    with concurrent.futures.ThreadPoolExecutor(jobs) as threads:
        try:
            yield threads
        except BaseException:
            end_runs()
            threads.shutdown(cancel_futures=True)
            raise
        finally:
            begin_runs()
