"""Runs that are over: listed page by page, and shown completely, by the command line.

Addresses 127.0.248.x, 127.0.249.x.
"""
import contextlib
import json
import os
import shutil
import signal
import sqlite3
import time
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


class Reloaded(unittest.TestCase):
    def test_a_node_that_is_reloaded_amid_a_chain_loses_no_result(self):
        fleet = support.make_fleet(self, block=248, udp_port=50248, robots={ROBOT: trb_fleet.ROBOTS[ROBOT]}, speed=5)
        fleet.start()
        fleet.wait_formed()
        path = support.temporary_folder(self) / "s.json"
        tasks = [{"id": f"t{i}", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock" if i % 2 else "table1"}}
                 for i in range(12)]
        for before, task in zip(tasks, tasks[1:]):
            task["after"] = [before["id"]]
        path.write_text(json.dumps({"name": "chain", "tasks": tasks}))
        run = fleet.json("scenario", "run", path, node=CLOUD)["run"]
        log = fleet.dir(ROBOT) / "log" / "mode-adapter.log"
        for done in (1, 4, 7):
            fleet.wait(f"{done} are done", lambda least=done: self.finished(fleet, run) >= least, 60)
            reloads = log.read_text().count(" reloading ")
            fleet.trb("reload", fleet.dir(ROBOT))
            fleet.wait("it is reloaded", lambda before=reloads: log.read_text().count(" reloading ") > before, 60)
        fleet.wait("the run is over", lambda: fleet.json("run", "show", run, node=CLOUD)["state"] != "RUNNING", 60)
        shown = fleet.json("run", "show", run, node=CLOUD)
        self.assertEqual({(one["state"], one["attempt"]) for one in shown["tasks"]}, {("FINISHED", 1)}, shown)

    def test_a_router_that_is_slow_to_come_back_has_no_task_interrupted_that_never_began(self):
        """Its second attempt's order waits in the router that is to be started anew, and is lost in it."""
        robot = "conveyor"
        fleet = support.make_fleet(self, block=248, udp_port=50248, robots={robot: trb_fleet.ROBOTS[robot]}, speed=1)
        fleet.start()
        fleet.wait_formed()
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "again", "tasks": [  # it takes 3 s: each attempt is too late
            {"id": "run", "robot": robot, "skill": "run", "timeout_s": 1, "retries": 3, "retry_after_s": 10}]}))
        run = fleet.json("scenario", "run", path, node=CLOUD)["run"]

        def shown():
            return fleet.json("run", "show", run, node=CLOUD)

        fleet.wait("it is to be tried again", lambda: shown()["tasks"][0]["attempt"] == 2, 60)
        log = fleet.dir(robot) / "log" / "mode-adapter.log"
        router = fleet.pid(robot, "router")
        os.kill(router, signal.SIGSTOP)
        try:
            fleet.wait("it is ordered again", lambda: self.started(fleet, robot) == 2, 60)
            fleet.nodes[robot].child.send_signal(signal.SIGHUP)
            slow = time.monotonic() + 1.5
            fleet.wait("a slow router", lambda: time.monotonic() > slow or " reloading " in log.read_text(), 60)
        finally:
            os.kill(router, signal.SIGCONT)
        fleet.wait("it is reloaded", lambda: " reloading " in log.read_text(), 60)
        seen = []  # the third one's time is over before long
        fleet.wait("the second attempt is over", lambda: seen.append(shown()) or seen[-1]["tasks"][0]["attempt"] > 2 or
                   seen[-1]["state"] != "RUNNING", 60)
        self.assertEqual((seen[-1]["state"], seen[-1]["tasks"][0]["attempt"]), ("RUNNING", 3), seen[-1])

    @staticmethod
    def started(fleet, robot):
        """How many attempts its scheduler has journaled as ordered."""
        with contextlib.closing(sqlite3.connect(f"file:{fleet.dir(robot)}/state/journal.db?mode=ro", uri=True)) as file:
            return file.execute("SELECT count(*) FROM records WHERE kind = 'journal_start'").fetchone()[0]

    @staticmethod
    def finished(fleet, run):
        return sum(one["state"] == "FINISHED" for one in fleet.json("run", "show", run, node=CLOUD)["tasks"])


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

        fleet.trb("scenario", "abort", run, "--reason", "shift ends", node=CLOUD, check=False)  # it waits some seconds for the end
        fleet.wait("only pioneer2 has not confirmed it", lambda: "the confirmation of 'pioneer2'" in
                   shown()["waits_for"], 60)
        self.assertEqual(shown()["state"], "ABORTING")
        fleet.trb("fleet", "revoke", fleet.authority_dir(), "pioneer2", "--reason", "stolen", "--via", fleet.dir(CLOUD))
        fleet.wait("the run is over", lambda: shown()["state"] == "ABORTED", 60)
        ender = shown()["ended_by"]
        self.assertEqual((ender["node"], ender["reason"]), (CLOUD, "shift ends"))
        self.assertGreater(ender["time"], shown()["created"])
        self.assertRegex(fleet.trb("run", "show", run, node=CLOUD).stdout, rf"(?m)^ended by {CLOUD} 2[0-9T:.Z-]+: shift ends$")


class Replaced(unittest.TestCase):
    OLD = "pioneer2"

    def put_another_computer_in_its_place(self, fleet):
        fleet.nodes.pop(self.OLD).stop()
        fleet.trb("fleet", "revoke", fleet.authority_dir(), self.OLD, "--reason", "broken", "--via", fleet.dir(CLOUD))
        shutil.rmtree(fleet.dir(self.OLD))
        fleet.make_node(self.OLD)
        fleet.trb("fleet", "sign", fleet.authority_dir(), fleet.dir(self.OLD) / "keys" / "request.json")
        fleet.start_node(self.OLD)
        fleet.wait_formed()

    def test_a_run_says_at_once_that_a_robot_s_computer_was_replaced_and_a_person_s_word_moves_its_task(self):
        fleet = support.make_fleet(self, block=248, udp_port=50248, speed=5,
                                   robots={robot: trb_fleet.ROBOTS[robot] for robot in (ROBOT, self.OLD)})
        fleet.start()
        fleet.wait_formed()
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "s", "tasks": [
            {"id": "go", "robot": self.OLD, "skill": "go_to", "data": {"place": "dock"}}]}))
        fleet.trb("stop", self.OLD, node=CLOUD)  # so that it has not begun
        run = fleet.json("scenario", "run", path, node=CLOUD)["run"]
        self.put_another_computer_in_its_place(fleet)

        def alerts():
            return fleet.json("alert", "list", node=CLOUD)["alerts"]

        def decide(*words):
            return fleet.trb("alert", "decide", alerts()[0]["id"], "--robot", ROBOT, *words, node=CLOUD, check=False)

        new = "its node has got new keys since, and can do no more of the run"
        fleet.wait("the alert says it", lambda: [one["text"] for one in alerts()] == [new], 60)
        self.assertEqual((alerts()[0]["cause"], alerts()[0]["needs_word"]), ("peer_expired", True))
        self.assertIn("--stands if you have seen that pioneer2 stands", alerts()[0]["waits_for"])
        fleet.wait("the run says it", lambda: f"'{self.OLD}' to begin task 'go': {new}" in
                   fleet.json("run", "show", run, node=CLOUD)["waits_for"], 60)
        self.assertIn("--stands", decide().stderr)
        done = decide("--stands")
        self.assertEqual(done.returncode, 0, done.stderr)
        fleet.wait("the run has FINISHED", lambda: fleet.json("run", "show", run, node=CLOUD)["state"] == "FINISHED", 60)
        self.assertEqual(fleet.json("run", "show", run, node=CLOUD)["tasks"][0]["robot"], ROBOT)


if __name__ == "__main__":
    support.main()
