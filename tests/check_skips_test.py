#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Holds scripts/check_skips against what ctest itself writes: check_skips_test.py CTEST"""
import pathlib
import subprocess
import sys
import tempfile

CHECK_SKIPS = pathlib.Path(__file__).resolve().parent.parent / "scripts" / "check_skips"
TESTS = """
add_test(ByItsCode sh -c "exit 77")
set_tests_properties(ByItsCode PROPERTIES SKIP_RETURN_CODE 77)
add_test(SwitchedOff echo never)
set_tests_properties(SwitchedOff PROPERTIES DISABLED TRUE)
add_test(OfPytest echo "..s\\nSKIPPED [1] test_body.py:3: no numpy\\n2 passed, 1 skipped")
add_test(OfAScript echo "full disk: skipped: only root can mount\\nparts: skipped: no part")
add_test(OfGoogleTest printf "%s\\n" "[ RUN      ] Suite.Passes" "skipped: one of two" "[       OK ] Suite.Passes (0 ms)"
  "[ RUN      ] Of/Suite.Skips/one" "test.cpp:7: Skipped" "no screen here" "[  SKIPPED ] Of/Suite.Skips/one (0 ms)")
add_test(IsCut sh -c "yes | head -c 3000")
add_test(IsAWord echo "no test was skipped")
"""
SKIPS = ["ByItsCode no reason is given", "SwitchedOff Disabled", "OfPytest test_body.py:3: no numpy", "OfAScript only root can",
         "OfAScript no part", "Suite.Passes one of two", "Of/Suite.Skips/one no screen here", "IsCut cut"]

with tempfile.TemporaryDirectory() as name:
    results, allowed = pathlib.Path(name, "results.xml"), pathlib.Path(name, "allowed.txt")
    pathlib.Path(name, "CTestTestfile.cmake").write_text(TESTS)
    subprocess.run([sys.argv[1], "--output-junit", results, "--test-output-size-passed", "2048"], cwd=name, check=True,
                   stdout=subprocess.DEVNULL)
    # all have their line, none has, and each has the reason of another one
    names, reasons = zip(*(skip.split(None, 1) for skip in SKIPS))
    others = [" ".join(words) for words in zip(names, reasons[2:] + reasons[:2])]
    for lines, num_refused in ((SKIPS, 0), ([], len(SKIPS)), (others, len(SKIPS))):
        allowed.write_text("# a comment\n\n" + "".join(line + "\n" for line in lines) + "  \n")
        ended = subprocess.run([CHECK_SKIPS, results, allowed], capture_output=True, text=True)
        assert ended.returncode == (num_refused > 0), ended
        assert len(ended.stdout.splitlines()) == len(SKIPS) - num_refused, ended
        assert ended.stderr.count(" was skipped for a reason") == num_refused, ended
        for name, reason in zip(names, reasons) if num_refused else ():
            assert name + " was skipped" in ended.stderr and reason in ended.stderr, (name, ended)
