# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of many runs (docs/studies.md): what `hexaplast sweep`, `hexaplast fit`, `hexaplast run --data` and hexaplast.study
do. Every run is one of the command `hexaplast`, in a process of its own: it has the bits of the command, and one that dies
takes nothing else with it.
"""

import importlib.util

# Whoever lacks one hears it before the first run. They are imported where they are needed, which takes a second of them all.
for _name in ("numpy", "scipy", "h5py", "matplotlib"):
    if not importlib.util.find_spec(_name):
        raise ModuleNotFoundError(f"No module named '{_name}'", name=_name)
