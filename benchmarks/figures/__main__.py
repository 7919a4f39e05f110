# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the figures that are named on the command line, or all of them."""
import argparse
import importlib
import time

from bar import WORK
from report import RESULTS

FIGURES = ("fig2", "fig5", "fig6", "fig7", "fig8")

parser = argparse.ArgumentParser(prog="scripts/reproduce", description=__doc__)
parser.add_argument("figures", nargs="*", metavar="FIGURE", help=", ".join(FIGURES))
names = parser.parse_args().figures or FIGURES
if unknown := set(names).difference(FIGURES):
    parser.error(f"no figure {', '.join(sorted(unknown))}: there are {', '.join(FIGURES)}")
for folder in (RESULTS, WORK):
    folder.mkdir(parents=True, exist_ok=True)
for name in names:
    start = time.monotonic()
    importlib.import_module(name).make()
    print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
