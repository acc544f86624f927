"""A scenario's preflight, tasks that are bound when they are due, and rounds, with two Pioneers that can do the same.

Addresses 127.0.168.x and 127.0.169.x.
"""
import json
import os
import re
import signal
import unittest

import support
import trb_fleet

ROBOTS = {"pioneer1": ("lines", "pioneer", ["--pose", "0.5,0,0"]), "pioneer2": ("lines", "pioneer", ["--pose", "0,0.5,0"])}
MOST_TRIED = 3  # who chooses a robot, and each robot, has 2 s to answer, which a stalled machine uses up
MOVE = {"id": "move", "requires": ["mobile"], "skill": "go_to", "data": {"place": "dock"}}


class ScenarioLanguage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path = support.temporary_folder(cls) / "s.json"
        cls.fleet = support.make_fleet(cls, block=168, udp_port=50168, robots=ROBOTS, speed=4.0)
        cls.fleet.start()
        cls.fleet.wait_formed()

    def setUp(self):
        self.addCleanup(self.release)
        self.fleet.wait("the resilience answers", lambda: self.fleet.trb("alert", "list", node="cloud", check=False).returncode == 0, 60)

    def release(self):
        self.fleet.trb("release", "--all", node="cloud")
        self.wait_fenced()

    def stop(self, *robots):
        for robot in robots:
            self.fleet.trb("stop", robot, node="cloud")
        self.wait_fenced(*robots)

    def wait_fenced(self, *robots):
        def fenced():
            routes = self.fleet.json("route", "list", node="cloud")["routes"]
            return sorted(route["id"] for route in routes if route["profile"]["fenced"])
        self.fleet.wait(f"fenced are {robots}", lambda: fenced() == sorted(robots), 60)

    def scenario(self, *tasks, **more):
        self.path.write_text(json.dumps({"name": "n", "tasks": tasks, **more}))
        return self.path

    def run_to_end(self, *tasks, **more):
        done = self.fleet.trb("scenario", "run", self.scenario(*tasks, **more), "--watch", "--timeout", 60, node="cloud")
        self.assertIn("FINISHED", done.stdout)
        return done.stdout

    def faults(self, command, *tasks):
        done = self.fleet.trb("scenario", command, self.scenario(*tasks), "--json", node="cloud", check=False)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        return [(fault["key"], fault["what"]) for fault in json.loads(done.stdout)["faults"]]

    def test_preflight(self):
        path = self.scenario(dict(MOVE, robot="pioneer1"), dict(MOVE, id="stay", robot="pioneer2", pinned=True), MOVE | {"id": "any"})
        pinned = {"task": "stay", "robot": "pioneer2", "why": "it is pinned to its robot"}
        check = self.fleet.json("scenario", "check", path, node="cloud")
        self.assertEqual(check, {"faults": [], "fleet_checked": True, "no_spare": [pinned]})
        self.stop("pioneer2")
        why = "'pioneer2' is stopped until it is released"
        alone = [{"task": task, "robot": "pioneer1", "why": why} for task in ("move", "any")]
        self.assertEqual(self.fleet.json("scenario", "check", path, node="cloud")["no_spare"], [alone[0], pinned, alone[1]])
        self.assertIn(f"no spare: move (pioneer1): {why}\n", self.fleet.trb("scenario", "check", path, node="cloud").stdout)
        # No node is asked, so no node's statement is shown.
        self.assertEqual(self.fleet.json("scenario", "check", path), {"faults": [], "fleet_checked": False})

    def view(self, run, node="cloud"):
        return self.fleet.json("scenario", "watch", run, "--once", node=node, check=False)

    def wait_view(self, run, what, found, timeout=60):
        self.fleet.wait(f"{what}: {run}", lambda: found(self.view(run)), timeout)
        return self.view(run)

    def task_of(self, view, task):
        return next(one for one in view["tasks"] if one["id"] == task)

    def go(self, robot, place):
        return {"id": robot, "robot": robot, "skill": "go_to", "data": {"place": place}}

    def run_bound_later(self, path, *words, said, node="cloud"):
        """What `trb scenario run` says of a run whose robot is chosen when it is due."""
        for _ in range(MOST_TRIED):
            done = self.fleet.trb("scenario", "run", path, *words, node=node, check=False)
            if re.search(said, done.stdout):
                break
            for run in re.findall("[0-9a-f]{32}", done.stdout)[:1]:  # it may have been refused
                self.fleet.trb("scenario", "abort", run, node=node, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_the_nearest_is_chosen_when_the_task_is_due(self):
        """Which one is near is known only once the two have driven: at the start it may have been the other one."""
        for near, far in (("pioneer2", "pioneer1"), ("pioneer1", "pioneer2")):
            with self.subTest(near=near):
                path = self.scenario(self.go(near, "dock"), self.go(far, "ur3_front"), dict(MOVE, after=[near, far]))
                for _ in range(MOST_TRIED):
                    answer = json.loads(self.run_bound_later(path, "--json", said='"by": ?"cloud"'))
                    self.assertEqual(answer["bound"], [{"task": "move", "by": "cloud"}])
                    view = self.wait_view(answer["run"], "ends", lambda view: view.get("state") == "FINISHED", 60)
                    move = self.task_of(view, "move")
                    if move["robot"] == near:
                        break
                self.assertEqual((move["robot"], move["moved_from"], view["epoch"]), (near, "", 2))
                decision, = view["decisions"]
                self.assertEqual([(one["task"], one["ruling"], one["robot"]) for one in decision["tasks"]], [("move", "move", near)])
                self.assertEqual((decision["by"], decision["person"]), ("cloud", ""))
                alert, = (one for one in self.fleet.json("alert", "list", "--all", node="cloud")["alerts"] if one["id"] == decision["alert"])
                self.assertEqual((alert["cause"], alert["state"], alert["robot"]), ("robot_wanted", "DECIDED", ""))
                self.assertEqual([one["robot"] for one in alert["proposals"]], [near, far])
                way = {part["criterion"]: part["value"] for part in alert["proposals"][0]["parts"]}["distance"]
                self.assertLess(way, 0.2)

    def test_nobody_can_until_somebody_comes(self):
        self.stop("pioneer1", "pioneer2")
        text = self.run_bound_later(self.scenario(MOVE), said="cloud chooses", node="pioneer1")
        self.assertIn("task move: cloud chooses its robot when it is due\n", text)
        run = text.split("run ")[1].split()[0]
        self.fleet.wait("the cloud knows the run", lambda: self.view(run).get("run") == run, 60)
        view = self.wait_view(run, "PAUSED", lambda view: view.get("state") == "PAUSED")
        self.assertEqual(view["waits_for"], "a robot for task 'move', to be chosen by 'cloud'; see: trb alert list")
        def unfit():
            return [{one["robot"]: one["why"] for one in alert["unfit"]}
                    for alert in self.fleet.json("alert", "list", node="cloud")["alerts"]]
        self.fleet.wait("one alert that says why neither can", lambda: unfit() == [
            {robot: "is stopped until it is released" for robot in ROBOTS}], 60)
        for service in ("scheduler", "resilience"):
            os.kill(self.fleet.pid("cloud", service), signal.SIGKILL)
        self.fleet.trb("release", "pioneer2", node="cloud")
        view = self.wait_view(run, "ends", lambda view: view.get("state") == "FINISHED", 60)
        self.assertEqual(self.task_of(view, "move")["robot"], "pioneer2")

    def test_without_a_node_that_decides_the_first_is_taken_at_once(self):
        os.kill(self.fleet.pid("cloud", "resilience"), signal.SIGSTOP)
        pid = self.fleet.pid("cloud", "resilience")
        self.addCleanup(lambda: os.kill(pid, signal.SIGKILL))
        text = self.run_to_end(MOVE)
        self.assertIn("robots are chosen now, the first by id that can: node 'cloud', which decides, has no resilience that answers", text)
        self.assertIn("task move is given to pioneer1\n", text)
        self.stop("pioneer1")
        answer = self.fleet.json("scenario", "run", self.scenario(MOVE), node="cloud")
        self.assertEqual(answer["bound"], [{"task": "move", "robot": "pioneer2"}])
        self.fleet.trb("scenario", "watch", answer["run"], "--timeout", 60, node="cloud")
        self.stop("pioneer1", "pioneer2")
        (key, what), = self.faults("run", MOVE)
        self.assertEqual(key, "tasks[0].requires")
        self.assertIn("nobody can do it now: 'pioneer1' is stopped until it is released; 'pioneer2' is stopped", what)
        # It is a temporary fault, not one of the scenario.
        self.assertEqual(self.fleet.json("scenario", "check", self.scenario(MOVE), node="cloud")["faults"], [])

    def test_nobody_in_the_fleet(self):
        self.assertEqual(self.faults("check", dict(MOVE, requires=["fly"])),
                         [("tasks[0].requires", "task 'move': no robot of the fleet has the capability 'fly'")])

    def test_rounds(self):
        there = {"id": "there", "robot": "pioneer1", "skill": "go_to", "data": {"place": "loading_area"}}
        text = self.run_to_end(there, dict(MOVE, after=["there"]), repeat=2)
        ends = [line.split()[2] for line in text.splitlines() if "FINISHED" in line and "/4" in line]
        self.assertEqual(ends, ["there", "move", "there#2", "move#2"])


if __name__ == "__main__":
    support.main()
