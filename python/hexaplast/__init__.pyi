# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hexahedral corotational elastoplastic finite elements in real time.

Lengths in m, forces in N, times in s, stresses in Pa. n nodes, m hexahedra. Shapes stand behind the arrays.
Errors: ValueError for input that cannot be accepted, TypeError for arrays without numbers of the right kind,
ArithmeticError for a computation that left the finite numbers, OSError for files, ImportError for plugins, RuntimeError
where two threads use one object at the same time.
"""

import os
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
__all__: list[str]

_Path = str | os.PathLike[str]
_Reals = NDArray[np.float64]
_Gradient = Literal["blended", "vertex", "centre"]
_YieldNorm = Literal["vonMises", "frobenius", "spectral"]
_Rotation = Literal["objective", "vertex", "centre", "none"]
_Frame = Literal["bestFit", "world"]
_Averaging = Literal["gaussNewton", "gaussNewtonIsolated", "localGlobal", "jacobi"]
_Precision = Literal["double", "mixed"]

class Material:
    young_modulus: float
    poisson_ratio: float
    yield_stress: float
    flow_rate: float
    rotation_yield: float
    rotation_flow_rate: float
    hardening: float
    fracture_stress: float
    fracture_stretch: float
    def __init__(
        self,
        *,
        young_modulus: float = 5000,
        poisson_ratio: float = 0.45,
        yield_stress: float = ...,
        flow_rate: float = 0,
        rotation_yield: float = 0,
        rotation_flow_rate: float = 0,
        hardening: float = 0,
        fracture_stress: float = ...,
        fracture_stretch: float = ...,
    ) -> None: ...

class Settings:
    gradient: _Gradient
    yield_norm: _YieldNorm
    rotation_plasticity: _Rotation
    rotation_frame: _Frame
    averaging: _Averaging
    averaging_steps: int
    averaging_tolerance: float
    precision: _Precision
    volume_restitution: float
    inversion_threshold: float
    def __init__(
        self,
        *,
        gradient: _Gradient = "blended",
        yield_norm: _YieldNorm = "vonMises",
        rotation_plasticity: _Rotation = "objective",
        rotation_frame: _Frame = "bestFit",
        averaging: _Averaging = "gaussNewton",
        averaging_steps: int = 1,
        averaging_tolerance: float = 0,
        precision: _Precision = "double",
        volume_restitution: float = 1,
        inversion_threshold: float = 0.1,
    ) -> None: ...

class FlowReport:
    @property
    def yielded(self) -> int: ...
    @property
    def inverted(self) -> int: ...
    @property
    def guarded(self) -> int: ...
    @property
    def repaired(self) -> int: ...
    @property
    def removed(self) -> int: ...
    @property
    def worst_volume_error(self) -> float: ...
    @property
    def averaging_converged(self) -> bool: ...

class StepReport:
    @property
    def steps(self) -> int: ...
    @property
    def stalled(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def residual(self) -> float: ...
    @property
    def converged(self) -> bool: ...
    @property
    def preconditioner(self) -> str: ...
    @property
    def flow(self) -> FlowReport: ...

class Fields:
    @property
    def plastic_strain(self) -> _Reals: ...  # (m,)
    @property
    def yield_stress(self) -> _Reals: ...  # (m,)
    @property
    def volume_ratio(self) -> _Reals: ...  # (m,)
    @property
    def stress_norm(self) -> _Reals: ...  # (m,)
    @property
    def strain(self) -> _Reals: ...  # (m,)

class BodyState:
    @property
    def num_nodes(self) -> int: ...
    @property
    def num_hexahedra(self) -> int: ...
    @property
    def original_positions(self) -> _Reals: ...  # (n, 3)
    @property
    def hexahedra(self) -> NDArray[np.int32]: ...  # (m, 8)
    @property
    def material_positions(self) -> _Reals: ...  # (n, 3)
    @property
    def corner_plastic_strain(self) -> _Reals: ...  # (m, 8)
    @property
    def corner_yield_stress(self) -> _Reals: ...  # (m, 8)
    @property
    def alive(self) -> NDArray[np.bool_]: ...  # (m,)
    @property
    def removed(self) -> list[int]: ...
    @property
    def dissipated_energy(self) -> float: ...
    @property
    def original_volume(self) -> float: ...
    def volume(self, positions: ArrayLike) -> float: ...
    def energy(self, positions: ArrayLike) -> float: ...
    def fields(self, positions: ArrayLike) -> Fields: ...
    def history_hash(self) -> str: ...

class Body(BodyState):
    def __init__(
        self,
        positions: ArrayLike,
        hexahedra: ArrayLike,
        material: Material | Sequence[Material] = ...,
        settings: Settings = ...,
    ) -> None: ...
    def force(self, positions: ArrayLike) -> _Reals: ...  # (n, 3)
    def stiffness_product(self, positions: ArrayLike, dx: ArrayLike) -> _Reals: ...  # (n, 3)
    def flow(self, positions: ArrayLike, dt: float) -> FlowReport: ...
    def remove(self, hexahedra: ArrayLike) -> None: ...
    def reset(self) -> None: ...
    def save(self) -> bytes: ...
    def load(self, data: bytes) -> None: ...
    def set_material(self, material: Material | Sequence[Material]) -> None: ...

class Simulation:
    def __init__(
        self,
        body: Body,
        *,
        density: float = 1000,
        dt: float = 0.01,
        gravity: Sequence[float] = (0, 0, 0),
        rayleigh_mass: float = 0,
        rayleigh_stiffness: float = 0,
        solver: Literal["direct", "cg"] = "direct",
        tolerance: float = 1e-6,
        iterations: int = 1000,
    ) -> None: ...
    @property
    def body(self) -> Body: ...
    @property
    def positions(self) -> _Reals: ...  # (n, 3)
    @property
    def velocities(self) -> _Reals: ...  # (n, 3)
    @property
    def masses(self) -> _Reals: ...  # (n,)
    @property
    def dt(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def num_steps(self) -> int: ...
    @property
    def kinetic_energy(self) -> float: ...
    @property
    def elastic_energy(self) -> float: ...
    def step(self, forces: ArrayLike | None = None) -> StepReport: ...
    def run(self, steps: int, forces: ArrayLike | None = None) -> StepReport: ...
    def fix(self, nodes: ArrayLike) -> None: ...
    def lead(self, nodes: ArrayLike, places: ArrayLike) -> None: ...
    def release(self, nodes: ArrayLike) -> None: ...
    def set_state(self, positions: ArrayLike, velocities: ArrayLike) -> None: ...
    def reset(self) -> None: ...
    def fields(self) -> Fields: ...
    def state_hash(self) -> str: ...

class Scene:
    def __init__(
        self,
        file: _Path,
        overrides: dict[str, Any] = ...,
        *,
        plugins: Sequence[str] = (),
        plugin_path: Sequence[_Path] = (),
        sofa_compat: bool = False,
        out: _Path = ".",
        allow_outside: bool = False,
        force: bool = False,
    ) -> None: ...
    @property
    def body(self) -> BodyState | None: ...
    @property
    def positions(self) -> _Reals: ...  # (n, 3)
    @property
    def velocities(self) -> _Reals: ...  # (n, 3)
    @property
    def dt(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def num_steps(self) -> int: ...
    @property
    def planned_steps(self) -> int | None: ...
    @property
    def kinetic_energy(self) -> float: ...
    @property
    def elastic_energy(self) -> float: ...
    def step(self) -> StepReport: ...
    def run(self, steps: int | None = None) -> StepReport: ...
    def reset(self) -> None: ...
    def state_hash(self) -> str: ...

def grid(
    cells: Sequence[int], least: Sequence[float], most: Sequence[float]
) -> tuple[_Reals, NDArray[np.int32]]: ...
def read_mesh(file: _Path) -> tuple[_Reals, NDArray[np.int32]]: ...
def run(
    file: _Path,
    steps: int | None = None,
    overrides: dict[str, Any] = ...,
    *,
    out: _Path = ".",
    allow_outside: bool = False,
    force: bool = False,
) -> Scene: ...
def set_num_threads(count: int) -> None: ...
def num_threads() -> int: ...
def simd_target() -> str: ...
