# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forceps: two instruments that are moved as one."""

import math

import numpy as np

from ._hexaplast import Instrument, _motion, _require_jaws


def _finite(opening):
    try:
        value = float(opening)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"opening: {opening!r}, must be a finite number")
    return value


class Forceps:
    """Two jaws, which are instruments of a Simulation or of a Scene. They open along the line from one to the other.

    opening: [m] between them as they are now; without it, that between their frames. What is set of `pose` and `opening`
    before a step is reached together, steadily within it. A copy of a simulation needs Forceps of its own, of its instruments
    and with opening=forceps.opening.
    """

    __slots__ = ("_jaws", "_closed", "_axis", "_turn")

    def __init__(self, left, right, opening=None):
        for jaw in (left, right):
            if not isinstance(jaw, Instrument):
                raise TypeError(f"forceps: {type(jaw).__name__}: a jaw must be an instrument")
        _require_jaws(left, right)
        first, second = (_motion(jaw.pose) for jaw in (left, right))
        way = second[:3, 3] - first[:3, 3]
        distance = np.linalg.norm(way)
        if not distance > 0:
            raise ValueError("forceps: both jaws are in one place, must lie apart along the line on which they open")
        self._jaws = left, right
        self._closed = 0.0 if opening is None else distance - _finite(opening)  # [m] between the frames of closed jaws
        self._axis = first[:3, :3].T @ way / distance  # in the frame of the first, as the turn of the second
        self._turn = first[:3, :3].T @ second[:3, :3]

    def _between(self, first, second):
        """The frame in the middle of two poses of the jaws, and the opening there."""
        frame = _motion(first)
        frame[:3, 3] = (first[:3] + second[:3]) / 2
        return frame, (second[:3] - first[:3]) @ (frame[:3, :3] @ self._axis) - self._closed

    def _present(self):
        return self._between(*(jaw.pose for jaw in self._jaws))

    def _move(self, pose=None, opening=None):
        frame, aimed_at = self._between(*(jaw.target for jaw in self._jaws))
        if pose is not None:
            frame = _motion(pose, frame)
        if opening is None:
            opening = aimed_at
        for jaw, side, turn in zip(self._jaws, (-0.5, 0.5), (np.eye(3), self._turn)):
            motion = frame.copy()
            motion[:3, 3] += frame[:3, :3] @ self._axis * (side * (opening + self._closed))
            motion[:3, :3] = frame[:3, :3] @ turn
            jaw.pose = motion

    def __repr__(self):
        pose, opening = self.pose, self.opening
        return f"<hexaplast.Forceps at {pose[0]:.4g} {pose[1]:.4g} {pose[2]:.4g} m, open by {opening:.4g} m>"

    @property
    def pose(self):
        """Where they are: (7,) the middle of the jaws [m] and the orientation of the first, a quaternion x y z w. Set to
        (3,), (7,) or a matrix (4, 4), they move there within the next step, and stay."""
        first = self._jaws[0].pose
        return np.concatenate([self._present()[0][:3, 3], first[3:]])

    @pose.setter
    def pose(self, pose):
        self._move(pose=pose)

    @property
    def opening(self):
        """[m] between the jaws; negative where they overlap. Set, they reach it within the next step, and stay."""
        return float(self._present()[1])

    @opening.setter
    def opening(self, opening):
        self._move(opening=_finite(opening))

    @property
    def force(self):
        """(3,) [N] of the body on both jaws, in the latest step."""
        return self._jaws[0].force + self._jaws[1].force

    @property
    def grip_force(self):
        """[N] by which the body presses the jaws apart, in the latest step."""
        axis = self._present()[0][:3, :3] @ self._axis
        return float((self._jaws[1].force - self._jaws[0].force) @ axis / 2)
