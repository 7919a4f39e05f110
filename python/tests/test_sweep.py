# SPDX-License-Identifier: LGPL-2.1-or-later
"""`hexaplast sweep`, against bars whose elongation is known, and against single runs."""
import csv
import itertools
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest
from hexaplast_study import command as study_command

from bars import COMMAND, FLOWING, PULLED, SECTION, command, processes, wait_for

YIELD, FLOW = "body.yieldStress", "body.plasticFlowRate"
TWO_BY_TWO = ["sweep", "bar.scn", "--out", "found", "--jobs", "2", "--vary", "body.youngModulus=1000:4000:2", "--vary",
              "pull.forces=0 0 0 12.5 0 0,0 0 0 -5 0 0"]
TWELVE = ["sweep", "bar.scn", "--vary", f"{YIELD}=40,60,90,150", "--vary", f"{FLOW}=1:3:3"]


@pytest.fixture
def place(tmp_path):
    (tmp_path / "bar.scn").write_text(PULLED)
    return tmp_path


@pytest.fixture
def flowing(tmp_path):
    (tmp_path / "bar.scn").write_text(FLOWING)
    return tmp_path


def table(directory):
    with open(directory / "sweep.csv", newline="") as file:
        return list(csv.DictReader(file))


def sweep(place, *words, code=0):
    ended = command(*words, cwd=place)
    assert ended.returncode == code, ended.stderr
    return ended


def files(directory):
    """Content of everything but wall times."""
    found = {}
    for path in sorted(directory.rglob("*")):
        name = str(path.relative_to(directory))
        if path.is_dir() or path.name == "sweep_times.csv":
            continue
        found[name] = path.read_bytes()
        if path.name == "case.json":
            found[name] = {**json.loads(found[name]), "step_ms": None}
    return found


def test_every_combination_is_a_row_of_what_its_run_gave(place):
    ended = sweep(place, *TWO_BY_TWO)
    assert ended.stderr == "" and "\r" not in ended.stdout
    assert ended.stdout.endswith("bar: 4 of 4 runs done, 0 failed: found/sweep.csv\n")
    rows = table(place / "found")
    for number, (row, (modulus, force)) in enumerate(zip(rows, itertools.product((1000, 4000), (50, -20))), 1):
        assert row["run"] == str(number) and row["exit_code"] == "0"
        assert float(row["body.youngModulus"]) == modulus
        assert row["pull.forces"] == ("0 0 0 12.5 0 0" if force > 0 else "0 0 0 -5 0 0")
        assert abs(float(row["current_elongation"]) - force / (modulus * SECTION)) < 1e-9
        # the work of a force that grows in proportion: F^2 L / (2 E A)
        assert abs(float(row["elastic_energy"]) - force**2 / (2 * modulus * SECTION)) < 1e-8
        assert row["plastic_elongation"] == "0.0"
    assert len(rows) == 4
    sweep(place, "run", "bar.scn", "--quiet", "--summary", "one.json", "--set", "body.youngModulus=4000")
    assert json.loads((place / "one.json").read_text())["state_hash"] == rows[2]["state_hash"]
    picture = (place / "found/sweep.svg").read_text()
    assert "body.youngModulus [Pa]" in picture and "elongation [%]" in picture and "forces = 0 0 0 -5 0 0" in picture
    assert sorted(os.listdir(place / "found")) == ["run_1", "run_2", "run_3", "run_4", "sweep.csv", "sweep.json", "sweep.svg",
                                                   "sweep_times.csv"]
    assert os.listdir(place / "found/run_1") == ["case.json"]


def test_probes_are_columns_and_elongation_belongs_to_bars_that_are_pulled(place):
    probe = "<Probe name='tip' value='@MechanicalObject1.position' indices='2' component='x'/></Node>"
    scene = PULLED.replace("<MechanicalObject/>", "<MechanicalObject name='MechanicalObject1'/>").replace("</Node>", probe)
    (place / "bar.scn").write_text(scene.replace("steps='11'", "steps='11' endSections='no'"))
    sweep(place, "sweep", "bar.scn", "--out", "found", "--vary", "body.youngModulus=1000,2000")
    rows = table(place / "found")
    assert "current_elongation" not in rows[0] and "plastic_twist_deg" not in rows[0]
    assert [round(float(row["probe_tip"]), 9) for row in rows] == [1.2, 1.1]
    assert ">tip</text>" in (place / "found/sweep.svg").read_text()


def test_extremes_of_probes_are_columns_and_curves(place):
    """Against the history of the same run."""
    probe = "<Probe name='tip' value='@nodes.position' indices='2' component='x'/></Node>"
    scene = PULLED.replace("<MechanicalObject/>", "<MechanicalObject name='nodes'/>").replace("</Node>", probe)
    (place / "bar.scn").write_text(scene)
    sweep(place, "sweep", "bar.scn", "--out", "found", "--vary", "body.youngModulus=1000,2000")
    sweep(place, "run", "bar.scn", "--quiet", "--out", "whole", "--frames", "0", "--set", "body.youngModulus=1000")
    with open(place / "whole/history.csv") as file:
        tip = [float(row["probe_tip"]) for row in csv.DictReader(file)]
    row = table(place / "found")[0]
    assert (float(row["min_probe_tip"]), float(row["max_probe_tip"])) == (min(tip), max(tip)) and min(tip) < max(tip)
    picture = (place / "found/sweep.svg").read_text()
    assert all(f">{name}</text>" in picture for name in ("end", "maximum", "minimum"))


def test_the_values_of_a_region_are_reached(place):
    """Two springs in series: the elongation of each half of 0.5 m is F / (2 E A)."""
    (place / "bar.scn").write_text(PULLED.replace("</Node>",
                                                  "<MaterialRegion name='tip' indices='1' youngModulus='700'/></Node>"))
    sweep(place, "sweep", "bar.scn", "--out", "found", "--vary", "tip.youngModulus=500:8000:2")
    for row, tip in zip(table(place / "found"), (500, 8000)):
        assert abs(float(row["current_elongation"]) - 50 / SECTION / 2 * (1 / 2000 + 1 / tip)) < 1e-9


def test_an_interrupted_sweep_goes_on(place):
    sweep(place, *TWO_BY_TWO)
    whole = table(place / "found")
    shutil.rmtree(place / "found/run_2")
    shutil.rmtree(place / "found/run_4")
    (place / "found/run_4.part").mkdir()  # as a kill leaves it
    (place / "found/run_4.part/summary.json").write_text("{")
    ended = sweep(place, *TWO_BY_TWO)
    assert "2 of 4 runs are done already" in ended.stdout and "run 2 of 4" in ended.stdout
    assert "run 1 of 4" not in ended.stdout
    assert table(place / "found") == whole and not (place / "found/run_4.part").exists()


def test_another_sweep_is_not_written_over(place):
    once = ["sweep", "bar.scn", "--out", "found", "--vary", "body.youngModulus=1000,2000"]
    sweep(place, *once)
    before = files(place / "found")
    for words, reason in ((["sweep", "bar.scn", "--out", "found", "--vary", "body.youngModulus=1000,3000"],
                           "the varied attributes or their values differ"),
                          ([*once, "--steps", "3"], "the number of steps differs"),
                          ([*once, "--set", "body.poissonRatio=0.3"], "the scene, or what --set makes of it, differs")):
        ended = sweep(place, *words, code=5)
        assert ended.stderr == f"hexaplast: error: found: holds another sweep: {reason}; --force replaces it\n"
        assert files(place / "found") == before
    sweep(place, *once, "--steps", "3", "--force")
    assert files(place / "found") != before
    case = place / "found/run_1/case.json"
    for text in ("{", "[]", "{}", json.dumps({**json.loads(case.read_text()), "exit_code": 7})):
        case.write_text(text)
        ended = sweep(place, *once, "--steps", "3", code=5)
        assert "found/run_1/case.json: is not that of a complete run; remove found/run_1" in ended.stderr
    shutil.copy(place / "found/run_2/case.json", case)
    assert "is of a run with other values" in sweep(place, *once, "--steps", "3", code=5).stderr


def test_nothing_is_touched_that_is_not_its_own(place):
    """What is in its directory without a plan belongs to somebody; links may lead anywhere."""
    (place / "victim").write_text("mine")
    words = ["sweep", "bar.scn", "--out", "found", "--steps", "2", "--vary", "body.youngModulus=1000,2000"]
    for name in ("sweep.json", "sweep.csv", "sweep.svg", "run_2", "run_1.part"):
        (place / "found").mkdir()
        file = place / "found" / name
        file.write_text("mine")
        assert "--force" in sweep(place, *words, code=5).stderr
        assert file.read_text() == "mine"
        file.unlink()
        file.symlink_to("../victim")
        for force in ([], ["--force"]):
            assert f"{name}: is a symbolic link" in sweep(place, *words, *force, code=5).stderr
        assert file.is_symlink()
        shutil.rmtree(place / "found")
    # also with --force no directory goes that is no run
    (place / "found/run_1").mkdir(parents=True)
    (place / "found/run_1/thesis.txt").write_text("mine")
    assert "run_1: is no run of a sweep, and not replaced" in sweep(place, *words, "--force", code=5).stderr
    assert (place / "found/run_1/thesis.txt").read_text() == "mine"
    shutil.rmtree(place / "found/run_1")
    # nor is the scene replaced, whatever it is called
    for name in ("sweep.svg", "sweep.csv.part", "run_1/summary.json"):
        (place / "found/run_1").mkdir(exist_ok=True)
        shutil.copy(place / "bar.scn", place / "found" / name)
        ended = sweep(place, "sweep", f"found/{name}", *words[2:], "--force", code=5)
        assert f"found/{name}: is an input of this sweep" in ended.stderr
        assert (place / "found" / name).read_text() == PULLED
        (place / "found" / name).unlink()


def test_a_run_that_fails_is_a_row_and_the_others_go_on(flowing):
    # 0.1 s times 100 1/s is more than the whole excess per step
    words = ["sweep", "bar.scn", "--out", "found", "--vary", f"{FLOW}=1,100,2"]
    ended = sweep(flowing, *words, code=4)
    assert "warning: run 2 of 3: body.plasticFlowRate=100: ended with 3: bar.scn:" in ended.stderr
    assert "bar: error: 1 of 3 runs failed" in ended.stderr
    rows = table(flowing / "found")
    assert [row["exit_code"] for row in rows] == ["0", "3", "0"] and rows[1]["state_hash"] == ""
    assert float(rows[2]["plastic_elongation"]) > float(rows[0]["plastic_elongation"])
    assert "plasticFlowRate" in (flowing / "found/run_2/messages.txt").read_text()
    assert "3 of 3 runs are done already" in sweep(flowing, *words, code=4).stdout  # it would fail again
    # of a sweep whose runs all ended alike it is their code
    assert "2 of 2 runs failed" in sweep(flowing, "sweep", "bar.scn", "--out", "refused", "--vary", f"{FLOW}=100,200",
                                         code=3).stderr


def test_runs_without_a_meaning_are_warned_of_and_fail_if_it_is_strict(flowing):
    """A push of 8 kN drives the second of these bars through its support."""
    words = ["sweep", "bar.scn", "--out", "found", "--vary",
             "pull.forces=0 0 0 1 0 0 1 0 0 0 0 0,0 0 0 -2000 0 0 -2000 0 0 -2000 0 0", "--set", f"{YIELD}=1e9"]
    doubt = "run 2 of 2: pull.forces=0 0 0 -2000 0 0 -2000 0 0 -2000 0 0: "
    ended = sweep(flowing, *words)
    assert ended.stderr.startswith("warning: " + doubt) and "hexahedra are inverted at the end" in ended.stderr
    assert "--strict is given to one of them only" in sweep(flowing, *words, "--strict", code=5).stderr
    assert f"warning: {doubt}ended with 4: " in sweep(flowing, *words, "--strict", "--force", code=4).stderr
    assert [row["exit_code"] for row in table(flowing / "found")] == ["0", "4"]


def test_a_signal_ends_it_with_all_its_runs(flowing):
    # the last two take too long for any test
    words = ["sweep", "bar.scn", "--out", str(flowing / "found"), "--jobs", "2", "--vary",
             "RunSettings1.steps=1,2,500000000,600000000"]
    process = subprocess.Popen([COMMAND, *words], cwd=flowing, stderr=subprocess.PIPE, text=True)
    wait_for(lambda: (flowing / "found/sweep.csv").exists() and len(table(flowing / "found")) == 2)
    process.send_signal(signal.SIGINT)
    _, messages = process.communicate()
    assert process.returncode == 130
    assert messages == "warning: ended by signal 2; the same command resumes it\n"
    assert not processes(str(flowing))
    assert [row["exit_code"] for row in table(flowing / "found")] == ["0", "0"]


def test_a_killed_sweep_takes_its_runs_along_keeps_nobody_out_and_goes_on(flowing):
    words = ["sweep", "bar.scn", "--jobs", "1", "--vary", "RunSettings1.steps=1,2,3,40000,4", "--out", str(flowing / "found")]
    process = subprocess.Popen([COMMAND, *words], cwd=flowing, stdout=subprocess.DEVNULL)
    wait_for(lambda: (flowing / "found/run_3").exists())
    wait_for(lambda: processes(" run ", "steps=40000", str(flowing)))
    for force in ([], ["--force"]):
        ended = sweep(flowing, *words, *force, code=5)
        assert ended.stderr.endswith("found: another run or sweep is at work there: wait for its end, or end it\n")
    process.kill()
    process.wait()
    wait_for(lambda: not processes(str(flowing)), 10)
    assert "3 of 5 runs are done already" in sweep(flowing, *words).stdout
    assert len(table(flowing / "found")) == 5


@pytest.mark.parametrize("vary, message", [
    (["body.youngModulus"], "must be PATH.attribute=a:b:n"),
    (["body.youngModulus=1:2"], "must be PATH.attribute=a:b:n"),
    (["body.youngModulus=1:2:1"], "'1' values: must be a whole number from 2"),
    (["body.youngModulus=1:x:3"], "'x' is no number"),
    (["body.youngModulus=0:1:3:log"], "limits greater than 0"),
    (["body.youngModulus=1,,2"], "a value is empty"),
    (["body.youngModulus=1,1"], "the value 1 comes twice"),
    (["body.youngModulus=1,2", "body.youngModulus=3,4"], "is varied already"),
    (["body.youngModulus=1,2", "/body.youngModulus=3,4"],
     "--vary /body.youngModulus: this attribute is varied already, as body.youngModulus"),
    (["body.youngModulus=1:2:400", "body.poissonRatio=0:0.4:400"], "more than 100000 runs"),
    (["body.youngModulos=1,2"], "did you mean 'youngModulus'?"),
    (["bodi.youngModulus=1,2"], "bodi"),
    (["body.youngModulus=-1:1:3"], "must be > 0")])
def test_mistakes_are_found_before_the_first_run(place, vary, message):
    ended = sweep(place, "sweep", "bar.scn", "--out", "found", *[word for one in vary for word in ("--vary", one)], code=2)
    assert message in ended.stderr
    assert not (place / "found").exists()


def test_mistakes_of_the_command_line_end_with_2(place):
    vary = ["--vary", "body.youngModulus=1,2"]
    for words, message in ((["bar.scn", *vary, "--every", "2"], "--every requires --fields"),
                           (["bar.scn", *vary, "--fields", "displacement,strane"], "'strane' is none of"),
                           (["bar.scn", *vary, "--fields", "strain,strain"], "'strain' is given twice"),
                           (["bar.scn", *vary, "--jobs", "0"], "must be a whole number from 1"),
                           (["bar.scn", *vary, "--frames"], "unknown option '--frames'"),
                           (["bar.scn", "x.scn", *vary], "unexpected argument 'x.scn'"),
                           ([], "SCENE is required, or --merge"), (["bar.scn"], "--vary is required, or --merge"),
                           *[(["bar.scn", *vary, f"--shard={shard}"], "must be i/n with i from 1 to n, and n at most 100000")
                             for shard in ("0/2", "3/2", "1", "1/", "/2", "1/2x", "-1/2", "1/200000")],
                           *[(["--merge", "part_1", *more], "--merge takes --out and --force alone")
                             for more in (["--strict"], ["--jobs", "2"], ["--threads", "2"], ["--set", "body.yieldStress=1"],
                                          ["--mesh-path", "."], ["--shard", "1/2"])]):
        assert message in sweep(place, "sweep", "--out", "no", *words, code=2).stderr
    assert not (place / "no").exists()
    assert command("sweep", "bar.scn", "--out", "bar.scn", *vary, cwd=place).returncode == 5
    assert command("sweep", "absent.scn", "--out", "no", *vary, cwd=place).returncode == 5
    assert "--vary" in sweep(place, "sweep", "--help").stdout


def test_values_are_spread_evenly_or_in_equal_factors(place):
    sweep(place, "sweep", "bar.scn", "--out", "found", "--steps", "0", "--vary", "body.poissonRatio=0.1:0.4:4", "--vary",
          "body.youngModulus=100:10000:3:log")
    assert [(row["body.poissonRatio"], row["body.youngModulus"]) for row in table(place / "found")] == list(
        itertools.product(("0.1", "0.2", "0.3", "0.4"), ("100", "1000", "10000")))


# ---- data sets

def test_data_that_have_changed_are_found(flowing):
    fields = ["--steps", "3", "--fields", "plasticStrain", "--vary", f"{YIELD}=40,60,90"]
    once = ["sweep", "bar.scn", *fields, "--out", "found"]
    sweep(flowing, *once)
    before = files(flowing / "found")
    data = flowing / "found/run_2/states.h5"
    whole = data.read_bytes()

    def expect_refused(what):
        for words in (once, ["sweep", "--out", "merged", "--merge", "found"]):
            ended = sweep(flowing, *words, code=5)
            assert f"found/run_2/states.h5: {what}" in ended.stderr
            assert "remove found/run_2, and the same command carries the run out again" in ended.stderr
        assert not (flowing / "merged/run_2").exists()

    data.unlink()
    expect_refused("is missing")
    shutil.copy(flowing / "found/run_1/states.h5", data)  # of another run
    expect_refused("has changed since its run")
    data.write_bytes(whole[:3000])
    expect_refused("has changed since its run")
    shutil.rmtree(flowing / "found/run_2")
    assert "2 of 3 runs are done already" in sweep(flowing, *once).stdout
    assert files(flowing / "found") == before
    assert "--fields or --every differ" in sweep(flowing, *once, "--every", "2", code=5).stderr


WRITERS = """
import concurrent.futures, io, sys
from hexaplast_study import states
data = sys.stdin.buffer.read()
def write(number):
    for _ in range(50):
        states.write_states(io.BytesIO(data), f"{number}.h5")
with concurrent.futures.ThreadPoolExecutor(4) as executor:
    list(executor.map(write, range(4)))
"""


def test_threads_that_write_data_sets_come_to_an_end(flowing):
    """Without the lock around write_direct_chunk they wait for each other."""
    data = subprocess.run([COMMAND, "run", "bar.scn", "--quiet", "--steps", "10", "--fields", "displacement", "--stream", "1"],
                          cwd=flowing, env={"PATH": os.environ["PATH"]}, capture_output=True, check=True).stdout
    subprocess.run([sys.executable, "-c", WRITERS], cwd=flowing, input=data, check=True, timeout=100)
    assert len({(flowing / f"{number}.h5").read_bytes() for number in range(4)}) == 1


def test_a_run_writes_a_data_set_only_if_it_is_complete(flowing):
    run = ["run", "bar.scn", "--quiet", "--data", "found.h5"]
    assert "--data requires --fields" in sweep(flowing, *run, code=2).stderr
    sweep(flowing, *run, "--fields", "velocity", "--every", "5")
    whole = (flowing / "found.h5").read_bytes()
    with h5py.File(flowing / "found.h5") as data:
        assert data["step"][:].tolist() == [0, 5, 10, 11] and data["fields/velocity"].shape == (4, 12, 3)
        assert np.abs(data["fields/velocity"][-1]).max() > 0
    sweep(flowing, *run, "--fields", "velocity", "--every", "5")
    assert (flowing / "found.h5").read_bytes() == whole
    # a run that fails leaves the file of the one before it
    sweep(flowing, *run, "--fields", "velocity", "--set", "pull.forces=0 0 0 1e200 0 0 1e200 0 0 0 0 0", code=4)
    assert (flowing / "found.h5").read_bytes() == whole
    assert sorted(os.listdir(flowing)) == ["bar.scn", "found.h5"]
    full = sweep(flowing, "run", "bar.scn", "--quiet", "--data", "/dev/full", "--fields", "velocity", code=5)
    assert "/dev/full: is not a regular file" in full.stderr


def test_without_python_or_its_packages_an_error_names_them(flowing):
    """A command without the programs beside it, and programs whose packages are missing."""
    (flowing / "bin").mkdir()
    shutil.copy(COMMAND, flowing / "bin/hexaplast")
    home = pathlib.Path(COMMAND).resolve().parent
    environment = {**os.environ, "PATH": "/nowhere", "LD_LIBRARY_PATH": str(home.parent / "lib")}
    environment.pop("LD_PRELOAD", None)

    def refused(*words):
        ended = subprocess.run([flowing / "bin/hexaplast", *words], cwd=flowing, env=environment, capture_output=True, text=True)
        assert ended.returncode == 5
        return ended.stderr

    packages = "python3-numpy, python3-scipy, python3-h5py and python3-matplotlib"
    for words in (["sweep"], ["fit"]):
        assert f"hexaplast-{words[0]} is neither beside" in refused(*words) and packages in refused(*words)
    for name in ("sweep", "fit", "data"):
        program = (home / f"hexaplast-{name}").read_text().replace("/usr/bin/python3", "/usr/bin/python3 -S", 1)
        (flowing / f"bin/hexaplast-{name}").write_text(program)
        (flowing / f"bin/hexaplast-{name}").chmod(0o755)
    for words in (["sweep"], ["fit"]):
        assert packages in refused(*words) and "No module named" in refused(*words)
        program = flowing / f"bin/hexaplast-{words[0]}"
        program.write_text(program.read_text().replace("/usr/bin/python3", "/nowhere/python3"))
        assert packages in refused(*words) and "/usr/bin/python3 is missing" in refused(*words)


# ---- shards

def shards_of(place, words, count, name="part"):
    found = [f"{name}_{i}" for i in range(1, count + 1)]
    for i, part in enumerate(found, 1):
        assert command(*words, "--shard", f"{i}/{count}", "--out", part, cwd=place).returncode in (0, 3, 4)
    return found


def test_merged_shards_have_the_bytes_of_one_process(flowing):
    words = [*TWELVE, "--fields", "displacement,plasticStrain,contactForce", "--every", "4"]
    sweep(flowing, *words, "--out", "one", "--jobs", "2")
    parts = shards_of(flowing, words, 3)
    merged = sweep(flowing, "sweep", "--out", "merged", "--merge", *parts)
    assert merged.stdout == "bar: 12 of 12 runs done, 0 failed: merged/sweep.csv\n"
    one = files(flowing / "one")
    assert len(one) == 2 * 12 + 4  # plan, table, picture, overview of the data sets
    assert files(flowing / "merged") == one
    runs = [row["run"] for part in parts for row in table(flowing / part)]
    assert len(runs) == len(set(runs)) == 12
    # the merged sweep is the sweep: it has nothing left to do
    assert "run 1 of" not in sweep(flowing, *words, "--out", "merged").stdout
    assert files(flowing / "merged") == one
    with open(flowing / "merged/sweep_times.csv") as times:
        assert len(times.readlines()) == 13


def test_a_run_belongs_to_a_shard_by_its_values(flowing):
    """A value more leaves all runs where they were."""
    shard_of = {}
    for values, name in (("40,60,90", "few"), ("20,40,50,60,90,95", "more")):
        for part in shards_of(flowing, ["sweep", "bar.scn", "--steps", "1", "--vary", f"{YIELD}={values}"], 3, name):
            for row in table(flowing / part):
                assert shard_of.setdefault(row[YIELD], part[-1]) == part[-1]
    assert len(shard_of) == 6


def test_runs_that_fail_are_rows_of_the_whole(flowing):
    words = ["sweep", "bar.scn", "--vary", f"{FLOW}=1,100,2,200"]  # two of which are refused
    sweep(flowing, *words, "--out", "one", code=4)
    merged = sweep(flowing, "sweep", "--out", "merged", "--merge", *shards_of(flowing, words, 2), code=4)
    assert merged.stderr == "bar: error: 2 of 4 runs failed\n"
    assert files(flowing / "merged") == files(flowing / "one")
    assert "plasticFlowRate" in (flowing / "merged/run_2/messages.txt").read_text()


def test_what_is_missing_is_said_and_comes_later(flowing):
    first, second = shards_of(flowing, [*TWELVE, "--steps", "2"], 2)
    half = sweep(flowing, "sweep", "--out", "merged", "--merge", first, code=5)
    num_missing = len(table(flowing / second))
    assert half.stderr == f"merged: error: {num_missing} of 12 runs are missing: complete the shards and merge again\n"
    assert len(table(flowing / "merged")) == 12 - num_missing
    sweep(flowing, "sweep", "--out", "merged", "--merge", second)
    sweep(flowing, *TWELVE, "--steps", "2", "--out", "one")
    assert files(flowing / "merged") == files(flowing / "one")


def test_a_log_has_lines_with_the_time_that_is_left(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr(study_command.time, "monotonic", lambda: now[0])
    report = study_command.TerminalReport()
    for done, at in ((3, 104.0), (4, 111.0), (5, 119.0), (6, 250.0)):  # two were there before: 11 s for two, 150 s for four
        now[0] = at
        report.progress(done, 90, "0 failed")
    assert capsys.readouterr().err == "4 of 90  0 failed  7 min 53 s left\n6 of 90  0 failed  52 min 30 s left\n"


def test_what_does_not_belong_together_is_refused(flowing):
    first, second = shards_of(flowing, [*TWELVE, "--steps", "2"], 2)

    def refused(message, *words):
        assert message in sweep(flowing, *words, code=5).stderr

    merge = ["sweep", "--out", "merged", "--merge"]
    refused("the shard differs", *TWELVE, "--steps", "2", "--out", first, "--shard", "2/2")
    sweep(flowing, *TWELVE, "--steps", "3", "--shard", "1/2", "--out", "other")
    refused("are not of one sweep: the number of steps differs", *merge, second, "other")
    refused("part_1: is one of the directories to merge", "sweep", "--out", first, "--merge", first, second)
    refused("absent/sweep.json", *merge, "absent")
    plan = json.loads((flowing / first / "sweep.json").read_text())
    (flowing / "bad").mkdir()
    for text in ("", "{", "[]", '{"vary": 3}', "{}", json.dumps({**plan, "units": []}), json.dumps({**plan, "units": 3}),
                 json.dumps({**plan, "vary": [3, 4]})):
        (flowing / "bad/sweep.json").write_text(text)
        refused("bad/sweep.json", *merge, "bad")
    for key, message in (("version", "the version of Hexaplast differs"), ("simd", "the instruction set differs")):
        (flowing / "bad/sweep.json").write_text(json.dumps({**plan, key: "other"}))
        refused(f"are not of one sweep: {message}", *merge, second, "bad")
        refused(f"holds another sweep: {message}", *TWELVE, "--steps", "2", "--shard", "1/2", "--out", "bad")
    # another result of the same run
    shutil.copytree(flowing / first, flowing / "changed")
    case = sorted((flowing / "changed").glob("run_*"))[0] / "case.json"
    case.write_text(case.read_text().replace('"removed": 0', '"removed": 1'))
    refused("has other results in changed than in part_1", *merge, first, "changed", second)
