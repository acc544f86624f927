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


class Stolen(unittest.TestCase):
    def test_an_aborted_run_waits_for_no_stolen_node(self):
        """It is off, and only then revoked: the run that needs it ends on the nodes that stay."""
        fleet = support.make_fleet(self, block=248, udp_port=50248,
                                   robots={robot: trb_fleet.ROBOTS[robot] for robot in (ROBOT, "pioneer2")})
        fleet.start()
        fleet.wait_formed()
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "needs both", "tasks": [
            {"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}},
            {"id": "follow", "robot": "pioneer2", "skill": "go_to", "data": {"place": "dock"}, "after": ["go"]}]}))
        fleet.nodes.pop("pioneer2").stop()
        fleet.wait("pioneer2 is away", lambda: any(
            row["id"] == "pioneer2" and row["state"] == "OFFLINE"
            for row in fleet.json("route", "list", node=CLOUD)["routes"]), 60)
        run = fleet.json("scenario", "run", path, node=CLOUD)["run"]

        def shown():
            return fleet.json("run", "show", run, node=CLOUD)

        fleet.trb("scenario", "abort", run, node=CLOUD, check=False)  # it waits some seconds for the end
        fleet.wait("only pioneer2 has not confirmed it", lambda: "the confirmation of 'pioneer2'" in
                   shown()["waits_for"], 60)
        self.assertEqual(shown()["state"], "ABORTING")
        fleet.trb("fleet", "revoke", fleet.authority_dir(), "pioneer2", "--reason", "stolen", "--via", fleet.dir(CLOUD))
        fleet.wait("the run is over", lambda: shown()["state"] == "ABORTED", 10)


if __name__ == "__main__":
    support.main()
