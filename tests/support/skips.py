#!/usr/bin/env python3
"""Every test reports what cannot be tried on this machine in the same way: a line "skipped: REASON" for each test, and
exit code 77 if nothing of a program's tests could be tried, which ctest shows as Skipped.

  tests/support/skips.py build/dev ...    what ctest's last run in these folders has skipped, and why
"""
import pathlib
import re
import sys
import unittest

CODE = 77  # SKIP_RETURN_CODE in CMake


def leave(reason):
    """Ends a program that cannot test anything here."""
    print(f"skipped: {reason}", flush=True)
    sys.exit(CODE)


class Result(unittest.TextTestResult):
    succeeded = 0

    def addSuccess(self, test):
        super().addSuccess(test)
        self.succeeded += 1

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        name = re.sub(r"(setUpClass )?\(?__main__\.(\S*?)\)?$", r"\2", test.id())
        self.stream.write(f"\nskipped: {reason} [{name}]\n")
        self.stream.flush()


def main(verbosity=2):
    """unittest.main for a test that ctest runs."""
    runner = unittest.TextTestRunner(verbosity=verbosity, resultclass=Result)
    result = unittest.main(testRunner=runner, exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(CODE if result.skipped and not result.succeeded else 0)


def skipped_in(folder):
    """(test, reason) as the log of ctest's last run below a build's folder has them."""
    log = pathlib.Path(folder) / "Testing" / "Temporary" / "LastTest.log"
    test = ""
    out = []
    for line in log.read_text(errors="replace").splitlines() if log.exists() else []:
        if begins := re.fullmatch(r"\d+/\d+ Test: (.*)", line):
            test = begins[1]
        elif line.startswith("skipped: "):
            out.append((test, line.removeprefix("skipped: ")))
    return out


def lines(skipped):
    """One for each test and reason; test cases of one test that share a reason are counted."""
    stories = {}
    for test, text in skipped:
        reason, _, story = text.partition(" [")
        stories.setdefault((test, reason), []).append(story.removesuffix("]"))
    for (test, reason), names in stories.items():
        of = f" ({names[0]})" if len(names) == 1 and names[0] else f" ({len(names)} stories)" if len(names) > 1 else ""
        yield f"{test}: {reason}{of}"


if __name__ == "__main__":
    for each in sys.argv[1:]:
        for line in lines(skipped_in(each)):
            print(f"  {line}")
