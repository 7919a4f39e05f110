# SPDX-License-Identifier: LGPL-2.1-or-later
"""Forceps: two instruments that are moved as one."""

import numpy as np


def _motion(pose, turn):
    """The rigid motion (4, 4) of a pose (3,), which has the rotation `turn`, (7,) or (4, 4)."""
    pose = np.asarray(pose, float)
    if pose.shape == (4, 4):
        return pose
    if pose.shape not in ((3,), (7,)):
        raise ValueError(f"pose: shape {pose.shape}, must be (3,), (7,) or (4, 4)")
    motion = np.eye(4)
    motion[:3, 3] = pose[:3]
    if len(pose) == 3:
        motion[:3, :3] = turn
    else:
        x, y, z, w = pose[3:] / np.linalg.norm(pose[3:])
        motion[:3, :3] += 2 * np.array([[-y * y - z * z, x * y - z * w, x * z + y * w],
                                        [x * y + z * w, -x * x - z * z, y * z - x * w],
                                        [x * z - y * w, y * z + x * w, -x * x - y * y]])
    return motion


class Forceps:
    """Two jaws, which are instruments of a Simulation or of a Scene. They open along the line from one to the other.

    opening: [m] between them as they are now; without it, that between their frames. What is set of `pose` and `opening`
    before a step is reached together, steadily within it.
    """

    def __init__(self, left, right, opening=None):
        self._jaws = left, right
        first, second = (_motion(jaw.pose, None) for jaw in (left, right))
        way = second[:3, 3] - first[:3, 3]
        distance = np.linalg.norm(way)
        if not distance > 0:
            raise ValueError("forceps: both jaws are in one place, must lie apart along the line on which they open")
        self._closed = 0.0 if opening is None else distance - opening  # [m] between the frames of closed jaws
        self._axis = first[:3, :3].T @ way / distance  # in the frame of the first, as the turn of the second
        self._turn = first[:3, :3].T @ second[:3, :3]
        self._set = None  # poses of the jaws, and what was set when they were there

    def _present(self):
        poses = np.array([jaw.pose for jaw in self._jaws])
        frame = _motion(poses[0], None)
        frame[:3, 3] = (poses[0, :3] + poses[1, :3]) / 2
        opening = (poses[1, :3] - poses[0, :3]) @ (frame[:3, :3] @ self._axis) - self._closed
        return poses, frame, opening

    def _move(self, pose=None, opening=None):
        poses, frame, present = self._present()
        if self._set is not None and (self._set[0] == poses).all():
            _, frame, present = self._set
        if pose is not None:
            frame = _motion(pose, frame[:3, :3])
        if opening is None:
            opening = present
        for jaw, side, turn in zip(self._jaws, (-0.5, 0.5), (np.eye(3), self._turn)):
            motion = frame.copy()
            motion[:3, 3] += frame[:3, :3] @ self._axis * (side * (opening + self._closed))
            motion[:3, :3] = frame[:3, :3] @ turn
            jaw.pose = motion
        self._set = poses, frame, opening

    @property
    def pose(self):
        """Where they are: (7,) the middle of the jaws [m] and the orientation of the first, a quaternion x y z w. Set to
        (3,), (7,) or a matrix (4, 4), they move there within the next step, and stay."""
        _, frame, _ = self._present()
        return np.concatenate([frame[:3, 3], self._jaws[0].pose[3:]])

    @pose.setter
    def pose(self, pose):
        self._move(pose=pose)

    @property
    def opening(self):
        """[m] between the jaws. Set, they reach it within the next step, and stay."""
        return float(self._present()[2])

    @opening.setter
    def opening(self, opening):
        if not np.isfinite(opening):
            raise ValueError(f"opening: {opening}, must be finite")
        self._move(opening=float(opening))

    @property
    def force(self):
        """(3,) [N] of the body on both jaws, in the latest step."""
        return self._jaws[0].force + self._jaws[1].force

    @property
    def grip_force(self):
        """[N] by which the body presses the jaws apart, in the latest step."""
        _, frame, _ = self._present()
        return float((self._jaws[1].force - self._jaws[0].force) @ (frame[:3, :3] @ self._axis) / 2)
