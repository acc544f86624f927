"""Two robots on one ROS master: the virtual Ridgeback with its arm and the TurtleBot, by skills, faults, and rostopic
as the other side. Addresses 127.0.158.x and 127.0.159.x."""
import importlib.util
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import support
import trb_fleet

MISSING = [name for name in ("rosmaster", "geometry_msgs", "nav_msgs") if importlib.util.find_spec(name) is None]
ROSTOPIC = shutil.which("rostopic", path="/usr/bin")
ROBOT = support.PROGRAMS / "trb-virtual-ros-robot"
ROBOTS = {
    "ridgeback": ("ridgeback", "ridgeback", ["--arm", "--pose", "0,0,0"]),
    "turtlebot": ("ros", "turtlebot", ["--pose", "3,3,0"]),
}


@unittest.skipIf(MISSING or not ROSTOPIC, "Debian's python3-rosmaster, python3-rostopic, python3-nav-msgs are not all installed")
@unittest.skipIf(not ROBOT.exists(), "this build has no ROS: trb-virtual-ros-robot is not there")
class RosRobots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=158, robots=ROBOTS, speed=2.0)
        cls.fleet.start()
        cls.fleet.wait_formed(60)
        cls.env = dict(os.environ, ROS_MASTER_URI=cls.fleet.ros_uri(), ROS_IP="127.0.159.9",
                       ROS_HOME=str(cls.fleet.root / "ros"), PYTHONUNBUFFERED="1")

    def rostopic(self, *words):
        child = trb_fleet.Process(["/usr/bin/rostopic", *words], self.fleet.root / "rostopic.log", env=self.env)
        self.addCleanup(child.stop)
        return child

    def run_tasks(self, *tasks, expect="FINISHED"):
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps({"name": "ros", "tasks": list(tasks)}))
        done = self.fleet.trb("scenario", "run", path, "--watch", "--until-paused", "--timeout", "60",
                              node="cloud", check=False, timeout=90)
        view = self.fleet.json("scenario", "watch", "--once", node="cloud", check=False)
        self.assertEqual(view["state"], expect, done.stdout + done.stderr)
        return {task["id"]: task for task in view["tasks"]}

    def request(self, robot, what):
        return json.loads(self.fleet.json("request", robot, what, node="cloud")["data"])

    def test_each_goes_where_it_is_sent_and_says_where_it_is(self):
        self.run_tasks({"id": "a", "robot": "turtlebot", "skill": "go_to", "data": {"place": "dock"}},
                       {"id": "b", "robot": "ridgeback", "skill": "go_to", "data": {"place": "ur3_front"}})
        x, y = self.request("ridgeback", "position")
        self.assertAlmostEqual(x, 5, delta=0.06)
        self.assertAlmostEqual(y, 1, delta=0.06)
        x, y = self.request("turtlebot", "position")
        self.assertAlmostEqual(x, 0, delta=0.06)
        self.assertAlmostEqual(y, 0, delta=0.06)

    def test_the_arm_s_tasks_end_as_its_state_says(self):
        robot = self.fleet.virtual["ridgeback"]
        start = len(robot.lines)
        self.run_tasks({"id": "f", "robot": "ridgeback", "skill": "fetch", "data": {"from": "table1", "to": "conveyor_entry"}})
        line, at = robot.wait_line("fetch", 60, start)
        self.assertEqual(line, "fetch 2.000 1.000 0.000 3.000 2.000 1.571")
        robot.wait_line("task 0", 60, at)
        self.assertEqual([l for l in robot.lines[start:] if l.startswith("task")], ["task 1", "task 0"])
        self.assertEqual(len(self.request("ridgeback", "joints")), 7)

    def test_a_task_that_the_robot_gives_up_has_failed(self):
        robot = self.fleet.virtual["ridgeback"]
        start = len(robot.lines)
        path = self.fleet.root / "load.json"
        path.write_text(json.dumps({"name": "load", "tasks": [{"id": "l", "robot": "ridgeback", "skill": "load_out"}]}))
        self.fleet.trb("scenario", "run", path, node="cloud")
        robot.wait_line("load_out", 60, start)
        robot.say("fault carry CRITICAL gripper lost the box")
        self.addCleanup(robot.say, "clear")
        robot.wait_line("task 2", 60, start)

        def failed():
            view = self.fleet.json("scenario", "watch", "--once", node="cloud", check=False)
            return [task for task in view["tasks"] if task["state"] == "FAILED"]
        self.fleet.wait("the task has failed", failed, 60)
        self.assertIn("task", failed()[0]["reason"])

    def test_a_task_that_takes_too_long_is_stopped_and_its_late_word_harms_nobody(self):
        robot = self.fleet.virtual["ridgeback"]
        start = len(robot.lines)
        data = {"from": "table1", "to": "conveyor_entry"}
        tasks = self.run_tasks({"id": "late", "robot": "ridgeback", "skill": "fetch", "data": data, "timeout_s": 1},
                               expect="PAUSED")
        self.assertEqual(tasks["late"]["state"], "FAILED")
        self.assertIn("timed out after 1 s", tasks["late"]["reason"])
        robot.wait_line("cancelled", 60, start)
        robot.wait_line("task 2", 60, start)  # no task waits for it any more
        self.run_tasks({"id": "next", "robot": "ridgeback", "skill": "go_to", "data": {"place": "loading_area"}})

    def test_a_command_beside_a_skill_is_refused_and_the_skill_goes_on(self):
        robot = self.fleet.virtual["ridgeback"]
        start = len(robot.lines)
        path = self.fleet.root / "beside.json"
        path.write_text(json.dumps({"name": "beside", "tasks": [{"id": "l", "robot": "ridgeback", "skill": "load_out"}]}))
        run = self.fleet.json("scenario", "run", path, node="cloud")["run"]
        robot.wait_line("task 1", 60, start)
        done = self.fleet.trb("send", "ridgeback", "command", "move", '{"linear":{"x":0.25}}', node="cloud", check=False)
        self.assertIn("control_held", done.stderr)
        self.fleet.wait("the skill ends", lambda: self.fleet.json("scenario", "watch", run, "--once", node="cloud",
                                                                  check=False)["state"] == "FINISHED", 60)
        self.assertFalse([line for line in robot.lines[start:] if line.startswith("twist 0.25")])

    def test_a_fault_comes_back_over_its_topic_as_the_capability_s_with_the_robot_s_own_words(self):
        tap = support.Tap(self.fleet, "ridgeback")
        self.addCleanup(tap.child.stop)
        self.addCleanup(self.fleet.trb, "robot", "fault", "ridgeback", "--clear", node="cloud")
        for capability, text in (("mobile", "wheel 3 blocked"), ("carry", 'gripper lost "the box"')):
            self.fleet.trb("robot", "fault", "ridgeback", capability, "--text", text, node="cloud")
            fault = tap.wait("robot_fault", capability, lambda body, wanted=text: body["text"] == wanted)
            self.assertEqual((fault["capability"], fault["severity"]), (capability, "CRITICAL"))

    def test_a_stop_reaches_the_base_and_the_arm(self):
        robot = self.fleet.virtual["ridgeback"]
        self.addCleanup(self.fleet.trb, "release", "ridgeback", node="cloud")
        start = len(robot.lines)
        self.fleet.trb("stop", "ridgeback", node="cloud")
        robot.wait_line("twist 0.000 0.000 0.000", 60, start)
        robot.wait_line("cancelled", 60, start)

    def client(self, robot):
        client = trb_fleet.Process([sys.executable, pathlib.Path(__file__).parent / "ros_client.py", robot],
                                   self.fleet.root / "ros_client.log", stdin=subprocess.PIPE, env=self.env)
        self.addCleanup(client.stop)
        client.wait_line("ready", 60)
        return client

    def ask(self, client, *lines):
        for line in lines:
            start = len(client.lines)
            client.say(line)
            said, _ = client.wait_line("", 60, start)
        return json.loads(said)

    def test_a_ros_client_s_bad_goals_and_speeds_are_refused_and_odometry_stays_a_number(self):
        robot, client = self.fleet.virtual["turtlebot"], self.client("turtlebot")
        start = len(robot.lines)
        for line, wanted in (
                ("goal kitchen 1 1 0 1", "refused goal no transform from frame 'kitchen' to 'map'"),
                ("goal - 1 1 0 1", "refused goal no transform from frame '' to 'map'"),
                ("goal map 1 1 0 0", "refused goal the quaternion has no length"),
                ("goal map nan 1 0 1", "refused goal a number is not finite"),
                ("goal map 1 1 0 inf", "refused goal a number is not finite"),
                ("twist nan 0", "refused cmd_vel a number is not finite"),
                ("twist 0.1 -inf", "refused cmd_vel a number is not finite")):
            self.ask(client, line)
            _, start = robot.wait_line(wanted, 60, start)
        before = self.ask(client, "odom")
        self.assertTrue(all(math.isfinite(number) for number in before), before)
        self.ask(client, "goal base_link 0.5 0 0 1")
        x, y, qz, qw = before
        yaw = 2 * math.atan2(qz, qw)
        robot.wait_line(f"goal {x + 0.5 * math.cos(yaw):.3f} {y + 0.5 * math.sin(yaw):.3f}", 60, start)

    def test_a_battery_s_voltage_is_told_and_what_is_not_measured_is_nan_there_and_null_here(self):
        battery = self.ask(self.client("turtlebot"), "battery")
        self.assertGreater(battery["voltage"], 20)
        self.assertTrue(0 <= battery["percentage"] <= 1)
        for name in ("temperature", "current", "charge", "capacity", "design_capacity"):
            self.assertTrue(math.isnan(battery[name]), (name, battery))
        self.assertLessEqual(self.request("turtlebot", "battery"), 1)
        self.assertIs(self.request("turtlebot", "battery_state")["current"], None)

    def test_no_nan_is_sent_to_a_robot_and_the_refusal_names_the_field(self):
        done = self.fleet.trb("send", "turtlebot", "command", "move", '{"linear":{"x":"nan"}}', "--take", node="turtlebot",
                              check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("linear.x: 'nan' is no number that a robot can follow", done.stdout + done.stderr)

    def test_rostopic_echo_hears_a_command(self):
        echo = self.rostopic("echo", "/turtlebot/cmd_vel")
        self.fleet.wait("the command is heard", lambda: self.heard(echo), 60)
        text = "\n".join(echo.lines)
        self.assertIn("linear: \n  x: 0.25", text)
        self.assertIn("angular: \n  x: 0.0\n  y: 0.0\n  z: -0.5", text)

    def heard(self, echo):
        self.fleet.trb("send", "turtlebot", "command", "move", '{"linear":{"x":0.25},"angular":{"z":-0.5}}', "--take", node="turtlebot")
        echo.pump(0.5)
        return "---" in echo.lines

    def test_rostopic_pub_is_what_a_request_is_answered_with(self):
        self.rostopic("pub", "-r", "10", "/turtlebot/error", "std_msgs/String", "data: 'wheel \"3\" blocked'")

        def told():
            done = self.fleet.trb("request", "turtlebot", "error", node="turtlebot", check=False)
            return r"wheel \"3\" blocked" in done.stdout
        self.fleet.wait("the answer", told, 60)


if __name__ == "__main__":
    support.main()
