# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies by executors, against the command alone; what their data sets hold, against scenes."""
import concurrent.futures
import contextlib
import csv
import json
import os
import pickle
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

import hexaplast
from hexaplast import study

from bars import FLOWING, STRETCHED as BAR, carry_out, command, processes, wait_for

YIELD, FLOW = "bar/material.yieldStress", "bar/material.plasticFlowRate"
GRID = {YIELD: (200, 400.0), FLOW: "1,2"}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The sweep by the command."""
    out = tmp_path_factory.mktemp("alone")
    ended = command("sweep", BAR, "--vary", f"{YIELD}=200,400.0", "--vary", f"{FLOW}=1,2", "--steps", 20, "--out", out,
                    "--fields", "displacement,plasticStrain", "--every", 8)
    assert ended.returncode == 0, ended.stderr
    return out


def assert_same(out, alone):
    for name in ("sweep.csv", "sweep.svg", "sweep.json", "sweep.h5", *[f"run_{n}/states.h5" for n in range(1, 5)]):
        assert (out / name).read_bytes() == (alone / name).read_bytes(), name


def sweep(executor, out):
    return study.sweep(BAR, GRID, executor, out=out, steps=20, fields=["displacement", "plasticStrain"], every=8)


def test_a_sweep_by_processes_is_that_of_the_command(tmp_path, alone):
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        found = sweep(executor, tmp_path / "out")
    assert_same(tmp_path / "out", alone)
    assert len(found) == 4 and not found.failed.any()
    assert found[YIELD].tolist() == [200, 200, 400, 400] and found[FLOW].tolist() == [1, 2, 1, 2]
    scene = hexaplast.run(BAR, steps=20, overrides={YIELD: 400, FLOW: 1})
    assert found["state_hash"][2] == scene.state_hash()
    assert pickle.loads(pickle.dumps(found))["state_hash"] == found["state_hash"]

    # once more costs nothing
    before = (tmp_path / "out" / "run_1" / "states.h5").stat().st_mtime_ns
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        sweep(executor, tmp_path / "out")
    assert (tmp_path / "out" / "run_1" / "states.h5").stat().st_mtime_ns == before


def test_a_sweep_by_dask_is_that_of_the_command(tmp_path, alone):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            sweep(client.get_executor(), tmp_path)
    assert_same(tmp_path, alone)


def test_a_sweep_by_mpi_is_that_of_the_command(tmp_path, alone):
    pytest.importorskip("mpi4py")
    script = tmp_path / "by_mpi.py"
    script.write_text(f"""
from mpi4py.futures import MPIPoolExecutor
from hexaplast import study
if __name__ == "__main__":
    with MPIPoolExecutor() as executor:
        study.sweep({str(BAR)!r}, {GRID!r}, executor, out={str(tmp_path / "out")!r}, steps=20,
                    fields=["displacement", "plasticStrain"], every=8)
""")
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_btl="self,vader", OMPI_MCA_plm="isolated",
                       OMPI_MCA_btl_vader_single_copy_mechanism="none")
    ended = subprocess.run(["mpiexec", "-n", "3", sys.executable, "-m", "mpi4py.futures", str(script)], env=environment,
                           capture_output=True, text=True, timeout=200)
    assert ended.returncode == 0, ended.stderr
    assert_same(tmp_path / "out", alone)


def test_runs_that_fail_are_rows(tmp_path):
    found = study.sweep(BAR, {FLOW: [1, 1000]}, out=tmp_path, steps=3)
    assert found.failed.tolist() == [False, True]
    assert np.isnan(found["elastic_energy"][1]) and found["state_hash"][1] == ""
    assert found.data is None


@pytest.mark.parametrize("grid, error, message", [({FLOW: [1, -1]}, ValueError, "plasticFlowRate"),
                                                  ({"bar/material.yield": [1]}, ValueError, "has no attribute .yield."),
                                                  ({FLOW: "1:2"}, ValueError, "must be PATH.attribute=a:b:n"),
                                                  ({FLOW: "1:2:0"}, ValueError, "'0' values: must be a whole number from 2"),
                                                  ({FLOW: []}, ValueError, "plasticFlowRate: there are no values"),
                                                  ({}, ValueError, "nothing is varied")])
def test_mistakes_are_exceptions(tmp_path, grid, error, message):
    with pytest.raises(error, match=message):
        study.sweep(BAR, grid, out=tmp_path / "out")


def test_a_scene_that_is_absent_is_an_exception(tmp_path):
    with pytest.raises(OSError, match="absent.scn"):
        study.sweep("absent.scn", {FLOW: [1]}, out=tmp_path / "out")


def test_an_earlier_sweep_hides_no_refused_scene(tmp_path):
    scene = tmp_path / "bar.scn"
    scene.write_bytes(BAR.read_bytes())
    study.sweep(scene, {FLOW: [1, 2]}, out=tmp_path / "out", steps=2)
    scene.write_text(scene.read_text().replace("yieldStress", "yieldStres"))
    with pytest.raises(ValueError, match="yieldStres"):
        study.sweep(scene, {FLOW: [1, 2]}, out=tmp_path / "out", steps=2)


def test_a_killed_run_keeps_the_others(tmp_path):
    grid, out = {"RunSettings1.steps": [1, 200000, 2]}, tmp_path / "out"

    def kill():
        wait_for(lambda: (out / "run_3").exists())
        os.kill(wait_for(lambda: processes(" run ", "steps=200000", str(out)))[0], signal.SIGKILL)

    with concurrent.futures.ThreadPoolExecutor(1) as other:
        killer = other.submit(kill)
        with pytest.raises(OSError, match="1 of 3 runs are missing"):
            study.sweep(BAR, grid, out=out, jobs=2)
        killer.result()
    rows = list(csv.DictReader((out / "sweep.csv").open(newline="")))
    assert [(row["run"], row["exit_code"]) for row in rows] == [("1", "0"), ("3", "0")]


def test_a_run_ends_with_its_worker(tmp_path):
    with concurrent.futures.ProcessPoolExecutor(1) as executor:
        worker = executor.submit(os.getpid).result()
        with concurrent.futures.ThreadPoolExecutor(1) as other:
            call = other.submit(study.sweep, BAR, {"RunSettings1.steps": [200000, 1]}, executor, out=tmp_path)
            wait_for(lambda: processes(" run ", str(tmp_path)))
            os.kill(worker, signal.SIGKILL)
            with pytest.raises(concurrent.futures.process.BrokenProcessPool):
                call.result()
    wait_for(lambda: not processes(" run ", str(tmp_path)), 20)


def broken(*_):
    raise RuntimeError("a node died")


@pytest.mark.parametrize("pool", [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor])
def test_an_executor_that_fails_ends_the_study(tmp_path, flowing, curve, monkeypatch, pool):
    monkeypatch.setattr("hexaplast_study.sweep.carry_out", broken)
    monkeypatch.setattr("hexaplast_study.fit.answer", broken)
    with pool(2) as executor:
        with pytest.raises(RuntimeError, match="a node died"):
            study.sweep(BAR, {FLOW: [1, 2]}, executor, out=tmp_path / "sweep", steps=2)
        with pytest.raises(RuntimeError, match="a node died"):
            study.fit(flowing, curve, FREE, executor, out=tmp_path / "fit", compare=["current_elongation"])
    assert not list((tmp_path / "fit").glob("*")) and not list((tmp_path / "sweep").glob("run_*"))


def test_data_sets_hold_what_scenes_hold(alone):
    scene = hexaplast.Scene(BAR, {YIELD: 400, FLOW: 2})
    initial = scene.positions.copy()
    with h5py.File(alone / "run_4" / "states.h5") as run, h5py.File(alone / "sweep.h5") as all_runs:
        assert run["step"][:].tolist() == [0, 8, 16, 20]
        assert np.array_equal(run["positions"], initial)
        assert run["hexahedra"].shape == (90, 8)
        for state, step in enumerate(run["step"]):
            while scene.num_steps < step:
                scene.step()
            assert np.array_equal(run["fields/displacement"][state], scene.positions - initial)
            strain = scene.body.fields(scene.positions).plastic_strain
            assert np.array_equal(run["fields/plasticStrain"][state], strain)
            assert run["time"][state] == scene.time
        assert run.attrs["state_hash"] == scene.state_hash()
        assert run.attrs["scene"] == "bar_stretch_high.scn" and run.attrs["version"] == hexaplast.__version__
        assert run.attrs["simd"] == hexaplast.simd_target()
        assert dict(run["overrides"].attrs) == {YIELD: "400.0", FLOW: "2"}
        assert run["fields/displacement"].attrs["unit"] == "m" and run["time"].attrs["unit"] == "s"
        assert run["fields/displacement"].compression == "gzip" and run["fields/displacement"].chunks[1:] == (176, 3)

        assert all_runs.attrs["version"] == hexaplast.__version__ and all_runs.attrs["simd"] == hexaplast.simd_target()
        assert all_runs["fields/displacement"].shape == (4, 4, 176, 3)
        assert np.array_equal(all_runs["fields/displacement"][3], run["fields/displacement"])
        assert all_runs["vary"][YIELD][:].tolist() == [200, 200, 400, 400]
        assert all_runs["vary"][YIELD].attrs["unit"] == "Pa"
        assert all_runs["results/state_hash"].asstr()[3] == scene.state_hash()


TORN = """<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><RunSettings steps='100'/>
<EulerImplicitSolver rayleighMass='1' rayleighStiffness='0.05'/><SparseLDLSolver/>
<RegularGridTopology n='6 2 2' max='.5 .1 .1'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>
<HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' poissonRatio='0.3' yieldStress='200'
 plasticFlowRate='4' fractureStretch='1.3'/><FixedProjectiveConstraint indices='0 6 12 18'/>
<GraspForceField name='forceps' radius='0.16' graspTime='0' keyTimes='0 0.8' positions='.5 .05 .05  1.2 .05 .05'
 stiffness='500'/><Probe name='pull' value='@forceps.force' component='x'/></Node>"""


def test_what_is_not_there_has_no_number(tmp_path):
    """Runs that failed, hexahedra that are gone. Probes are those of history.csv."""
    scene = tmp_path / "torn.scn"
    scene.write_text(TORN)
    path = tmp_path / "torn.h5"
    carry_out(scene, "--data", path, "--fields", "plasticStrain,contactForce,load,volumeRatio", "--every", 10)
    carry_out(scene, "--out", tmp_path / "run", "--frames", 0)
    with open(tmp_path / "run" / "history.csv", newline="") as file:
        pull = [float(row["probe_pull"]) for row in list(csv.DictReader(file))[::10]]
    torn = hexaplast.run(scene)
    gone = ~torn.body.alive.astype(bool)
    assert gone.any() and not gone.all()
    with h5py.File(path) as run:
        assert np.array_equal(np.isnan(run["fields/plasticStrain"][-1]), gone)
        assert not np.isnan(run["fields/plasticStrain"][0]).any()
        assert np.abs(run["fields/contactForce"]).max() > 0
        assert np.array_equal(run["fields/contactForce"], run["fields/load"])  # forceps are the only load there
        assert run["probes/pull"][:].tolist() == pull
    study.sweep(BAR, {FLOW: [1, 1000]}, out=tmp_path / "half", steps=4, fields=["displacement"], every=2)
    with h5py.File(tmp_path / "half" / "sweep.h5") as half:
        assert np.isnan(half["fields/displacement"][1]).all() and not np.isnan(half["fields/displacement"][0]).any()
        assert half["exit_code"][:].tolist() == [0, 3] and half["step"][:].tolist() == [[0, 2, 4], [-1, -1, -1]]


@pytest.fixture(scope="module")
def flowing(tmp_path_factory):
    scene = tmp_path_factory.mktemp("flowing") / "bar.scn"
    scene.write_text(FLOWING)
    return scene


FREE = {"body.yieldStress": (20, 400)}


@pytest.fixture(scope="module")
def curve(flowing):
    carry_out(flowing, "--out", flowing.parent / "truth", "--frames", 0, "--steps", 40, "--set", "body.yieldStress=110")
    return flowing.parent / "truth" / "history.csv"


@pytest.fixture(scope="module")
def fitted_alone(flowing, curve):
    """The fit by the command."""
    out = flowing.parent / "fitted"
    ended = command("fit", flowing, "--target", curve, "--compare", "current_elongation,plastic_elongation", "--free",
                    "body.yieldStress=20:400", "--evaluations", 30, "--out", out)
    assert ended.returncode == 0, ended.stderr
    return json.loads((out / "fit.json").read_text())


@pytest.mark.parametrize("pool", [contextlib.nullcontext, lambda: concurrent.futures.ProcessPoolExecutor(2)], ids=["none", "processes"])
def test_a_fit_by_an_executor_is_that_of_the_command(tmp_path, flowing, curve, fitted_alone, pool):
    with pool() as executor:
        found = study.fit(flowing, curve, FREE, executor, out=tmp_path / "fit", evaluations=30,
                          compare=["current_elongation", "plastic_elongation"])
    assert abs(found.values_found["body.yieldStress"] - 110) < 0.03
    assert found["parameters"][0]["confidence_from"] is not None and len(found["columns"]) == 2
    assert fitted_alone == found


def test_a_fit_of_several_experiments_is_that_of_the_command(tmp_path, flowing, curve):
    carry_out(flowing, "--steps", 30, "--frames", 0, "--out", tmp_path / "other", "--set", "body.yieldStress=110", "--set",
              "body.plasticFlowRate=4")
    other = tmp_path / "other" / "history.csv"
    experiment = dict(scene=flowing, target=other, compare=["plastic_elongation"], overrides={"body.plasticFlowRate": 4})
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        found = study.fit(flowing, curve, FREE, executor, out=tmp_path / "fit", compare=["current_elongation"],
                          experiments=[experiment])
    assert abs(found.values_found["body.yieldStress"] - 110) < 0.03
    assert len(found["further_experiments"]) == 1 and [c["target"] for c in found["columns"]] == [str(curve), str(other)]
    ended = command("fit", flowing, "--target", curve, "--compare", "current_elongation", "--free", "body.yieldStress=20:400",
                    "--out", tmp_path / "alone", "--experiment", flowing, other, "plastic_elongation",
                    "body.plasticFlowRate=4")
    assert ended.returncode == 0, ended.stderr
    assert json.loads((tmp_path / "alone" / "fit.json").read_text()) == found
    with pytest.raises(TypeError):
        study.fit(flowing, curve, FREE, out=tmp_path / "none", experiments=[dict(scene=flowing)])


def test_a_fit_that_cannot_be_is_an_exception(tmp_path, flowing, curve):
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        with pytest.raises(ValueError, match="plasticFlowRaet"):
            study.fit(flowing, curve, {"body.plasticFlowRaet": (1, 2)}, executor, out=tmp_path / "fit")


BAR_OF_TWO = """<Node name='{name}'><EulerImplicitSolver rayleighStiffness='0.05'/><SparseLDLSolver/>
<RegularGridTopology n='5 3 3' min='0 {y} 0' max='.4 {top} .2'/><MechanicalObject/><DiagonalMass massDensity='1000'/>
<HexahedronElastoplasticFEMForceField name='body' youngModulus='5000'/>
<FixedProjectiveConstraint indices='0 5 10 15'/>{blade}</Node>"""


def test_data_sets_follow_a_cut(tmp_path):
    """Of two bodies the first is cut, so that its new nodes lie behind those of both."""
    blade = "<BladeController points='0 0 -.1 0 0 .3' keyTimes='0 .1' positions='.21 -.1 0 .21 .3 0'/>"
    scene = tmp_path / "cut.scn"
    scene.write_text("<Node dt='0.01' gravity='0 -1 0'><DefaultAnimationLoop/><RunSettings steps='12'/>"
                     + BAR_OF_TWO.format(name="lower", y=0, top=.2, blade=blade)
                     + BAR_OF_TWO.format(name="upper", y=1, top=1.2, blade="") + "</Node>")
    carry_out(scene, "--data", tmp_path / "cut.h5", "--fields", "displacement,strain", "--every", 2)
    with h5py.File(tmp_path / "cut.h5") as run:
        displacement, initial_node = run["fields/displacement"][:], run["topology/initial_node"][:]
        corners = dict(zip(run["topology/step"][:].tolist(), run["topology/hexahedra"][:]))
        positions, present = run["positions"][:], run["hexahedra"][:]
        steps = run["step"][:].tolist()
    assert displacement.shape == (7, 99, 3) and initial_node[:90].tolist() == list(range(90))
    assert len(corners) > 1 and 0 not in corners  # it opens in more than one of these states
    scene = hexaplast.Scene(scene)
    for row, step in enumerate(steps):
        while scene.num_steps < step:
            scene.step()
        present = corners.get(step, present)
        nodes = np.unique(present)
        assert np.array_equal(np.isnan(displacement[row, :, 0]), np.isin(np.arange(99), nodes, invert=True))
        moved = positions[initial_node[nodes]] + displacement[row, nodes]
        where = np.full((99, 3), np.nan)
        where[nodes] = moved
        for body, first in zip(scene.bodies, (0, 16)):
            expected = body.positions[body.hexahedra]
            assert np.allclose(where[present[first:first + 16]], expected, rtol=0, atol=1e-15)
