"""How a test program reports what cannot be tried here: to ctest by its exit code, to a person by its reason."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SUPPORT = pathlib.Path(__file__).resolve().parents[1] / "support"
sys.path.insert(0, str(SUPPORT))

import skips  # noqa: E402

HEAD = f"import sys, unittest\nsys.path.insert(0, {str(SUPPORT)!r})\nimport skips\n"
NOT_HERE = """
class NotHere(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        raise unittest.SkipTest("no hall")
    def test_one(self):
        pass

@unittest.skip("no robot")
class Neither(unittest.TestCase):
    def test_two(self):
        pass
    def test_three(self):
        pass
"""
GOOD = """
class Good(unittest.TestCase):
    def test_good(self):
        pass
"""
BAD = GOOD.replace("pass", "self.fail()")


class Skips(unittest.TestCase):
    def run_program(self, text):
        with tempfile.TemporaryDirectory() as folder:  # its own: Python takes modules from beside a program first
            program = pathlib.Path(folder) / "program.py"
            program.write_text(HEAD + text)
            done = subprocess.run([sys.executable, program], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, [line for line in done.stdout.splitlines() if line.startswith("skipped: ")]

    def test_a_program_of_which_nothing_can_be_tried_is_skipped_with_its_reasons(self):
        code, said = self.run_program(NOT_HERE + "skips.main()\n")
        self.assertEqual(code, skips.CODE)
        self.assertEqual(said, ["skipped: no robot [Neither.test_three]", "skipped: no robot [Neither.test_two]",
                                "skipped: no hall [NotHere]"])

    def test_one_that_is_no_unittest_says_it_alike(self):
        self.assertEqual(self.run_program("skips.leave('no udev')\n"), (skips.CODE, ["skipped: no udev"]))

    def test_one_of_which_a_part_was_tried_has_passed_or_failed_and_says_what_was_not(self):
        self.assertEqual(self.run_program(NOT_HERE + GOOD + "skips.main()\n")[0], 0)
        code, said = self.run_program(NOT_HERE + BAD + "skips.main()\n")
        self.assertEqual((code, len(said)), (1, 3))
        self.assertEqual(self.run_program(GOOD + "skips.main()\n"), (0, []))

    def test_the_log_of_a_run_is_read_by_test_and_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "Testing", "Temporary", "LastTest.log")
            log.parent.mkdir(parents=True)
            log.write_text("1/2 Testing: a\n1/2 Test: a\nOutput:\nskipped: no udev\n"
                           "2/2 Test: b\nskipped: no robot [B.one]\nskipped: no robot [B.two]\nskipped: no key [B.three]\n")
            said = list(skips.lines(skips.skipped_in(folder)))
        self.assertEqual(said, ["a: no udev", "b: no robot (2 stories)", "b: no key (B.three)"])


if __name__ == "__main__":
    skips.main()
