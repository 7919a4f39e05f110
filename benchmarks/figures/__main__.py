# SPDX-License-Identifier: LGPL-2.1-or-later
"""Makes the figures that are named on the command line, or all of them."""
import importlib
import sys
import time

from bar import WORK
from report import RESULTS

FIGURES = ("fig2", "fig5", "fig6", "fig7", "fig8")


def main(names):
    unknown = [name for name in names if name not in FIGURES]
    if unknown:
        print(f"error: no figure {', '.join(unknown)}: there are {', '.join(FIGURES)}", file=sys.stderr)
        return 2
    for folder in (RESULTS, WORK):
        folder.mkdir(parents=True, exist_ok=True)
    for name in names or FIGURES:
        start = time.monotonic()
        importlib.import_module(name).make()
        print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
