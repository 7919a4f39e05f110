# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hexahedral corotational elastoplastic finite elements in real time.

Lengths in m, forces in N, times in s, stresses in Pa. n nodes, m hexahedra.
"""

try:
    from ._hexaplast import (
        Batch,
        Body,
        BodyState,
        Fields,
        FlowReport,
        Grip,
        Instrument,
        Joints,
        Material,
        Scene,
        SceneBody,
        SceneInstrument,
        Settings,
        Simulation,
        SolidInstrument,
        StepReport,
        __version__,
        grid,
        num_threads,
        read_mesh,
        run,
        set_num_threads,
        simd_target,
    )
except ModuleNotFoundError as error:
    if error.name != "hexaplast._hexaplast":
        raise
    import sys
    raise ModuleNotFoundError(f"hexaplast is not built for Python {sys.version_info[0]}.{sys.version_info[1]}: its target is "
                              "hexaplast_python", name=error.name) from None
from ._forceps import Forceps
from ._notebook import Viewer, show

__all__ = [
    "Batch",
    "Body",
    "BodyState",
    "Fields",
    "FlowReport",
    "Forceps",
    "Grip",
    "Instrument",
    "Joints",
    "Material",
    "Scene",
    "SceneBody",
    "SceneInstrument",
    "Settings",
    "Simulation",
    "SolidInstrument",
    "StepReport",
    "Viewer",
    "__version__",
    "grid",
    "num_threads",
    "read_mesh",
    "run",
    "set_num_threads",
    "show",
    "simd_target",
]
