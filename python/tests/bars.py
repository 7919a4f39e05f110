# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bars of 1 m along x and a section of 0.25 m^2, held at x = 0, and the command that runs them. Without lateral contraction the
elongation under a force F is F / (E A) exactly, whatever the mesh."""
import contextlib
import copy
import importlib
import io
import multiprocessing
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import time
from unittest import mock

SECTION = 0.25  # [m^2]
COMMAND = os.environ["HEXAPLAST_COMMAND"]
SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"
STRETCHED = SCENES / "bar_stretch_high.scn"


def command(*words, cwd=None, before=()):
    words = [str(word) for word in words]
    if words[0] in ("sweep", "fit") and not before:
        return _in_this_process(*words, cwd=cwd)
    # what Python loads for its own sake, a sanitizer say, is none of the command's
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    return subprocess.run([*before, COMMAND, *words], cwd=cwd, env=environment, capture_output=True, text=True)


def _in_this_process(verb, *words, cwd):
    """As hexaplast-sweep and hexaplast-fit, without their second for scipy. Tests of signals start the programs themselves."""
    main = importlib.import_module(f"hexaplast_study.{verb}").main
    out, messages, code = io.StringIO(), io.StringIO(), 0
    handlers = [(number, signal.getsignal(number)) for number in (signal.SIGINT, signal.SIGTERM)]
    here = os.getcwd()
    os.chdir(cwd or here)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(messages), mock.patch.object(sys, "argv", [verb, *words]):
            code = main()
    except SystemExit as ended:
        code = ended.code or 0
    finally:
        os.chdir(here)
        for number, handler in handlers:
            signal.signal(number, handler)
    return subprocess.CompletedProcess([verb, *words], code, out.getvalue(), messages.getvalue())


def carry_out(*words):
    """`hexaplast run` with these words, which must succeed."""
    ended = command("run", *words, "--quiet")
    assert ended.returncode == 0, ended.stderr


def _bar(solver, material, load):
    return ("<Node dt='0.1' gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='11'/>\n" + solver +
            "<RegularGridTopology n='3 2 2' max='1 .5 .5'/><MechanicalObject/>\n"
            "<HexahedronElastoplasticFEMForceField name='body' youngModulus='2000' poissonRatio='0' " + material +
            "/>\n<FixedProjectiveConstraint indices='0 3 6 9'/>" + load + "</Node>")


# In equilibrium at each of its 11 steps. The pull grows to 50 N at t = 1 s, which step 11 begins with.
PULLED = _bar("<StaticSolver newtonSolver='@newton' linearSolver='@factors'/><NewtonRaphsonSolver name='newton' "
              "maxNbIterationsNewton='50' relativeSuccessiveStoppingThreshold='0' relativeInitialStoppingThreshold='0' "
              "absoluteResidualStoppingThreshold='1e-10'/><SparseLDLSolver name='factors'/>\n", "",
              "<LinearForceField name='pull' points='2 5 8 11' times='0 1' forces='0 0 0  12.5 0 0'/>")

# In motion: pulled until it flows, then let go. Joined rest shapes have a shape without load in every row of a run.
FLOWING = _bar("<EulerImplicitSolver rayleighMass='2' rayleighStiffness='0.1'/><SparseLDLSolver/>\n",
               "yieldStress='60' plasticFlowRate='2' restShape='joined'",
               "<DiagonalMass totalMass='20'/><LinearForceField name='pull' points='2 5 8 11' times='-0.1 0.5 2.54 2.56' "
               "forces='0 0 0  12.5 0 0  12.5 0 0  0 0 0'/>")


def contracting(is_confined):
    """The same pull on a bar that contracts freely across, or not at all, with the element whose law is that of Hooke for such
    stretches: the elongation is F / (E A) or F / (M A), M = E (1 - nu) / ((1 + nu) (1 - 2 nu))."""
    across = ("<PartialFixedProjectiveConstraint fixAll='true' fixedDirections='0 1 1'/>" if is_confined else
              "<PartialFixedProjectiveConstraint indices='0 1 2 6 7 8' fixedDirections='0 1 0'/>"
              "<PartialFixedProjectiveConstraint indices='0 1 2 3 4 5' fixedDirections='0 0 1'/>")
    scene = PULLED.replace("poissonRatio='0' ", "poissonRatio='0.1' volumetric='sample' bending='blended' recovery='none' ")
    return scene.replace("<FixedProjectiveConstraint indices='0 3 6 9'/>",
                         "<PartialFixedProjectiveConstraint indices='0 3 6 9' fixedDirections='1 0 0'/>" + across)


def _go_on(pickled):
    os.chdir("/")  # a scene that was read by a relative path is found
    motion = pickle.loads(pickled)
    motion.run(10)
    return motion.state_hash()


def copies_before_running_on(motion):
    """Copies of a simulation or scene, which then runs on for ten steps; and its hash after them, which one that was pickled
    has in another process."""
    pickled = pickle.dumps(motion)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        elsewhere = pool.apply_async(_go_on, [pickled])
        copies = [motion.copy(), copy.copy(motion), copy.deepcopy(motion)]
        motion.run(10)
        assert elsewhere.get(60) == motion.state_hash()
    return copies, motion.state_hash()


def processes(*words):
    """Those whose command lines have these words, by /proc."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = entry.read_text().replace("\0", " ")
        except OSError:
            continue
        if all(word in line for word in words):
            found.append(int(entry.parent.name))
    return found


def wait_for(condition, seconds=60):
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.01)
    return found
