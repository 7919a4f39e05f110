# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hexahedral corotational elastoplastic finite elements in real time.

Lengths in m, forces in N, times in s, stresses in Pa. n nodes, m hexahedra.
"""

try:
    from ._hexaplast import *  # noqa: F403
    from ._hexaplast import __version__
except ModuleNotFoundError as error:
    if error.name != "hexaplast._hexaplast":
        raise
    import sys
    raise ModuleNotFoundError(f"hexaplast is not built for Python {sys.version_info[0]}.{sys.version_info[1]}: its target is "
                              "hexaplast_python", name=error.name) from None
from ._forceps import Forceps
from ._notebook import Viewer, show

__all__ = ["__version__", *(name for name in dir() if not name.startswith("_"))]
