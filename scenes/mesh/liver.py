#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes a surface of the shape of a liver as OBJ to standard output: `./liver.py > liver.obj`.

A ball, whose triangles are four times cut into four, is bent into shape: a wedge 0.22 m long that is thick at the right
lobe and thin at the left one, domed above, hollow below, with a sharp front edge and a notch in it between the lobes.
Metres; x from the right lobe to the left one, y up, z to the front; triangles counter-clockwise seen from outside.
"""

import math

CUTS = 4


def ball():
    """Points on the unit sphere, and triangles, from an icosahedron."""
    golden = (1 + math.sqrt(5)) / 2
    points = [unit(p) for a in (-1, 1) for b in (-golden, golden) for p in ((a, b, 0), (0, a, b), (b, 0, a))]
    edge = min(math.dist(points[0], p) for p in points[1:]) * 1.01
    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if max(math.dist(points[i], points[j]), math.dist(points[j], points[k]),
                       math.dist(points[k], points[i])) < edge:
                    triangles.append(outward(points, i, j, k))
    for _ in range(CUTS):
        triangles = cut(points, triangles)
    return points, triangles


def unit(p):
    length = math.hypot(*p)
    return tuple(c / length for c in p)


def outward(points, i, j, k):
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[i], points[j], points[k]
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return (i, j, k) if triple > 0 else (i, k, j)


def cut(points, triangles):
    """Every triangle into four; the middles of the edges, shared by neighbours, join the points."""
    middle = {}

    def between(i, j):
        key = (min(i, j), max(i, j))
        if key not in middle:
            middle[key] = len(points)
            points.append(unit(tuple((a + b) / 2 for a, b in zip(points[i], points[j]))))
        return middle[key]

    smaller = []
    for i, j, k in triangles:
        a, b, c = between(i, j), between(j, k), between(k, i)
        smaller += [(i, a, c), (a, j, b), (c, b, k), (a, b, c)]
    return smaller


def shaped(x, y, z):
    """Where a point of the unit sphere comes to lie [m]."""
    left = (x + 1) / 2                                    # 0 at the tip of the right lobe, 1 at that of the left one
    thick = 1 - 0.72 * left ** 1.3
    above = 0.075 * thick * y if y > 0 else 0.030 * thick * y
    deep = 0.070 * (1 - 0.45 * left ** 2)
    droop = 0.035 * (1 - left) ** 2 * max(0, z)           # the front of the right lobe hangs down
    hollow = 0.016 * max(0, -y) * (1 - z * z) * thick     # for the gall bladder and the porta
    front = max(0, z) ** 2
    notch = 0.016 * front * math.exp(-((x - 0.25) / 0.16) ** 2)
    return 0.110 * x, above - droop + hollow - 0.012 * z, deep * z - notch


def main():
    points, triangles = ball()
    print("# A liver's shape, made by liver.py")
    for p in points:
        print("v {:.6f} {:.6f} {:.6f}".format(*shaped(*p)))
    for t in triangles:
        print("f {} {} {}".format(*(i + 1 for i in t)))


if __name__ == "__main__":
    main()
