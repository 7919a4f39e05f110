# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pictures of bodies: orthographic views side by side on a page, rendered by hexaplast_draw."""
import json
import subprocess

import numpy as np

from bar import BIN, WORK

# rows: to the right, upwards and towards the viewer, in world axes
SIDE = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # the axis z runs to the right
END = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]])  # along the axis, from its upper end

PIECES = 4  # of a quadrilateral, along each edge: it is drawn as the bilinear patch it is
DEPTH = 4.0  # [m] seen in front of and behind the origin
EDGE_DEPTH = 0.0005  # by which edges stand before the faces that they bound


def _brightness(normals):
    """Mostly even light, so that colours stay comparable with the scale, and a lamp from the upper left."""
    lamp = np.array([-0.35, 0.85, 0.45]) / np.linalg.norm([-0.35, 0.85, 0.45])
    normals = np.where(normals[:, 2:] < 0, -normals, normals)
    return np.minimum(1, 0.66 + 0.22 * np.maximum(0, normals @ lamp) + 0.16 * normals[:, 2])


class Page:
    def __init__(self, width, height):
        self.size = width, height
        self.triangles, self.lines, self.texts = [], [], []

    def draw(self, x, faces, values, view, centre, scale):
        """A surface: x (nodes, 3) [m]; faces (n, 3 or 4) nodes; values (n) in [0, 1] on the colour scale.

        The origin is drawn at the pixel `centre`, one metre is `scale` pixels long.
        """
        seen = x @ view.T
        page = np.stack([centre[0] + scale * seen[:, 0], centre[1] - scale * seen[:, 1],
                         0.5 - 0.45 * seen[:, 2] / DEPTH],
                        axis=-1)
        if faces.shape[1] == 4:
            u = np.linspace(0, 1, PIECES + 1)
            weights = np.array([[(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t] for t in u for s in u])
            grid = np.arange(len(weights)).reshape(PIECES + 1, PIECES + 1)
            a, b, c, d = (part.ravel() for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]))
            local = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
            patch = np.einsum("wk,fkd->fwd", weights, page[faces])[:, local]
            shape = np.einsum("wk,fkd->fwd", weights, seen[faces])[:, local]
            triangles, shape = patch.reshape(-1, 3, 3), shape.reshape(-1, 3, 3)
            values = np.repeat(values, len(local))
        else:
            triangles, shape = page[faces], seen[faces]
        normals = np.cross(shape[:, 1] - shape[:, 0], shape[:, 2] - shape[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        self.triangles.append(np.column_stack([triangles.reshape(-1, 9), values, _brightness(normals)]))

        around = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
        edges = np.unique(np.sort(around, axis=1), axis=0)
        page[:, 2] -= EDGE_DEPTH
        self.lines.append(np.column_stack([page[edges].reshape(-1, 6), np.tile([1.2, 0.2], (len(edges), 1))]))

    def line(self, start, end, width=1.0, grey=0.6):
        """From pixel to pixel, behind every surface."""
        self.lines.append(np.array([[*start, 0.99, *end, 0.99, width, grey]]))

    def text(self, at, words, size=16, align="left", bold=False):
        self.texts.append({"x": at[0], "y": at[1], "size": size, "align": align, "bold": bold, "words": words})

    def colour_bar(self, at, width, greatest, label):
        """A scale from 0 to `greatest`, its upper left corner at the pixel `at`."""
        left, top, height = *at, 12
        steps = 60
        x = left + width * np.arange(steps + 1) / steps
        rows = []
        for k in range(steps):
            value = (k + 0.5) / steps
            a, b, c, d = (x[k], top), (x[k + 1], top), (x[k + 1], top + height), (x[k], top + height)
            rows += [[*a, 0.01, *b, 0.01, *c, 0.01, value, 1], [*a, 0.01, *c, 0.01, *d, 0.01, value, 1]]
        self.triangles.append(np.array(rows))
        self.text((left, top + height + 18), "0", 14, "centre")
        self.text((left + width, top + height + 18), f"{greatest:.3g}", 14, "centre")
        self.text((left + width / 2, top + height + 18), label, 14, "centre")

    def save(self, file):
        drawing = WORK / f"{file.stem}_drawing.json"
        width, height = self.size
        with open(drawing, "w") as out:
            json.dump({"width": width, "height": height,
                       "triangles": np.concatenate(self.triangles).round(5).tolist(),
                       "lines": np.concatenate(self.lines).round(5).tolist() if self.lines else [],
                       "texts": self.texts}, out)
        subprocess.run([BIN / "hexaplast_draw", drawing, file], check=True)
