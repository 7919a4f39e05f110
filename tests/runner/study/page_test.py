#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the commands and scripts of a page of docs/, in their order, in one directory.

page_test.py HEXAPLAST DIRECTORY PAGE; `sbatch` is a stand-in that carries out all tasks of a job array (slurm_test.py has a real
one)."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
SBATCH = """#!/bin/bash
[[ $1 =~ ^--array=1-([0-9]+)$ ]] || { echo "sbatch: $1" >&2; exit 1; }
for SLURM_ARRAY_TASK_ID in $(seq "${BASH_REMATCH[1]}"); do
  SLURM_ARRAY_TASK_ID=$SLURM_ARRAY_TASK_ID SLURM_CPUS_PER_TASK=1 bash "${@:2}" || exit 1
done
"""


def main():
    command, place, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    shutil.rmtree(place, ignore_errors=True)
    (place / "bin").mkdir(parents=True)
    for name in ("scenes", "examples", "python"):
        (place / name).symlink_to(ROOT / name)
    (place / "bin" / "sbatch").write_text(SBATCH)
    (place / "bin" / "sbatch").chmod(0o755)
    (place / "bin" / "python3").symlink_to(sys.executable)
    environment = dict(os.environ, PATH=f"{place / 'bin'}:{command.parent}:{os.environ['PATH']}",
                       HEXAPLAST_COMMAND=str(command))
    blocks = re.findall(r"^```(sh|python)\n(.*?)^```$", (ROOT / "docs" / page).read_text(), re.MULTILINE | re.DOTALL)
    if len(blocks) < 6:
        sys.exit(f"page_test: only {len(blocks)} blocks are found")
    for language, text in blocks:
        script = place / ("block." + language)
        script.write_text(text)
        words = ["bash", "-eu", script] if language == "sh" else [sys.executable, script]
        ended = subprocess.run(words, cwd=place, env=environment, capture_output=True, text=True)
        if ended.returncode != 0:
            sys.exit(f"page_test: ends with {ended.returncode}:\n{text}{ended.stdout}{ended.stderr}")
        print(ended.stdout, end="")


if __name__ == "__main__":
    main()
