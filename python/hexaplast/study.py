# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of many runs, by any executor of concurrent.futures: of threads, of processes, of MPI, of Dask. The functions are
those of the programs `hexaplast sweep` and `hexaplast fit`; every run is one of the command, in a process of its own.
"""

from hexaplast_study.fit import Fit, fit
from hexaplast_study.sweep import Sweep, sweep

__all__ = ["Fit", "Sweep", "fit", "sweep"]
