# SPDX-License-Identifier: LGPL-2.1-or-later
"""What notebooks show: the viewer of reports, and meshes of meshio."""
import html
import os
import pathlib

import numpy as np

from ._hexaplast import Scene, Simulation, _page_of_run


class Viewer:
    """A run in three dimensions, as reports have it. A notebook shows it as the last line of a cell."""

    def __init__(self, page, height):
        self._page = page
        self._height = height

    @property
    def html(self):
        """The page: one file that needs nothing else."""
        return self._page

    def save(self, file):
        """Writes the page."""
        pathlib.Path(file).write_text(self._page, encoding="utf-8")

    def _repr_html_(self):
        return (f'<iframe srcdoc="{html.escape(self._page)}" sandbox="allow-scripts" title="Hexaplast" '
                f'style="width: 100%; height: {self._height}px; border: 0"></iframe>')


def show(what, *, height=600):
    """The viewer of a Simulation, of a Scene, or of the directory of a run.

    Of a Simulation or Scene it has what was kept since record(), and the present state. height: [pixels]
    """
    if not height >= 200:
        raise ValueError(f"height = {height} must be at least 200 (pixels)")
    if isinstance(what, (Simulation, Scene)):
        return Viewer(what._page(), height)
    if not isinstance(what, (str, os.PathLike)):
        raise TypeError(f"show: {what!r} is no Simulation, no Scene, and no directory of a run")
    return Viewer(_page_of_run(what), height)


def _repr_html_(self):
    try:
        return show(self)._repr_html_()
    except ValueError:  # nothing that a viewer shows: the notebook prints the object's name
        return None


def to_meshio(self):
    """The present state as a meshio.Mesh: the remaining hexahedra, with the arrays that `hexaplast run` writes."""
    try:
        import meshio
    except ImportError as error:
        raise ImportError("to_meshio() needs meshio (Debian: python3-meshio; elsewhere: pip install meshio)") from error
    bodies = self.bodies if isinstance(self, Scene) else [self.body]
    if not bodies:
        raise ValueError("the scene has no body: there are no hexahedra")
    first_nodes = np.cumsum([0] + [body.num_nodes for body in bodies])
    kept = np.flatnonzero(np.concatenate([body.alive for body in bodies]))
    hexahedra = np.concatenate([body.hexahedra + first for body, first in zip(bodies, first_nodes)])
    fields = [body.fields(self.positions[first:first + body.num_nodes]) for body, first in zip(bodies, first_nodes)]
    names = ("plastic_strain", "strain", "stress_norm", "volume_ratio", "yield_stress")
    cell_data = {name: [np.concatenate([getattr(of, name) for of in fields])[kept]] for name in names}
    if len(bodies) > 1:
        cell_data["body"] = [np.repeat(np.arange(len(bodies)), [body.num_hexahedra for body in bodies])[kept]]
    return meshio.Mesh(
        self.positions.copy(),
        [("hexahedron", hexahedra[kept])],
        point_data={"displacement": self.positions - np.concatenate([body.initial_positions for body in bodies]),
                    "velocity": self.velocities.copy(),
                    "plastic_rest_position": np.concatenate([body.plastic_rest_positions for body in bodies])},
        cell_data={"id": [kept], **cell_data},
    )


for cls in (Simulation, Scene):
    cls._repr_html_ = _repr_html_
    cls.to_meshio = to_meshio
