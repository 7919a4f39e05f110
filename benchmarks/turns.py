# SPDX-License-Identifier: LGPL-2.1-or-later
"""Times of steps of programs that take turns."""
import resource
import subprocess
import sys

REPETITIONS = 3


def _processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def fastest_steps(cases, command, few, many, clock=_processor_seconds):
    """{case: [ms] of a step}: the difference of the fastest runs of `few` and of `many` steps, so that starting and loading
    do not count. command(case, steps): what runs it. clock: seconds so far; those of
    processors unless given, which other programs on the machine disturb less."""
    fastest = {(case, steps): float("inf") for case in cases for steps in (few, many)}
    for _ in range(REPETITIONS):
        for case, steps in fastest:
            words = [str(word) for word in command(case, steps)]
            before = clock()
            run = subprocess.run(words, capture_output=True, text=True)
            taken = clock() - before
            if run.returncode != 0 or "was not created" in run.stdout:
                sys.exit(f"error: {' '.join(words)} failed:\n{(run.stdout + run.stderr)[-2000:]}")
            fastest[case, steps] = min(fastest[case, steps], taken)
    return {case: 1e3 * (fastest[case, many] - fastest[case, few]) / (many - few) for case in cases}
