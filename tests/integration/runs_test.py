"""Runs that are over: listed page by page, and shown completely, by the command line.

Addresses 127.0.248.x, 127.0.249.x.
"""
import json
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

ROBOT = "pioneer1"
MANY = 110  # more than a page


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=248, udp_port=50248, robots={ROBOT: trb_fleet.ROBOTS[ROBOT]}, speed=100)
        cls.fleet.start()
        cls.fleet.wait_formed()
        cls.path = support.temporary_folder(cls) / "s.json"
        cls.path.write_text(json.dumps({"name": "short", "tasks": [
            {"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}]}))
        cls.runs = [cls.fleet.json("scenario", "run", cls.path, node=CLOUD)["run"] for _ in range(MANY)]
        cls.fleet.wait("all are over", lambda: not cls.fleet.json("run", "list", node=CLOUD)["runs"], 100)

    def test_all_are_listed_once_newest_first(self):
        listed = self.fleet.json("run", "list", "--all", node=CLOUD)
        ids = [run["run"] for run in listed["runs"]]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertEqual(set(ids), set(self.runs))
        self.assertEqual(ids, sorted(ids, key=self.runs.index, reverse=True))
        self.assertFalse(listed["more"])
        self.assertTrue(all(run["over"] for run in listed["runs"]))

    def test_one_that_is_over_is_shown_whole(self):
        shown = self.fleet.json("run", "show", self.runs[0], node=CLOUD)
        self.assertEqual((shown["state"], shown["tasks"][0]["state"]), ("FINISHED", "FINISHED"))
        text = self.fleet.trb("run", "show", self.runs[0], node=CLOUD).stdout
        self.assertRegex(text, r"(?m)^run [0-9a-f]{32} 'short': FINISHED, last task ended [0-9T:.Z-]+, archived 2")
        self.assertRegex(text, rf"(?m)^go +{ROBOT} +go_to +FINISHED +1 ")

    def test_one_that_never_was(self):
        done = self.fleet.trb("run", "show", "zz", node=CLOUD, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("unknown_run", done.stderr)

    def test_a_priority_out_of_bounds(self):
        for bad in ("10", "-1", "high", ""):
            done = self.fleet.trb("scenario", "run", self.path, f"--priority={bad}", node=CLOUD, check=False)
            self.assertIn("use a whole number from 0 to 9", done.stderr)


if __name__ == "__main__":
    support.main()
