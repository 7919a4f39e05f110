# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of many runs (docs/studies.md): what `hexaplast sweep`, `hexaplast fit`, `hexaplast run --data` and hexaplast.study
do. Every run is one of the command `hexaplast`, in a process of its own: it has the bits of the command, and one that dies
takes nothing else with it.
"""
