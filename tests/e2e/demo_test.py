"""scripts/demo_fleet.py: the nine tasks, one of them chosen by a thermometer that is plugged in, the counts beside
Equation 12, and that it leaves nothing behind."""
import json
import os
import pathlib
import re
import signal
import sys
import unittest

import support

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import gateway_client  # noqa: E402

BLOCK = support.take_block(60)
TASKS = [
    ("fetch_box", "ridgeback", "fetch", "ros", "ros"),
    ("run_conveyor", "conveyor", "run", "direct", "modbus"),
    ("put_box_down", "ur3", "grasp_and_put_down", "direct", "tcp-text"),
    ("go_to_ur3", "ridgeback", "go_to", "ros", "ros"),
    ("take_off", "drone", "take_off", "direct", "udp-at"),
    ("pick_left", "ur3", "pick", "direct", "tcp-text"),
    ("pick_right", "ur3", "pick", "direct", "tcp-text"),
    ("go_back", "ridgeback", "go_to", "ros", "ros"),
    ("land", "drone", "land", "direct", "udp-at"),
    ("load_out", "ridgeback", "load_out", "ros", "ros"),
]
# One thermometer, requested once, from a remote node.
EQUATION_12 = {"boot": 28, "identification": 45, "devices": 2, "task": 36, "forward": 7, "sensor": 4, "fail": 0,
               "total": 122}


class Demo(support.Demonstration, unittest.TestCase):
    def setUp(self):
        self.make_demonstration(BLOCK)

    def test_the_cold_left(self):
        self.once(15, skipped="pick_right")

    def test_the_warm_right(self):
        self.once(25, skipped="pick_left")

    def once(self, degrees, skipped):
        out = self.folder / "run.json"
        child = self.start("--once", "--speed", "4", "--json", out, "--temperature", degrees)
        said = child.communicate(timeout=240)[0]
        self.assertEqual(child.returncode, 0, said)
        self.assertEqual(self.left(), {})
        result = json.loads(out.read_text())
        self.assertEqual(set(result), {"run", "messages", "wall_s", "cost"})
        self.check_run(result["run"], skipped)
        self.check_messages(result["messages"])
        self.assertTrue(0 < result["wall_s"] < 120, result["wall_s"])
        support.tell(f"demo --once --speed 4: {result['wall_s']} s, observed {result['messages']['observed']}")

    def check_run(self, run, skipped):
        self.assertEqual(set(run), {"id", "state", "tasks"})
        self.assertRegex(run["id"], "^[0-9a-f]{32}$")
        self.assertEqual(run["state"], "FINISHED")
        fields = ("id", "robot", "skill", "mode", "transport")
        self.assertEqual([tuple(task[f] for f in fields) for task in run["tasks"]], TASKS)
        for task in run["tasks"]:
            self.assertEqual(set(task), {*fields, "state", "duration_s"})
            self.assertEqual(task["state"], "SKIPPED" if task["id"] == skipped else "FINISHED")
            self.assertEqual(0 < task["duration_s"] < 60, task["id"] != skipped, task)

    def check_messages(self, messages):
        self.assertEqual(set(messages), {"observed", "equation12"})
        self.assertEqual(messages["equation12"], EQUATION_12)
        observed = dict(messages["observed"])
        total = observed.pop("total")
        self.assertEqual(set(observed), {*EQUATION_12, "upkeep"} - {"total"})
        self.assertEqual(total, sum(observed.values()))
        for phase, least in EQUATION_12.items():
            if phase != "total":
                self.assertGreaterEqual(observed[phase], least, f"{phase}: {messages}")
        self.assertEqual(observed["fail"], 0)
        self.assertLessEqual(observed["sensor"], 20)  # the arm reports its mode and safety, too

    def test_people_sign_in_at_the_page_with_what_is_printed(self):
        child = self.start("--speed", "4")
        line = self.read_until(child, "== the page: ").splitlines()[-1]
        _, port, user, password = re.search(r"(https://localhost:(\d+)/) +sign in as (\w+), password (\S+)", line).groups()
        client = gateway_client.Client(int(port), self.root / "nodes/cloud/keys/gateway.crt")
        self.assertEqual(client.sign_in(user, password).status, 201)
        self.assertIn(b"<html", client.ask("GET", "/").bytes)
        own = "a password of my own"
        changed = client.ask("PUT", "/api/v1/me/password", {"old": password, "new": own})
        self.assertLess(changed.status, 300, changed.bytes)
        self.assertEqual(client.sign_in(user, own).status, 201)
        robots = client.ask("GET", "/api/v1/robots").json
        self.assertEqual(len(robots["items"]), 9, robots)
        os.killpg(child.pid, signal.SIGINT)
        child.communicate(timeout=60)

    def test_ctrl_c_leaves_nothing_behind(self):
        child = self.start("--speed", "4")
        self.read_until(child, "== the scenario")
        self.assertGreater(len(self.left()), 8 * 3)
        os.killpg(child.pid, signal.SIGINT)
        said = child.communicate(timeout=60)[0]
        self.assertEqual(child.returncode, 130, said)
        self.assertEqual(self.left(), {})

    def test_kill_leaves_nothing_behind(self):
        child = self.start()
        self.read_until(child, "== the scenario")
        child.kill()
        child.wait()
        support.wait_until("every process of the demonstration ends", lambda: not self.left())


if __name__ == "__main__":
    support.main()
