"""The direct mode over HTTP with JSON: a node and a virtual MiR, whose REST interface is also tested with Python's own
client. Addresses 127.0.178.x to 127.0.181.x."""
import base64
import hashlib
import http.client
import json
import os
import subprocess
import unittest

import support
import trb_fleet

VIRTUAL_MIR = support.PROGRAMS / "trb-virtual-mir"
PASSWORD = hashlib.sha256(b"distributor").hexdigest()
API = "/api/v2.0.0"


class Client:
    """As with the maker's robot: basic sign-in with the password's hash."""

    def __init__(self, address, port, password=PASSWORD):
        self.peer = http.client.HTTPConnection(address, port, timeout=60)
        self.headers = {"Authorization": "Basic " + base64.b64encode(b"distributor:" + password.encode()).decode(),
                        "Content-Type": "application/json"}

    def ask(self, method, path, body=None):
        self.peer.request(method, API + path, None if body is None else json.dumps(body), self.headers)
        answer = self.peer.getresponse()
        text = answer.read()
        self.peer.close()
        return answer.status, json.loads(text) if text else None


class MirFleet(trb_fleet.Fleet):
    """One node with a MiR on a port of its own: 80 is the superuser's."""

    def __init__(self, root, programs, block=178):
        super().__init__(root, programs, block=block, udp_port=50000 + block, robots={"mir": ("mir", "mir100", [])},
                         cloud=False)

    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "keys" / "robot.auth"
        path.touch(0o600)
        path.write_text(f"basic distributor:{PASSWORD}\n")

    def start_robot(self, node, *more):
        self.virtual[node] = trb_fleet.Process(
            [VIRTUAL_MIR, "--address", self.robot_address(node), "--port", "auto", "--speed", "10", "--die-with-parent",
             "--position", "dock=4,0,90", "--position", "far=400,0,0"], self.root / "mir.log", stdin=subprocess.PIPE)
        self.port = int(self.virtual[node].wait_line("ready", 60)[0].split()[1])
        path = self.dir(node) / "commands.json"
        path.write_text(path.read_text().replace('"port": 80,', f'"port": {self.port},'))

    def client(self, **more):
        return Client(self.robot_address("mir"), self.port, **more)

    def profile(self):
        return next(r for r in self.json("route", "list", node="mir")["routes"] if r["id"] == "mir")["profile"]

    def ask(self, name):
        done = self.json("request", "mir", name, node="mir")
        return json.loads(done["data"]) if isinstance(done["data"], str) else done["data"]

    def submit(self, mission):
        path = self.root / "scenario.json"
        path.write_text(json.dumps({"name": "m", "tasks": [
            {"id": "go", "robot": "mir", "skill": "run_mission", "data": {"mission": mission}}]}))
        return self.json("scenario", "run", path, node="mir")["run"]

    def wait_task(self, run, *states):
        def task():
            done = self.trb("scenario", "watch", run, "--once", "--json", node="mir", check=False)
            view = json.loads(done.stdout.splitlines()[-1])
            return view["tasks"][0] if view.get("tasks") else {"state": ""}
        self.wait(f"the task is {states}", lambda: task()["state"] in states, 60)
        return task()


class Mir(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, MirFleet)
        cls.fleet.start()
        cls.fleet.wait("the robot is ONLINE", lambda: cls.fleet.profile()["robot"] == "ONLINE", 60)
        cls.missions = {row["name"]: row["guid"] for row in cls.fleet.client().ask("GET", "/missions")[1]}

    def test_a_mission_is_carried_out_as_a_task_and_its_values_are_told(self):
        run = self.fleet.submit(self.missions["Go to dock"])
        self.assertEqual(self.fleet.wait_task(run, "FINISHED", "FAILED")["state"], "FINISHED")
        self.fleet.wait("it is at the dock", lambda: self.fleet.ask("position")[:2] == [4, 0], 60)
        self.assertGreater(self.fleet.ask("battery"), 80)
        self.assertEqual(self.fleet.ask("state"), 3)

    def test_b_stop_pauses_the_robot_and_empties_its_queue(self):
        run = self.fleet.submit(self.missions["Go to far"])
        self.fleet.wait_task(run, "RUNNING")
        client = self.fleet.client()
        self.fleet.wait("it drives", lambda: client.ask("GET", "/status")[1]["state_id"] == 5, 60)
        done = self.fleet.trb("stop", "mir", node="mir")
        self.assertIn("confirmed", done.stdout)
        status = client.ask("GET", "/status")[1]
        self.assertEqual((status["state_id"], status["mission_queue_id"]), (4, None))
        self.fleet.trb("release", "mir", node="mir")
        self.fleet.wait("it is ready", lambda: client.ask("GET", "/status")[1]["state_id"] == 3, 60)
        self.fleet.trb("scenario", "abort", run, node="mir", check=False)

    def test_b2_after_a_run_that_was_aborted_the_robot_takes_the_next_mission(self):
        run = self.fleet.submit(self.missions["Go to far"])
        self.fleet.wait_task(run, "RUNNING")
        client = self.fleet.client()
        self.fleet.wait("it drives", lambda: client.ask("GET", "/status")[1]["state_id"] == 5, 60)
        self.fleet.trb("scenario", "abort", run, node="mir")
        following = self.fleet.submit(self.missions["Go to dock"])
        self.assertEqual(self.fleet.wait_task(following, "FINISHED", "FAILED")["state"], "FINISHED")

    def test_c_a_mission_that_the_robot_does_not_know_fails_with_its_words(self):
        run = self.fleet.submit("no-such-mission")
        task = self.fleet.wait_task(run, "FAILED")
        self.assertIn("no such mission", task["reason"])
        self.fleet.trb("scenario", "abort", run, node="mir", check=False)

    def test_d_an_error_of_the_robot_is_a_fault_of_the_fleet_and_ends_when_it_is_cleared(self):
        robot = self.fleet.virtual["mir"]
        robot.say("fault mobile CRITICAL left motor")
        self.fleet.wait("it is out of use", lambda: self.fleet.profile().get("out_of_use"), 60)
        self.assertIn("left motor", self.fleet.ask("errors")[0]["description"])
        self.fleet.trb("send", "mir", "command", "clear_error", "--take", node="mir")
        self.fleet.wait("it is in use", lambda: not self.fleet.profile().get("out_of_use"), 60)

    def test_e_a_sign_in_that_is_wrong_is_refused(self):
        self.assertEqual(self.fleet.client(password="x").ask("GET", "/status")[0], 401)


class Alone(unittest.TestCase):
    """A killed and restarted robot is found again, at its old port."""

    def test_it_is_offline_and_comes_back(self):
        fleet = support.make_fleet(self, lambda root, programs: MirFleet(root, programs, block=118))
        fleet.start()
        fleet.wait("the robot is ONLINE", lambda: fleet.profile()["robot"] == "ONLINE", 60)
        fleet.virtual.pop("mir").stop()
        fleet.wait("the robot is gone", lambda: fleet.profile()["robot"] != "ONLINE", 60)
        fleet.virtual["mir"] = trb_fleet.Process(
            [VIRTUAL_MIR, "--address", fleet.robot_address("mir"), "--port", str(fleet.port), "--die-with-parent"],
            os.devnull, stdin=subprocess.PIPE)
        fleet.wait("the robot is back", lambda: fleet.profile()["robot"] == "ONLINE", 60)


if __name__ == "__main__":
    unittest.main(verbosity=2)
