# SPDX-License-Identifier: LGPL-2.1-or-later
"""What notebooks show, decoded and in a browser, and meshes of meshio."""
import ast
import html
import json
import os
import pathlib
import re
import sys
import tempfile

import numpy as np
import pytest

import hexaplast

from bars import STRETCHED, carry_out

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "page"))
import browser as chromium  # noqa: E402
import viewer_checks  # noqa: E402
import viewer_data  # noqa: E402


def bar(yield_stress=300, cells=(2, 2, 6)):
    positions, hexahedra = hexaplast.grid(cells, (0, 0, 0), (0.1, 0.1, 0.3))
    material = hexaplast.Material(young_modulus=5000, yield_stress=yield_stress, flow_rate=4)
    simulation = hexaplast.Simulation(hexaplast.Body(positions, hexahedra, material), rayleigh_mass=1)
    simulation.fix(positions[:, 2] == 0)
    forces = np.zeros_like(positions)
    forces[positions[:, 2] == 0.3, 2] = 0.5
    return simulation, forces


def shown(viewer):
    """The data of the viewer in a page, and its arrays."""
    runs = viewer_data.RunData(viewer.html).found
    assert len(runs) == 1
    data = json.loads(runs[0])
    return data, viewer_data.unpacked(data)


def positions_shown(data, arrays, state):
    count = 3 * data["nodes"]
    return np.reshape(viewer_data.places(arrays["positions"][count * state:count * (state + 1)], data["box"]), (-1, 3))


def rounding(data):
    """[m] of a position in 16 bits."""
    return 0.51 * max(np.subtract(data["box"][3:], data["box"][:3])) / 65535


def test_without_a_record_the_present_state_is_shown():
    simulation, forces = bar()
    simulation.run(30, forces)
    data, arrays = shown(hexaplast.show(simulation))
    assert [state["step"] for state in data["states"]] == [30]
    assert np.abs(positions_shown(data, arrays, 0) - simulation.positions).max() < rounding(data)
    assert data["states"][0]["fixed"] == list(range(9))
    assert sum(load[3] for load in data["states"][0]["loads"]) > 0


def test_a_record_has_states_at_equal_distances_and_the_present_one():
    simulation, forces = bar()
    simulation.record()
    at = {0: simulation.positions.copy()}
    for step in range(1, 138):
        simulation.step(forces)
        at[step] = simulation.positions.copy()
    data, arrays = shown(hexaplast.show(simulation))
    steps = [state["step"] for state in data["states"]]
    assert steps == [*range(0, 137, 4), 137]  # 60 at most, so that every fourth is kept
    assert data["steps"] == 137
    for number, step in enumerate(steps):
        assert np.abs(positions_shown(data, arrays, number) - at[step]).max() < rounding(data)

    simulation.reset()
    simulation.run(5)
    assert [state["step"] for state in shown(hexaplast.show(simulation))[0]["states"]] == [*range(6)]


def test_a_record_changes_no_bit():
    hashes = []
    for records in (False, True):
        simulation, forces = bar()
        if records:
            simulation.record()
        simulation.run(80, forces)
        hashes.append(simulation.state_hash())
    assert hashes[0] == hashes[1]


def test_removed_hexahedra_are_gone_in_the_states_after():
    """States that are dropped in between do not lose them, nor does the last one that is dropped."""
    simulation, forces = bar()
    simulation.record()
    for step, hexahedron in ((3, 20), (58, 22), (60, 23), (61, 21)):
        simulation.run(step - simulation.num_steps, forces)
        simulation.body.remove([hexahedron])
    simulation.run(3, forces)
    data, _ = shown(hexaplast.show(simulation))
    gone = {state["step"]: state["gone"] for state in data["states"] if "gone" in state}
    assert gone == {4: [20], 60: [22], 62: [21, 23]}


def test_a_scene_shows_what_it_ran():
    scene = hexaplast.run(STRETCHED, steps=20, record=True)
    data, arrays = shown(hexaplast.show(scene))
    assert data["title"] == "bar_stretch_high" and len(data["states"]) == 21
    assert np.abs(positions_shown(data, arrays, 20) - scene.positions).max() < rounding(data)
    assert scene._repr_html_() == hexaplast.show(scene)._repr_html_()


def test_a_run_is_shown_as_its_report_shows_it(tmp_path):
    carry_out(STRETCHED, "--steps", 10, "--frames", 0, "--out", tmp_path / "out")
    of_report = viewer_data.RunData((tmp_path / "out" / "report.html").read_text()).found
    assert viewer_data.RunData(hexaplast.show(tmp_path / "out").html).found == of_report
    assert viewer_data.RunData(hexaplast.show(str(tmp_path / "out")).html).found == of_report


def test_pages_need_nothing_else_and_are_escaped_in_frames():
    viewer = hexaplast.show(bar()[0], height=321)
    assert "default-src 'none'" in viewer.html and "<h1>" not in viewer.html
    assert not re.search(r'(src|href)="?http', viewer.html)
    frame = viewer._repr_html_()
    inside = re.fullmatch(r'<iframe srcdoc="([^"]*)" sandbox="allow-scripts" title="Hexaplast" '
                          r'style="width: 100%; height: 321px; border: 0"></iframe>', frame).group(1)
    assert html.unescape(inside) == viewer.html


def test_a_page_is_saved(tmp_path):
    viewer = hexaplast.show(bar()[0])
    viewer.save(tmp_path / "bar.html")
    assert (tmp_path / "bar.html").read_text(encoding="utf-8") == viewer.html


def test_what_cannot_be_shown_is_named(tmp_path):
    with pytest.raises(OSError, match="nowhere: is no directory"):
        hexaplast.show(tmp_path / "nowhere")
    with pytest.raises(ValueError, match="has no viewer.json, which `hexaplast run --out` writes"):
        hexaplast.show(tmp_path)
    (tmp_path / "viewer.json").write_text("{}")
    with pytest.raises(ValueError, match="viewer.json: is no file that a run writes"):
        hexaplast.show(tmp_path)
    with pytest.raises(TypeError, match="show: 5 is no Simulation, no Scene, and no directory of a run"):
        hexaplast.show(5)
    with pytest.raises(ValueError, match="height = 10 must be at least 200"):
        hexaplast.show(bar()[0], height=10)


def test_a_body_that_is_too_large_is_refused_and_printed_by_its_name():
    positions, hexahedra = hexaplast.grid((10, 100, 100), (0, 0, 0), (1, 10, 10))
    simulation = hexaplast.Simulation(hexaplast.Body(positions, hexahedra), solver="cg")
    for attempt in (simulation.record, lambda: hexaplast.show(simulation)):
        with pytest.raises(ValueError, match="has 112211 nodes: the viewer shows at most 100000"):
            attempt()
    assert simulation._repr_html_() is None


def test_meshio_has_the_present_state(tmp_path):
    meshio = pytest.importorskip("meshio")
    simulation, forces = bar()
    simulation.run(60, forces)
    simulation.body.remove([3, 20])
    fields = simulation.fields()
    simulation.to_meshio().write(tmp_path / "bar.vtu")
    mesh = meshio.read(tmp_path / "bar.vtu")
    kept = [e for e in range(24) if e not in (3, 20)]
    assert np.array_equal(mesh.points, simulation.positions)
    assert np.array_equal(mesh.cells_dict["hexahedron"], simulation.body.hexahedra[kept])
    assert np.array_equal(mesh.cell_data["id"][0], kept)
    assert np.array_equal(mesh.cell_data["plastic_strain"][0], fields.plastic_strain[kept])
    assert np.array_equal(mesh.point_data["displacement"], simulation.positions - simulation.body.initial_positions)
    assert np.array_equal(mesh.point_data["plastic_rest_position"], simulation.body.plastic_rest_positions)


def test_a_mesh_of_meshio_keeps_its_state():
    simulation, forces = bar()
    pytest.importorskip("meshio")
    mesh = simulation.to_meshio()
    before = mesh.points.copy(), mesh.cell_data["plastic_strain"][0].copy()
    simulation.run(60, forces)
    assert np.array_equal(mesh.points, before[0]) and np.array_equal(mesh.cell_data["plastic_strain"][0], before[1])


def test_meshio_has_the_arrays_of_the_command(tmp_path):
    meshio = pytest.importorskip("meshio")
    carry_out(STRETCHED, "--steps", 50, "--frames", 0, "--out", tmp_path / "out")
    theirs = meshio.read(max((tmp_path / "out").glob("mesh_*50.vtu")))
    ours = hexaplast.run(STRETCHED, steps=50).to_meshio()
    assert np.array_equal(ours.points, theirs.points)
    for name, values in ours.cell_data.items():
        if name != "yield_stress" and name != "stress_norm":
            assert np.allclose(values[0], theirs.cell_data[name][0], rtol=1e-12, atol=0), name
    for name, values in ours.point_data.items():
        assert np.allclose(values, theirs.point_data[name], rtol=1e-12, atol=0), name


def test_without_meshio_the_error_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(ImportError, match="needs meshio .Debian: python3-meshio"):
        bar()[0].to_meshio()


def results_of_cells(notebook):
    """What the cells of a script with lines `# %%` evaluate to at their ends, as a notebook shows it."""
    names, results = {}, []
    for cell in re.split(r"^# %%.*\n", notebook.read_text(), flags=re.MULTILINE):
        tree = ast.parse(cell)
        last = ast.Expression(tree.body.pop().value) if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, str(notebook), "exec"), names)
        if last:
            results.append(eval(compile(last, str(notebook), "eval"), names))
    return results


def test_several_bodies_are_one_mesh(tmp_path):
    meshio = pytest.importorskip("meshio")
    bar = ("<Node name='{0}'><RegularGridTopology n='2 2 {1}' min='{0} 0 0' max='{0}.5 1 1'/>"
           "<MechanicalObject name='nodes'/><UniformMass totalMass='1'/>"
           "<HexahedronElastoplasticFEMForceField youngModulus='1000'/></Node>")
    file = tmp_path / "two.scn"
    file.write_text("<Node dt='0.01'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
                    "<RunSettings steps='2' outputEvery='1'/>" + bar.format(0, 3) + bar.format(2, 4) + "</Node>")
    scene = hexaplast.run(file, record=True)
    data, arrays = shown(hexaplast.show(scene))
    assert data["nodes"] == 28 and [state["step"] for state in data["states"]] == [0, 1, 2]
    assert np.abs(positions_shown(data, arrays, 2) - scene.positions).max() < rounding(data)

    carry_out(file, "--frames", 0, "--out", tmp_path / "out")
    of_run, ours = meshio.read(tmp_path / "out" / "mesh_000002.vtu"), scene.to_meshio()
    assert (ours.points == of_run.points).all()
    assert (ours.cells_dict["hexahedron"] == of_run.cells_dict["hexahedron"]).all()
    assert (ours.cell_data["body"][0] == of_run.cell_data["body"][0]).all()
    assert (ours.point_data["displacement"] == of_run.point_data["displacement"]).all()


def test_the_notebook_shows_two_viewers_that_draw():
    pytest.importorskip("meshio")
    results = results_of_cells(ROOT / "python" / "examples" / "notebook.py")
    assert len(results) == 3 and results[2].cells_dict["hexahedron"].shape == (90, 8)
    program = chromium.program()
    if not program:
        pytest.skip("there is no Chromium")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as directory:  # the browser writes until it has gone
        page = pathlib.Path(directory) / "notebook.html"
        frames = "".join(f'<div class="viewer" id="cell{k}">{result._repr_html_()}</div>'
                         for k, result in enumerate(results[:2]))
        page.write_text(f'<!DOCTYPE html><meta charset="utf-8"><title>notebook</title>{frames}')
        browser = chromium.Browser(program, pathlib.Path(directory) / "profile")
        try:
            browser.open(page, 1000, "light")
            for k in range(2):
                share = drawn_share(browser, f"#cell{k}")
                if "PICTURES" in os.environ:
                    pathlib.Path(os.environ["PICTURES"], f"cell{k}.png").write_bytes(browser.shot_of(f"#cell{k}"))
                assert share > 0.02, f"{share:.2%} of the frame of cell {k} has colours of the scale"
            assert not [event for event in browser.events if event.get("method") == "Runtime.exceptionThrown"]
        finally:
            browser.close()


def drawn_share(browser, selector, attempts=40):
    """Part of the upper half of a frame that has colours of tissue, as soon as there are some."""
    share = 0
    for _ in range(attempts):
        picture = viewer_checks.pixels_of(browser.shot_of(selector, viewer_checks.SCALE))
        share = viewer_checks.share_of_tissue(picture, bottom=len(picture) // 2)
        if share > 0.02:
            break
    return share
