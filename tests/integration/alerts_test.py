"""A node's resilience: alerts outlive kill -9, and end with a verdict. Addresses 127.0.196.x and 127.0.197.x."""
import json
import os
import signal
import subprocess
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

# A box is fetched for so long that somebody can say meanwhile who is to do what follows.
ROBOTS = {"ridgeback": ("lines", "ridgeback", ["--skill", "fetch=8", "--skill", "load_out=2"]), "pioneer1": trb_fleet.ROBOTS["pioneer1"]}


class Alerts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=196, udp_port=50196, robots=ROBOTS)
        cls.fleet.start()
        cls.fleet.wait_formed()

    def alerts(self, *more):
        return self.fleet.json("alert", "list", *more, node=CLOUD)["alerts"]

    def wait_open(self, count, timeout=60):
        self.fleet.wait(f"{count} open alerts", lambda: len(self.alerts()) == count, timeout)
        return self.alerts()

    def decide(self, *words):
        done = self.fleet.trb("alert", "decide", *words, "--json", node=CLOUD, check=False)
        return done.returncode, json.loads(done.stdout)

    def test_a_fault_without_a_run_is_told_outlives_a_kill_and_ends_when_somebody_says_so(self):
        self.fleet.trb("robot", "fault", "ridgeback", "mobile", "--text", "wheel is off", node=CLOUD)
        alert, = self.wait_open(1)
        self.assertEqual((alert["robot"], alert["capability"], alert["cause"], alert["run"]),
                         ("ridgeback", "mobile", "robot_fault", ""))
        text = self.fleet.trb("alert", "list", node=CLOUD).stdout
        self.assertIn("ridgeback", text)
        self.assertIn("--retry", text)

        os.kill(self.fleet.pid(CLOUD, "resilience"), signal.SIGKILL)
        again, = self.wait_open_after_restart()
        self.assertEqual(again["id"], alert["id"])

        code, told = self.decide(alert["id"][:6], "--skip")
        self.assertEqual((code, told["error"]["code"]), (1, "bad_value"))
        code, told = self.decide("ffffffffffffffff", "--retry")
        self.assertEqual((code, told["error"]["code"]), (1, "unknown_target"))
        code, told = self.decide(alert["id"][:6], "--retry", "--person", "ann")
        self.assertEqual((code, told["state"]), (0, "accepted"))
        self.wait_open(0)  # the robot's node has taken it into use, and its profile shows it
        closed, = self.alerts("--all")
        self.assertEqual((closed["state"], closed["person"]), ("CLOSED", "ann"))
        self.check_history()

    def test_a_robot_that_is_retired_is_no_candidate_and_no_alert(self):
        self.fleet.trb("robot", "retire", "pioneer1", "--reason", "new wheels", "--person", "ann", node=CLOUD)
        self.fleet.wait("retired", lambda: "retired" in [event["kind"] for event in self.fleet.json(
            "robot", "history", "pioneer1", node=CLOUD)["events"]], 60)
        self.assertEqual(self.alerts(), [])
        self.fleet.trb("robot", "return", "pioneer1", "--person", "ann", node=CLOUD)
        self.fleet.wait("returned", lambda: "returned" in [event["kind"] for event in self.fleet.json(
            "robot", "history", "pioneer1", node=CLOUD)["events"]], 60)

    def test_a_task_is_moved_of_which_no_alert_tells(self):
        path = self.fleet.root / "scenario.json"
        fetch = {"robot": "ridgeback", "skill": "fetch", "data": {"from": "loading_area", "to": "dock"}}
        path.write_text(json.dumps({"name": "two ways", "tasks": [
            dict(fetch, id="one"), dict(fetch, id="two", after=["one"]),
            {"id": "drive", "robot": "ridgeback", "skill": "go_to", "data": {"place": "dock"}, "after": ["two"]}]}))
        for _ in range(3):
            run = self.fleet.json("scenario", "run", path, node=CLOUD)["run"]
            # Refused, once the resilience knows the run: it has not failed.
            self.fleet.wait("the run is known", lambda: self.is_over(run) or self.decide(
                "--run", run[:8], "--task", "drive", "--retry")[1]["error"]["code"] == "conflict", 60)
            # Nor does it know a robot before the router has sent its table.
            self.fleet.wait("the word is taken", lambda: self.is_over(run) or self.decide(
                "--run", run[:8], "--task", "drive", "--override", "pioneer1", "--reason", "it is nearer")[0] == 0, 60)
            self.fleet.wait("the end", lambda: self.is_over(run), 120)
            if self.view(run)["tasks"][2]["robot"] == "pioneer1":
                break  # else a stalled machine came too late with the word
        self.assertEqual([task["robot"] for task in self.view(run)["tasks"]], ["ridgeback", "ridgeback", "pioneer1"])
        asked, = [alert for alert in self.alerts("--all") if alert["run"] == run]
        self.assertEqual((asked["cause"], asked["state"]), ("asked", "DECIDED"))

    def is_over(self, run):
        return self.view(run).get("state") == "FINISHED"

    def view(self, run):
        return self.fleet.json("scenario", "watch", run, "--once", node=CLOUD, check=False)

    def check_history(self):
        """What was reported before and after the kill, newest first."""
        events = self.fleet.json("robot", "history", "ridgeback", node=CLOUD)["events"]
        ended, began = [event for event in events if event["kind"] in ("fault", "fault_ended")]
        self.assertEqual((began["kind"], began["text"]), ("fault", "CRITICAL mobile: wheel is off"))
        self.assertEqual(ended["kind"], "fault_ended")
        self.assertIn(ended["text"], ("mobile: repaired, says ann", "mobile: its node says so"))
        self.assertIn("fault_ended", self.fleet.trb("robot", "history", "--most", "500", node=CLOUD).stdout)
        self.assertEqual(len(self.fleet.json("robot", "history", "--most", "1", node=CLOUD)["events"]), 1)
        for words, status in ((["--most", "0"], 2), (["--most", "1.5"], 2), (["nobody"], 1)):
            done = self.fleet.trb("robot", "history", *words, node=CLOUD, check=False)
            self.assertEqual(done.returncode, status, done)

    def wait_open_after_restart(self):
        def answered():
            done = self.fleet.trb("alert", "list", "--json", node=CLOUD, check=False)
            return done.returncode == 0 and len(json.loads(done.stdout)["alerts"]) == 1
        self.fleet.wait("the alert is told again", answered, 60)
        return self.alerts()

    def test_words_that_make_no_sense_are_refused_before_anything_is_asked(self):
        for words in (["x", "--retry", "--skip"], ["x", "--override", "pioneer1"], [], ["--run", "71c0", "--skip"],
                      ["--run", "71c0", "--task", "t1"], ["x", "--run", "71c0", "--task", "t1", "--skip"],
                      ["--run", "71c0", "--task", "t1", "--abort"], ["x", "--task", ",", "--skip"]):
            with self.subTest(words):
                done = self.fleet.trb("alert", "decide", *words, node=CLOUD, check=False)
                self.assertEqual(done.returncode, 2)

    def test_trb_check_reads_resilience_json(self):
        path = self.fleet.dir(CLOUD) / "resilience.json"
        self.addCleanup(path.unlink)
        path.write_text('{"policy": {"mode": "sometimes"}}')
        done = subprocess.run([support.PROGRAMS / "trb", "check", self.fleet.dir(CLOUD), "--json"], capture_output=True,
                              text=True)
        faults = [fault for fault in json.loads(done.stdout)["faults"] if fault["file"] == "resilience.json"]
        self.assertEqual([fault["key"] for fault in faults], ["policy.mode"])


if __name__ == "__main__":
    support.main()
