"""What keeps a robot out of use, by the command line and over kills: a fault stands until its end is reported.

Addresses 127.0.246.x, 127.0.247.x.
"""
import json
import os
import shutil
import signal
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

ROBOT, OTHER = "ridgeback", "pioneer1"


def own_programs(case):
    """A folder of the programs from which one can be taken away: a supervisor starts what lies beside it."""
    folder = support.temporary_folder(case)
    for program in support.PROGRAMS.glob("trb*"):
        (folder / program.name).symlink_to(program)
    (folder / "trb").unlink()
    shutil.copy(support.PROGRAMS / "trb", folder)
    return folder


class OutOfUse(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        robots = {name: trb_fleet.ROBOTS[name] for name in (ROBOT, OTHER)}
        cls.fleet = support.make_fleet(cls, programs=own_programs(cls), block=246, udp_port=50246, robots=robots, speed=5)
        cls.fleet.start()
        cls.fleet.wait_formed()

    def setUp(self):
        self.addCleanup(self.fleet.trb, "robot", "return", ROBOT, node=CLOUD, check=False)
        self.addCleanup(self.fleet.trb, "robot", "repaired", ROBOT, node=CLOUD, check=False)

    def out_of_use(self):
        routes = self.fleet.json("route", "list", node=CLOUD)["routes"]
        return next(route for route in routes if route["id"] == ROBOT)["profile"]["out_of_use"]

    def wait_out_of_use(self, *wanted):
        self.fleet.wait(f"out of use: {wanted}",
                        lambda: [one["capability"] or ("retired" if one["retired"] else "all") for one in self.out_of_use()]
                        == list(wanted), 60)

    def fault(self, *words):
        self.fleet.trb("robot", "fault", ROBOT, *words, node=CLOUD)

    def kill_adapter(self):
        """Until the cloud has the next one's word: the tables go on with the last word of the one that is gone."""
        before = self.fleet.services(ROBOT)["mode-adapter"]["instance"]
        os.kill(self.fleet.pid(ROBOT, "mode-adapter"), signal.SIGKILL)
        self.fleet.wait("another mode-adapter", lambda: (now := self.fleet.services(ROBOT)["mode-adapter"])["state"] == "up"
                        and now["instance"] != before, 60)
        # It tells what is out of use once its robot is connected, and then answers, on the same way.
        self.fleet.wait("its robot answers the cloud", lambda: self.fleet.trb(
            "request", ROBOT, "position", "--timeout", "1", node=CLOUD, check=False).returncode == 0, 60)
        self.fleet.wait_formed()

    def test_a_fault_stands_over_a_kill_until_the_robot_takes_it_back(self):
        self.fault("carry", "--text", "gripper jammed")
        self.wait_out_of_use("carry")
        self.kill_adapter()
        self.wait_out_of_use("carry")
        self.assertEqual(self.out_of_use()[0]["text"], "gripper jammed")
        listed = self.fleet.trb("robot", "list", node=CLOUD).stdout
        self.assertRegex(listed, rf"(?m)^{ROBOT}: carry out of use, CRITICAL since .*: gripper jammed; trb robot repaired {ROBOT}$")
        self.fault("--clear")
        self.wait_out_of_use()
        self.kill_adapter()
        self.wait_out_of_use()

    def test_a_robot_whose_mode_adapter_does_not_come_back_is_not_called_online(self):
        def told():
            routes = self.fleet.json("route", "list", node=CLOUD)["routes"]
            profile = next(route for route in routes if route["id"] == ROBOT)["profile"]
            return profile["robot"], profile["detail"]

        self.fleet.wait("it is online", lambda: told()[0] == "ONLINE", 60)
        program = self.fleet.programs / "trb-mode-adapter"
        real = program.readlink()
        program.unlink()  # as after a fault of the disk: its supervisor starts it again and again, in vain
        try:
            os.kill(self.fleet.pid(ROBOT, "mode-adapter"), signal.SIGKILL)
            self.fleet.wait("the fleet knows that nobody reports the robot", lambda: told() == (
                "CONNECTION_BROKEN", "its mode-adapter does not report: trb service list on its node"), 60)
        finally:
            program.symlink_to(real)
        self.fleet.wait("it is reported again", lambda: told() == ("ONLINE", ""), 60)

    def test_a_person_says_that_it_is_repaired(self):
        self.fault("carry", "--text", "gripper jammed")
        self.wait_out_of_use("carry")
        wrong = self.fleet.trb("robot", "repaired", ROBOT, "--capability", "mobile", node=CLOUD, check=False)
        self.assertIn("no fault keeps 'mobile' alone out of use", wrong.stderr)
        self.fleet.trb("robot", "repaired", ROBOT, "--capability", "carry", node=CLOUD)
        self.wait_out_of_use()

    def test_retired_and_back(self):
        self.assertEqual(self.fleet.trb("robot", "retire", ROBOT, node=CLOUD, check=False).returncode, 2)
        self.fleet.trb("robot", "retire", ROBOT, "--reason", "new wheels", "--person", "ann", node=CLOUD)
        self.wait_out_of_use("retired")
        self.kill_adapter()
        self.wait_out_of_use("retired")
        self.assertEqual((self.out_of_use()[0]["by"], self.out_of_use()[0]["text"]), ("ann", "new wheels"))
        found = self.fleet.json("doctor", node=CLOUD, check=False)["findings"]
        self.assertIn(("robot_retired", ROBOT), [(one["cause"], one["subject"]) for one in found])
        self.fleet.trb("robot", "return", ROBOT, node=ROBOT)  # a person at the robot may report it, too
        self.wait_out_of_use()

    def test_another_robots_keys_take_nothing_out_of_use(self):
        done = self.fleet.trb("robot", "retire", ROBOT, "--reason", "spite", node=OTHER, check=False)
        self.assertIn("not_permitted", done.stderr)
        self.assertEqual(self.out_of_use(), [])

    def test_the_check_of_a_scenario_warns_of_it(self):
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "s", "tasks": [
            {"id": "load", "robot": ROBOT, "skill": "load_out", "on_failure": "skip"},
            {"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}, "after": ["load"]}]}))
        self.fault("carry", "--text", "gripper jammed")
        self.wait_out_of_use("carry")
        told = self.fleet.json("scenario", "check", path, node=CLOUD)
        self.assertEqual([(one["key"], one["may_wait"]) for one in told["faults"]],
                         [("tasks[0].on_failure", True), ("tasks[0].robot", True)])
        self.assertIn("'ridgeback' cannot use 'carry': gripper jammed", told["faults"][1]["what"])

    def test_what_needs_it_waits_and_goes_on_when_it_is_repaired(self):
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "s", "tasks": [{"id": "load", "robot": ROBOT, "skill": "load_out"}]}))
        self.fault("carry", "--text", "gripper jammed")
        self.wait_out_of_use("carry")
        run = self.fleet.json("scenario", "run", path, "--priority", "4", node=ROBOT)["run"]

        def view():
            return self.fleet.json("run", "show", run, node=ROBOT)
        self.fleet.wait("the task waits for its robot", lambda: "out of use" in json.dumps(view()), 60)
        self.assertEqual(view()["tasks"][0]["attempt"] <= 1, True)
        self.assertEqual(view()["priority"], 4)
        self.fleet.trb("robot", "repaired", ROBOT, node=CLOUD)
        self.fleet.wait("the run has FINISHED", lambda: view()["state"] == "FINISHED", 60)
        listed = self.fleet.trb("run", "list", "--all", node=ROBOT).stdout
        self.assertIn(run[:8], listed)
        shown = self.fleet.trb("run", "show", run[:8], node=ROBOT).stdout
        self.assertIn("FINISHED", shown)
        self.assertIn("load", shown)

    def test_the_cloud_says_what_keeps_a_robot_from_its_task_and_what_cures_it(self):
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "s", "tasks": [
            {"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}]}))
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD, check=False)
        self.fleet.trb("stop", ROBOT, node=CLOUD)
        run = self.fleet.json("scenario", "run", path, node=CLOUD)["run"]

        def wait_shown(words):
            wanted = f"'{ROBOT}' to begin task 'go': {words}"
            self.fleet.wait(wanted, lambda: (shown := self.fleet.json("run", "show", run, node=CLOUD))["waits_for"] == wanted
                            and shown["tasks"][0]["waits_for"] == wanted, 30)
            listed = self.fleet.json("run", "list", node=CLOUD)["runs"]
            self.assertEqual([one["waits_for"] for one in listed if one["run"] == run], [wanted])

        wait_shown("the robot is stopped until 'trb release'")
        self.fleet.trb("robot", "retire", ROBOT, "--reason", "new wheels", "--person", "ann", node=CLOUD)
        self.fleet.trb("release", ROBOT, node=CLOUD)
        wait_shown("the robot is out of service: new wheels (ann); trb robot return takes it back")
        self.fleet.trb("robot", "return", ROBOT, node=CLOUD)
        self.fleet.wait("the run has FINISHED",
                        lambda: self.fleet.json("run", "show", run, node=CLOUD)["state"] == "FINISHED", 60)


if __name__ == "__main__":
    support.main()
