# SPDX-License-Identifier: LGPL-2.1-or-later
"""`hexaplast fit`, against bars with a known answer and runs with known values."""
import csv
import json
import math
import os
import random

import pytest

from bars import FLOWING, PULLED, SECTION, command, contracting

MODULUS = "body.youngModulus"
STRESS = ["--free", "body.yieldStress=20:400", "--set", "body.plasticFlowRate=1.3"]
BOTH = [*STRESS[:2], "--free", "body.plasticFlowRate=0.1:8"]
TRUTH = {"body.yieldStress": 110, "body.plasticFlowRate": 1.3}


class Place:
    def __init__(self, path):
        self.path = path

    def write(self, **contents):
        for name, text in contents.items():
            (self.path / name.replace("_", ".")).write_text(text)

    def run(self, *words, code=0, before=()):
        ended = command(*words, cwd=self.path, before=before)
        assert ended.returncode == code, ended.stderr
        return ended

    def fit(self, *words, code=0):
        """Messages, what is printed, and fit.json."""
        ended = self.run("fit", *words, "--out", "found", "--force", code=code)
        self.messages, self.printed = ended.stderr, ended.stdout
        return json.loads((self.path / "found/fit.json").read_text()) if code == 0 else None

    def make_truth(self, **values):
        self.write(bar_scn=FLOWING)
        sets = [word for name, value in (values or TRUTH).items() for word in ("--set", f"{name}={value}")]
        self.run("run", "bar.scn", "--quiet", "--steps", "40", "--frames", "0", "--out", "truth", *sets)
        with open(self.path / "truth/history.csv", newline="") as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


@pytest.fixture
def place(tmp_path):
    return Place(tmp_path)


def values_of(found):
    return [one["value"] for one in found["parameters"]]


def test_what_made_a_curve_is_recovered(place):
    place.make_truth()
    found = place.fit("bar.scn", "--target", "truth/history.csv", "--compare", "current_elongation", *BOTH)
    assert "body." not in place.messages  # no value in doubt
    assert abs(values_of(found)[0] - 110) < 0.11 and abs(values_of(found)[1] - 1.3) < 0.0013
    assert found["relative_rms"] < 1e-4 and found["evaluations"] < 150 and found["converged"]
    stress = found["parameters"][0]
    assert stress["scale"] == "log" and abs(stress["start"] - 60) < 1e-9  # what the scene has
    assert stress["known_from"] < 110 < stress["known_to"]
    # the line to paste gives the fitted curve
    assert found["set"] in place.printed
    place.run("run", "bar.scn", "--quiet", "--steps", "40", "--frames", "0", "--out", "again", *found["set"].split())
    picture = (place.path / "found/fit.svg").read_text()
    assert all(text in picture for text in ("before", "target", "fitted", "elongation [%]", "time [s]"))
    ended = place.run("fit", "bar.scn", "--target", "truth/history.csv", "--compare", "current_elongation", *BOTH, "--out",
                      "found", code=5)
    assert "found: holds an earlier fit (fit.json); --force replaces it" in ended.stderr


def test_over_force_rows_are_compared_where_the_loads_have_that_pull(place):
    """F / (E A), at forces between those of the steps too."""
    rows = "".join(f"{force}, {force / (3210 * SECTION)}\r\n" for force in (4.0, 12.5, 31.0, 50.0))
    place.write(bar_scn=PULLED, curve_csv="# measured\nforce, elongation\n" + rows)
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000")
    assert abs(values_of(found)[0] - 3210) < 0.5 and found["rows"] == 4


def test_the_force_that_a_body_carries_is_compared(place):
    """Moved by 0.1 m within a second."""
    load = "<LinearForceField name='pull' points='2 5 8 11' times='0 1' forces='0 0 0  12.5 0 0'/>"
    moved = "<LinearMovementProjectiveConstraint indices='2 5 8 11' keyTimes='0 1' movements='0 0 0  0.1 0 0'/>"
    assert load in PULLED
    rows = "".join(f"{time},{7000 * SECTION * 0.1 * time}\n" for time in (0.2, 0.65, 1))
    place.write(bar_scn=PULLED.replace(load, moved), curve_csv="time,force\n" + rows)
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000")
    assert abs(values_of(found)[0] - 7000) < 1


def test_a_probe_is_compared(place):
    probe = "<Probe name='tip' value='@nodes.position' indices='2' component='x' change='true'/></Node>"
    scene = PULLED.replace("<MechanicalObject/>", "<MechanicalObject name='nodes'/>").replace("</Node>", probe)
    place.write(bar_scn=scene.replace("steps='11'", "steps='11' endSections='no'"),
                curve_csv="time,probe_tip\n" + "".join(f"{t},{50 * t / (3210 * SECTION)}\n" for t in (0.2, 0.5, 1)))
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000")
    assert found["columns"][0]["name"] == "tip" and found["columns"][0]["unit"] == "m"
    assert "tip [m]" in (place.path / "found/fit.svg").read_text()
    # a run has the loads of the beginning of a step: the pull is that of 0.1 s before
    assert values_of(found)[0] < 3210
    place.write(curve_csv="time,strain\n0.1,1\n0.2,2\n")
    place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000", code=3)
    assert place.messages.startswith("curve.csv:1: error: column 'strain' is not known; comparable are elongation, ")
    assert "force, tip, and probes of the scene" in place.messages
    place.write(curve_csv="time,elongation\n0.1,1\n0.2,2\n")
    place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000", code=3)
    assert "the scene does not stretch or twist its body by the two ends" in place.messages


def test_the_result_does_not_depend_on_the_number_of_runs_at_a_time(place):
    place.make_truth(**{"body.yieldStress": 110})
    words = ["bar.scn", "--target", "truth/history.csv", "--compare", "current_elongation"]
    results = []
    for jobs in ("1", "3"):
        place.fit(*words, *BOTH, "--jobs", jobs)
        results.append(((place.path / "found/fit.json").read_text(), place.printed))
    assert results[0] == results[1]
    # values with which the scene does not run count as such
    place.fit(*words, "--free", "body.plasticFlowRate=1.9:100:linear", "--jobs", "2")
    assert "evaluations failed" in place.messages


def test_what_the_curve_does_not_tell_is_said(place):
    place.write(bar_scn=PULLED, curve_csv="force,elongation\n10,0.02\n30,0.06\n50,0.1\n")
    # nothing reaches the yield stress
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=1000:4000", "--free",
                      "body.yieldStress=1e4:1e6")
    assert "warning: body.yieldStress hardly matters here" in place.messages and MODULUS not in place.messages
    assert found["parameters"][1]["leeway_alone"] is None
    # 1 % of the curve is 1 % of the modulus times the root mean square of F / F_max
    fraction = math.sqrt((0.04 + 0.36 + 1) / 3)
    assert abs(found["parameters"][0]["known_to"] - values_of(found)[0] - 0.01 / fraction * 2000) < 1
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=2500:4000")
    assert f"{MODULUS} is at its limit" in place.messages
    assert found["parameters"][0]["at_limit"] and found["parameters"][0]["confidence_from"] is None
    place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=3000:9000", "--evaluations", "3")
    assert "stopped after 3 evaluations" in place.messages


def hooke(modulus, forces):
    """Rows of force and elongation of a bar of that stiffness across the section."""
    return "force,elongation\n" + "".join(f"{force},{force / (modulus * SECTION)}\n" for force in forces)


def test_two_experiments_tell_together_what_neither_tells_alone(place):
    """A bar that contracts freely tells its modulus, one that cannot a combination of modulus and Poisson's ratio."""
    young, poisson = 3000, 0.3
    confined = young * (1 - poisson) / (1 + poisson) / (1 - 2 * poisson)
    place.write(free_scn=contracting(False), confined_scn=contracting(True), free_csv=hooke(young, (5, 12, 20, 33, 50)),
                confined_csv=hooke(confined, (10, 40, 50)))
    free = ["--free", f"{MODULUS}=500:50000", "--free", "body.poissonRatio=0:0.45"]
    for alone in ("free", "confined"):
        place.fit(f"{alone}.scn", "--target", f"{alone}.csv", *free)
        assert "body.poissonRatio" in place.messages
    found = place.fit("free.scn", "--target", "free.csv", "--experiment", "confined.scn", "confined.csv", "--jobs", "3", *free)
    assert place.messages == ""
    assert abs(values_of(found)[0] - young) < 1e-4 * young and abs(values_of(found)[1] - poisson) < 1e-4 * poisson
    for text in ("free: fitted to free.csv, 5 rows\n", "confined: fitted to confined.csv, 3 rows\n", "elongation of confined.csv"):
        assert text in place.printed
    assert found["rows"] == 5 and found["columns"][1]["target"] == "confined.csv"
    (other,) = found["further_experiments"]
    assert other["scene"] == "confined.scn" and other["rows"] == 3
    picture = (place.path / "found/fit.svg").read_text()
    assert "elongation [%], free" in picture and "elongation [%], confined" in picture


def test_an_experiment_has_columns_and_settings_of_its_own(place):
    # twice the pull, and a column that is none of the scene's
    strong = "force,elongation,width\n" + "".join(f"{f},{f / (3210 * SECTION)},1\n" for f in (20.0, 60.0, 100.0))
    place.write(bar_scn=PULLED, weak_csv=hooke(3210, (4, 25, 50)), strong_csv=strong,
                rod_scn=PULLED.replace("'body'", "'rod'"))
    words = ["bar.scn", "--target", "weak.csv", "--free", f"{MODULUS}=500:50000"]
    other, pull = ["--experiment", "bar.scn", "strong.csv"], "pull.forces=0 0 0  25 0 0"
    found = place.fit(*words, *other, pull, "elongation")
    assert abs(values_of(found)[0] - 3210) < 0.5
    assert found["further_experiments"][0]["overrides"] == [pull]
    for more, code, message in (
            ([*other, pull], 3, "strong.csv:1: error: column 'width' is not known"),
            ([*other, pull, "height"], 3, "strong.csv:1: error: no column that could be compared is called 'height'"),
            ([*other, "elongation"], 3, "strong.csv:3: error: force 60 N: the loads of the scene do not have"),
            ([*other, "elongation", "pull.forse=1"], 2, "(of the scene bar.scn)"),
            ([*other, "elongation", f"{MODULUS}=1"], 2, f"strong.csv: {MODULUS}=1: must not be a free attribute"),
            (["--experiment", "bar.scn"], 2, "--experiment bar.scn: must be SCENE CURVE.csv"),
            (["--experiment", "bar.scn", "absent.csv"], 5, "absent.csv"),
            (["--experiment", "absent.scn", "weak.csv"], 5, "absent.scn"),
            (["--experiment", "rod.scn", "weak.csv"], 2, "(of the scene rod.scn)")):
        place.fit(*words, *more, code=code)
        assert message in place.messages


@pytest.mark.parametrize("curve, message", [
    ("", "curve.csv: error: is empty"), ("# nothing\n\n", "curve.csv: error: is empty"),
    ("elongation\n1\n2\n", "curve.csv:1: error: no column is called time or force"),
    ("time\n1\n2\n", "curve.csv:1: error: no column to compare"),
    ("time,lenght\n1,1\n2,2\n", "curve.csv:1: error: column 'lenght' is not known"),
    ("time,elongation,current_elongation\n1,1,1\n2,2,2\n", "curve.csv:1: error: elongation is there twice"),
    ("time,elongation\n0.1,0.1\n", "curve.csv: error: at least 2 rows are needed"),
    ("time,elongation\n0.1,0\n0.2,0\n", "curve.csv: error: elongation is zero in every row"),
    ("time,elongation\n0.1,0.1\n0.2\n", "curve.csv:3: error: 1 fields, must be 2"),
    ("time,elongation\n0.1,nan\n0.2,1\n", "curve.csv:2: error: elongation: 'nan': must be a finite number"),
    ("time,elongation\n0.1,1_0\n0.2,1\n", "curve.csv:2: error: elongation: '1_0': must be a finite number"),
    ("time,elongation\n0.1,1\n# back\n0.1,2\n", "curve.csv:4: error: time 0.1 does not come after 0.1"),
    ("time,elongation\n-0.1,1\n0.1,2\n", "curve.csv:2: error: time -0.1: must not be negative"),
    ("force,elongation\n10,0.1\n60,0.2\n", "curve.csv:3: error: force 60 N: the loads of the scene do not have"),
    ("force,elongation\n10,0.1\n5,0.2\n", "curve.csv:3: error: force 5 N: the loads of the scene do not have")])
def test_mistakes_of_the_curve_are_named_with_their_line(place, curve, message):
    place.write(bar_scn=PULLED, curve_csv=curve)
    place.fit("bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000", code=3)
    assert place.messages.startswith(message)


def test_what_cannot_be_written_is_found_before_the_first_run(place):
    place.write(bar_scn=PULLED, curve_csv="force, elongation\n12.5, 0.02\n50, 0.08\n")
    d = place.path / "d"
    d.mkdir()

    def refused(message, scene="bar.scn", curve="curve.csv", force=("--force",)):
        ended = place.run("fit", scene, "--target", curve, "--free", f"{MODULUS}=500:50000", "--out", "d", *force, code=5)
        assert message in ended.stderr and ended.stdout == ""

    for name in ("fit.svg", "fit.json", "fit.svg.part"):  # inputs where it writes
        for source, given in ((PULLED, {"scene": f"d/{name}"}), (hooke(2000, (4, 25)), {"curve": f"d/{name}"})):
            (d / name).write_text(source)
            refused(f"d/{name}: is an input", **given)
            assert (d / name).read_text() == source
            (d / name).unlink()
    (d / "fit.svg").write_text("mine")
    refused("d: holds an earlier fit (fit.svg); --force replaces it", force=())
    assert (d / "fit.svg").read_text() == "mine"
    (d / "fit.svg").unlink()
    (d / "fit.svg").mkdir()
    refused("d/fit.svg: is not a regular file")
    (d / "fit.svg").rmdir()
    # a disk that is full at the end takes the files, not the values
    limited = ["sh", "-c", 'trap "" XFSZ; ulimit -f 0; exec "$@" 2>&1 | cat', "sh"]
    full = place.run("fit", "bar.scn", "--target", "curve.csv", "--free", f"{MODULUS}=500:50000", "--out", "d", before=limited)
    assert f"--set {MODULUS}=" in full.stdout
    assert "fit.json.part: cannot be written: File too large" in full.stdout
    assert not os.listdir(d)


@pytest.mark.parametrize("free, message", [
    (["body.youngModulus"], "must be PATH.attribute=lo:hi"), (["body.youngModulus=1:2:cubic"], "must be PATH.attribute=lo:hi"),
    (["body.youngModulus=1:x"], "'x' is no number"), (["body.youngModulus=5:5"], "5 is not less than 5"),
    (["body.youngModulus=0:5:log"], "limits greater than 0"), (["body.poissonRatio=0:0.5"], "must lie in [0, 0.5)"),
    (["body.poisonRatio=0:0.4"], "did you mean 'poissonRatio'?"), (["bodi.youngModulus=1:2"], "bodi"),
    (["body.yieldNorm=1:2"], "must be a number that the scene gives"), (["body.plasticStrain=1:2"], "holds what is computed"),
    (["body.youngModulus=1:2", "body.youngModulus=1:3"], "is free already")])
def test_mistakes_of_the_command_line_end_with_2(place, free, message):
    place.write(bar_scn=PULLED, curve_csv="force,elongation\n10,0.02\n50,0.1\n")
    place.fit("bar.scn", "--target", "curve.csv", *[word for one in free for word in ("--free", one)], code=2)
    assert message in place.messages


# ---- intervals

def noisy(truth, seed, noise, kept, plastic_noise):
    """time and elongations of the truth; noise of which the next row keeps a part."""
    draw = random.Random(seed)
    rows, present = ["time,elongation,plastic_elongation"], draw.gauss(0, 1)
    for row in truth:
        rows.append(f"{row['time']},{row['current_elongation'] + noise * present},"
                    f"{row['plastic_elongation'] + plastic_noise * draw.gauss(0, 1)}")
        present = kept * present + math.sqrt(1 - kept**2) * draw.gauss(0, 1)
    return "\n".join(rows) + "\n"


def test_curves_of_different_noise_count_by_their_own(place):
    truth = place.make_truth()
    place.write(curve_csv=noisy(truth, 3, 0.0002, 0, 0.01))
    both = place.fit("bar.scn", "--target", "curve.csv", *STRESS)
    assert abs(both["columns"][0]["noise"] - 0.0002) < 0.0001 and abs(both["columns"][1]["noise"] - 0.01) < 0.004
    # the noisy curve takes nothing away from the other one
    one = place.fit("bar.scn", "--target", "curve.csv", "--compare", "elongation", *STRESS)
    for a, b in zip(both["parameters"], one["parameters"]):
        assert abs(a["value"] - b["value"]) < 0.5 * (b["confidence_to"] - b["confidence_from"])


def test_differences_that_are_alike_from_row_to_row_are_said(place):
    place.write(curve_csv=noisy(place.make_truth(), 5, 0.002, 0.9, 0))
    slow = place.fit("bar.scn", "--target", "curve.csv", "--compare", "elongation", *STRESS)
    assert slow["columns"][0]["noise_correlation"] > 0.4
    assert "the differences in elongation are alike from row to row" in place.messages and "95 %: " in place.printed


def test_combinations_that_are_not_determined_are_named(place):
    regions = "".join(f"<MaterialRegion name='{name}' indices='{e}' youngModulus='2000'/>" for e, name in
                      enumerate(("near", "far")))
    place.write(bar_scn=PULLED.replace("</Node>", regions + "</Node>"),
                curve_csv="time,elongation\n0.2,0.02\n0.5,0.051\n0.8,0.079\n1,0.1\n")
    found = place.fit("bar.scn", "--target", "curve.csv", "--free", "near.youngModulus=200:200000", "--free",
                      "far.youngModulus=200:200000")
    (step,) = found["undetermined"]
    assert step[0] * step[1] < 0
    assert "the curve does not determine " in place.messages and " together with " in place.messages
    # as many rows as values: any noise could be part of them
    truth = place.make_truth()
    place.write(curve_csv="time,elongation\n" + "".join(f"{row['time']},{row['current_elongation']}\n" for row in truth
                                                        if row["step"] in (12, 25)))
    bare = place.fit("bar.scn", "--target", "curve.csv", *BOTH)
    assert "not more rows than parameters" in place.messages and bare["columns"][0]["noise"] is None
