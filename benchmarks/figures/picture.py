# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of bodies: orthographic views side by side."""
import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.collections import PolyCollection

matplotlib.use("Agg")

# rows: to the right, upwards and towards the viewer, in world axes
SIDE = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # the axis z runs to the right
END = np.eye(3)  # along the axis z, from its upper end
LAMP = np.array([-0.35, 0.85, 0.45]) / np.linalg.norm([-0.35, 0.85, 0.45])  # from the upper left
LENGTH = 0.5  # [m] that is drawn for comparison
COLOURS = matplotlib.colormaps["OrRd"]


class Page:
    """Bodies at one scale, their origins at places in metres; colours are those of values from 0 to `greatest`."""

    def __init__(self, width, greatest):
        """width: [inch]"""
        self.figure, self.axes = pyplot.subplots(figsize=(width, width), layout="constrained")
        self.greatest = greatest
        self.num_panels = 0

    def draw(self, x, faces, values, view, at):
        """A surface: x (nodes, 3) [m]; faces (n, 3 or 4) nodes; values (n) or one for all."""
        corners = (x @ view.T)[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        normals[normals[:, 2] < 0] *= -1
        # mostly even light, so that colours stay comparable with the scale
        brightness = 0.66 + 0.22 * np.maximum(0, normals @ LAMP) + 0.16 * normals[:, 2]
        colours = COLOURS(np.broadcast_to(values / self.greatest, len(faces)))[:, :3] * np.minimum(1, brightness)[:, None]
        order = np.argsort(corners[..., 2].mean(axis=1))  # what is nearer covers what is farther
        self.axes.add_collection(PolyCollection(corners[order][..., :2] + at, facecolors=colours[order], edgecolors="0.2",
                                                linewidths=0.6, joinstyle="round"))

    def text(self, at, words, **style):
        self.axes.text(*at, words, **style)

    def panel(self, at, words="", **style):
        """Begins a panel: "(a) words"."""
        self.num_panels += 1
        self.text(at, f"({chr(ord('a') + self.num_panels - 1)}) {words}".rstrip(), **style)

    def save(self, file, label=None):
        """label: of the scale of colours; none: without it. Below the bodies stands a length."""
        self.axes.set_aspect("equal")
        self.axes.autoscale_view()
        left, bottom = self.axes.get_xlim()[0], self.axes.get_ylim()[0]
        self.axes.plot([left, left + LENGTH], [bottom, bottom], color="0.2", linewidth=2, solid_capstyle="butt")
        self.text((left + LENGTH / 2, bottom - 0.02), f"{LENGTH:g} m", ha="center", va="top")
        self.axes.axis("off")
        if label:
            norm = matplotlib.colors.Normalize(0, self.greatest)
            self.figure.colorbar(matplotlib.cm.ScalarMappable(norm, COLOURS), ax=self.axes, location="bottom", shrink=0.3,
                                 aspect=30, label=label)
        self.figure.savefig(file, dpi=100, bbox_inches="tight")
        pyplot.close(self.figure)
