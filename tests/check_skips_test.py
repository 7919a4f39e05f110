#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Holds scripts/check_skips against what ctest itself writes: check_skips_test.py CTEST"""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TESTS = """
add_test(Whole.Passes echo passed)
add_test(Whole.ByItsCode sh -c "exit 77")
set_tests_properties(Whole.ByItsCode PROPERTIES SKIP_RETURN_CODE 77)
add_test(Whole.SwitchedOff echo never)
set_tests_properties(Whole.SwitchedOff PROPERTIES DISABLED TRUE)
add_test(Part.OfPytest echo "..s\\nSKIPPED [1] test_body.py:3: no numpy\\n2 passed, 1 skipped")
add_test(Part.OfAScript echo "full disk: skipped: only root can mount\\nparts: skipped: no part")
add_test(OfGoogleTest printf "%s\\n" "[ RUN      ] Suite.Passes" "skipped: one of two" "[       OK ] Suite.Passes (0 ms)"
  "[ RUN      ] Of/Suite.Skips/one" "test.cpp:7: Skipped" "no screen here" "" "[  SKIPPED ] Of/Suite.Skips/one (0 ms)"
  "[ RUN      ] Suite.SkipsToo" "test.cpp:9: Skipped" "no mouse" "[  SKIPPED ] Suite.SkipsToo (0 ms)"
  "[  SKIPPED ] 2 tests, listed below:" "[  SKIPPED ] Of/Suite.Skips/one" "[  SKIPPED ] Suite.SkipsToo")
add_test(IsCut sh -c "yes | head -c 3000")
add_test(Part.IsAWord echo "no test was skipped")
"""
SKIPPED = {"Of/Suite.Skips/one": "no screen here", "Suite.SkipsToo": "no mouse", "Suite.Passes": "one of two",
           "IsCut": "cut", "Whole.ByItsCode": "", "Whole.SwitchedOff": "Disabled",
           "Part.OfPytest": "test_body.py:3: no numpy", "Part.OfAScript": "only root can mount"}


def check_skips(results, allowed, lines):
    allowed.write_text("# a comment\n\n" + "\n".join(lines) + "\n")
    return subprocess.run([ROOT / "scripts" / "check_skips", results, allowed], capture_output=True, text=True)


def main():
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        (directory / "CTestTestfile.cmake").write_text(TESTS)
        results, allowed = directory / "results.xml", directory / "allowed.txt"
        subprocess.run([sys.argv[1], "--output-junit", results, "--test-output-size-passed", "2048"], cwd=directory, check=True,
                       stdout=subprocess.DEVNULL)

        named = [f"{test} {words or 'no reason is given'}" for test, words in SKIPPED.items()]
        of_two = check_skips(results, allowed, named)
        assert of_two.returncode == 1 and "no part" in of_two.stderr, "one line does for both skips of a test"
        named.append("Part.OfAScript no part")
        all_named = check_skips(results, allowed, named)
        assert all_named.returncode == 0, all_named.stderr
        assert all_named.stderr == "" and len(all_named.stdout.splitlines()) == len(named), all_named
        for test, words in SKIPPED.items():
            without = check_skips(results, allowed, [line for line in named if not line.startswith(test)])
            assert without.returncode == 1, f"{test} may be skipped by nobody's leave"
            assert len(without.stderr.splitlines()) >= 1 and without.stderr.startswith(f"{test} was skipped"), without
            assert words in without.stderr, without.stderr
            other = check_skips(results, allowed, [line + " either" if line.startswith(test) else line for line in named])
            assert other.returncode == 1 and str(allowed) in other.stderr, f"{test} is skipped for another reason"
        blank = check_skips(results, allowed, [*named, "   ", "\t"])
        assert blank.returncode == 0, blank.stderr
        reasonless = check_skips(results, allowed, [*named[1:], named[0].split()[0]])
        assert reasonless.returncode == 1 and "no reason is given" in reasonless.stderr, reasonless


if __name__ == "__main__":
    main()
