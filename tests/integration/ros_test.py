"""The ros mode with a real ROS master and rospy as the other side. Addresses 127.0.140.x and 127.0.141.x."""
import importlib.util
import json
import os
import pathlib
import signal
import struct
import subprocess
import time
import unittest

import ros_worker
import support
import trb_fleet

HERE = pathlib.Path(__file__).resolve().parent
MISSING = [name for name in ("rospy", "rosmaster", "geometry_msgs", "nav_msgs", "std_msgs") if importlib.util.find_spec(name) is None]
WORKER = support.PROGRAMS / "trb-ros-worker"


class RosFleet(trb_fleet.Fleet):
    """One node, whose robot is on a ROS master of the test's; the type of its topic for speeds is found at run time."""

    def __init__(self, root, programs):
        super().__init__(root, programs, block=140, robots={"ridgeback": ("ros", "turtlebot", [])}, cloud=False)
        self.env = dict(os.environ, ROS_MASTER_URI=self.ros_uri(), ROS_IP=self.robot_address("ridgeback"),
                        ROS_NAMESPACE="ridgeback", ROS_HOME=str(self.root / "ros"), PYTHONUNBUFFERED="1")
        self.robot = None

    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "commands.json"
        words = path.read_text().replace('"cmd_vel geometry_msgs/Twist"', '"cmd_vel"')
        # A stop is confirmed by all its topics, and rospy's robot has no move_base.
        commands = json.loads(words.replace(r"\nmove_base/cancel actionlib_msgs/GoalID {}", ""))
        # As many as may wait at the bridge.
        commands["ros"]["commands"]["ramp"] = "\n".join(f"cmd_vel [{i / 256},0,0,0,0,0]" for i in range(256))
        # Ten megabytes, of numbers that JSON writes with two characters and ROS with eight bytes.
        commands["ros"]["commands"]["flood"] = "\n".join(['flood std_msgs/Float64MultiArray {"data":{data}}'] * 40)
        commands["ros"]["requests"].update(map="map_metadata width height", novel="novel")
        path.write_text(json.dumps(commands))

    def start(self):
        """The master and the robot's node are for the tests to start."""
        self.start_node("ridgeback")
        self.nodes["ridgeback"].wait_line("ready", 60)

    def stop_master(self):
        self.ros_master.child.send_signal(signal.SIGCONT)
        self.ros_master.stop(signal.SIGKILL)
        self.ros_master = None

    def start_ros_robot(self):
        self.robot = trb_fleet.Process(["/usr/bin/python3", HERE / "ros_robot.py"], self.root / "ros_robot.log", env=self.env)
        self.robot.wait_line("ready", 60)

    def stop_ros_robot(self):
        if self.robot:
            self.robot.stop(signal.SIGKILL)
            self.robot = None

    def profile(self):
        routes = self.json("route", "list", node="ridgeback")["routes"]
        return next(route for route in routes if route["id"] == "ridgeback")["profile"]

    def wait_robot(self, state, timeout=60):
        return self.wait(f"the robot is {state}", lambda: self.profile()["robot"] == state, timeout)

    def send(self, *words):
        return self.trb("send", "ridgeback", *words, node="ridgeback", check=False)

    def stop(self):
        self.stop_ros_robot()
        if self.ros_master:
            self.stop_master()
        super().stop()


@unittest.skipIf(MISSING, f"Debian's packages of {', '.join(MISSING)} are not installed")
@unittest.skipIf(not WORKER.exists(), "this build has no ROS: trb-ros-worker is not there")
class Ros(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, RosFleet)
        cls.fleet.start()

    def setUp(self):
        if self.fleet.ros_master is None:
            self.fleet.start_ros_master()
        self.fleet.ros_master.child.send_signal(signal.SIGCONT)
        if self.fleet.robot is None:
            self.fleet.start_ros_robot()
        self.fleet.wait_robot("ONLINE")

    def move(self, x):
        """Sends a speed and waits until rospy has it."""
        start = len(self.fleet.robot.lines)
        done = self.fleet.send("command", "move", json.dumps([x, 0, 0, 0, 0, 0.25]))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.fleet.robot.wait_line("twist " + json.dumps([float(x), 0.0, 0.0, 0.0, 0.0, 0.25]), 60, start)

    def test_a_command_arrives_as_the_message_that_rospy_expects(self):
        self.move(0.5)
        start = len(self.fleet.robot.lines)
        done = self.fleet.send("command", "move", '{"linear":{"x":-1.5},"angular":{"z":0.125}}')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.fleet.robot.wait_line("twist [-1.5, 0.0, 0.0, 0.0, 0.0, 0.125]", 60, start)

    def test_what_is_published_at_once_arrives_whole_and_in_order(self):
        start = len(self.fleet.robot.lines)
        done = self.fleet.send("command", "ramp", "")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.move(0.5)  # behind them
        twists = [json.loads(line[6:])[0] for line in self.fleet.robot.lines[start:] if line.startswith("twist ")]
        self.assertEqual(twists[:-1], [i / 256 for i in range(256)])

    def test_a_request_is_answered_with_what_rospy_published(self):
        done = self.fleet.trb("request", "ridgeback", "odometry", node="ridgeback")
        odometry = json.loads(done.stdout[done.stdout.index("{"):])
        self.assertEqual(odometry["pose"]["pose"]["position"], {"x": 1.25, "y": -2.5, "z": 0.0})
        self.assertEqual(odometry["child_frame_id"], "base_link")
        self.assertEqual(len(odometry["pose"]["covariance"]), 36)
        done = self.fleet.trb("request", "ridgeback", "position", node="ridgeback")
        self.assertIn("[1.25,-2.5]", done.stdout)

    def test_each_request_is_answered_with_what_is_latched(self):
        """Rospy publishes it once. The bridge keeps its subscription for 30 s, also beyond a mode-adapter's end."""
        def request(check=True):
            return self.fleet.trb("request", "ridgeback", "map", node="ridgeback", check=check).stdout
        for _ in range(3):
            self.assertIn("[40,30]", request())
        before = self.fleet.pid("ridgeback", "mode-adapter")
        os.kill(before, signal.SIGKILL)
        self.fleet.wait("a new mode-adapter", lambda: self.fleet.pid("ridgeback", "mode-adapter") not in (None, before), 60)
        self.fleet.wait("its answer", lambda: "[40,30]" in request(check=False), 20)

    def test_a_message_that_is_too_large_is_told_of_and_ends_nothing(self):
        worker = self.worker()
        for _ in range(2):
            done = self.fleet.trb("request", "ridgeback", "novel", node="ridgeback", check=False)
            self.assertIn("too_large: novel: a message of over 1 MiB", done.stderr)
        self.move(0.5)
        self.assertEqual(self.worker(), worker)

    @unittest.skipIf(support.is_sanitized(), "a sanitized bridge reads the 10 MB for longer than it may be silent, 4 s")
    def test_a_worker_that_takes_no_more_orders_is_given_up_and_gets_no_part_of_a_later_one(self):
        """What had no room was thrown away in the middle of an order, and the next one was read as its end."""
        for _ in range(3):
            self.fleet.wait_robot("ONLINE")
            worker = self.worker()
            os.kill(worker, signal.SIGSTOP)
            done = self.fleet.send("command", "flood", json.dumps([0] * 32000, separators=(",", ":")))
            if "does not answer" not in done.stderr:  # a machine may be starved for the 5 s of a worker that hangs
                break
        self.assertIn("the ROS worker takes no more orders", done.stderr)
        self.fleet.wait("a command arrives", self.arrives, 60)
        self.assertNotEqual(self.worker(), worker)

    def worker_alone(self):
        worker = ros_worker.Worker(WORKER, self.fleet.root / "worker.log", self.fleet.ros_uri(), self.fleet.env)
        self.addCleanup(worker.stop)
        worker.wait_up()
        return worker

    def test_what_a_worker_reads_too_late_is_not_published(self):
        """As behind a call to a slow master. Its time is a point of the monotonic clock, the bridge's own."""
        worker = self.worker_alone()

        def publish(token, x, patience_s):
            deadline = time.monotonic_ns() + int(patience_s * 1e9)
            worker.say(ros_worker.PUBLISH, token, "/ridgeback/cmd_vel", "geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a",
                       "", deadline, struct.pack("<6d", x, 0, 0, 0, 0, 0))
            return worker.answer()
        start = len(self.fleet.robot.lines)
        self.assertEqual(publish("1", 0.125, 60), (ros_worker.PUBLISHED, ["1"]))
        word, (token, code, what, _) = publish("2", 9.25, -0.5)
        self.assertEqual((word, token, code), (ros_worker.FAILED, "2", "timeout"))
        self.assertIn("its time was over", what)
        self.assertEqual(publish("3", 0.25, 60), (ros_worker.PUBLISHED, ["3"]))
        self.fleet.robot.wait_line("twist [0.25, ", 60, start)
        self.assertFalse([line for line in self.fleet.robot.lines[start:] if "9.25" in line])

    def test_a_name_that_ros_refuses_ends_no_worker(self):
        """The bridge refuses such a name, too; here nobody does before the worker."""
        worker = self.worker_alone()
        worker.say(ros_worker.LOOK_UP, "2d_scan")
        self.assertEqual(worker.answer(), (ros_worker.TYPE, ["2d_scan", ""]))
        worker.say(ros_worker.PUBLISH, "7", "2d_scan", "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e", "", time.monotonic_ns(), "")
        word, (token, code, what, _) = worker.answer()
        self.assertEqual((word, token, code), (ros_worker.FAILED, "7", "bad_value"))
        self.assertIn("2d_scan", what)
        worker.say(ros_worker.SUBSCRIBE, "2d_scan")
        word, (topic, code, *_) = worker.answer()
        self.assertEqual((word, topic, code), (ros_worker.TOPIC_FAILED, "2d_scan", "bad_value"))
        worker.say(ros_worker.LOOK_UP, "/ridgeback/cmd_vel")
        self.assertEqual(worker.answer(), (ros_worker.TYPE, ["/ridgeback/cmd_vel", "geometry_msgs/Twist"]))

    def worker(self):
        return self.fleet.pid_of_child(self.fleet.pid("ridgeback", "ros-bridge"), "ros-worker")

    def test_a_wrong_message_is_refused_by_its_field(self):
        for data, reason in (("[1,2]", "2 values, where 6 are needed"),
                             ('{"linear":{"w":1}}', "linear: w: no field of geometry_msgs/Vector3; it has x, y, z"),
                             ('{"linear":{"x":"fast"}}', "linear.x: a text, where a number is needed"),
                             ("fast", "the data is no JSON")):
            with self.subTest(data):
                done = self.fleet.send("command", "move", data)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(reason.split(";")[0], done.stderr)

    def test_a_stop_is_the_zero_of_the_topic(self):
        start = len(self.fleet.robot.lines)
        self.fleet.trb("stop", "ridgeback", node="ridgeback")
        self.fleet.robot.wait_line("twist [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]", 60, start)
        self.assertIn("fenced", self.fleet.send("command", "move", "[1,0,0,0,0,0]").stderr)
        self.fleet.trb("release", "ridgeback", node="ridgeback")
        self.move(0.75)

    def test_what_its_sender_was_refused_is_not_published_to_a_robot_that_starts_then(self):
        self.move(0.5)
        self.fleet.stop_ros_robot()
        refused = self.fleet.send("command", "move", "[9,0,0,0,0,0]", "--timeout", "1")
        self.assertNotEqual(refused.returncode, 0, refused.stdout)
        self.fleet.start_ros_robot()
        self.move(0.5)  # it would have gone before this one
        self.assertFalse([line for line in self.fleet.robot.lines if "9.0" in line])

    def pids(self):
        return {name: self.fleet.pid("ridgeback", name) for name in ("router", "mode-adapter", "ros-bridge", "scheduler")}

    def test_a_killed_master_is_told_of_and_its_successor_is_used_without_a_restart(self):
        before = self.pids()
        self.fleet.stop_master()
        self.fleet.stop_ros_robot()
        self.fleet.wait_robot("CONNECTION_BROKEN")
        self.assertIn("no ROS master at", self.fleet.profile()["detail"])
        self.assertIn("robot_offline", self.fleet.send("command", "move", "[1,0,0,0,0,0]").stderr)
        self.fleet.start_ros_master()
        self.fleet.start_ros_robot()
        self.fleet.wait_robot("ONLINE")
        self.move(1.0)
        self.assertEqual(self.pids(), before)

    def test_a_master_that_was_started_again_within_a_moment_is_noticed(self):
        self.fleet.stop_ros_robot()
        self.fleet.stop_master()
        self.fleet.start_ros_master()
        self.fleet.start_ros_robot()
        self.fleet.wait("a command arrives", self.arrives, 60)

    def test_a_master_with_the_pid_of_the_one_before_is_noticed(self):
        """As in a container, whose first process is always 1."""
        own_pids = ["unshare", *([] if os.geteuid() == 0 else ["--map-root-user"]), "--pid", "--fork", "--kill-child"]
        if subprocess.run([*own_pids, "true"], capture_output=True).returncode != 0:
            self.skipTest("no pid namespace can be made here")
        self.addCleanup(setattr, self.fleet, "ros_master_inside", [])
        self.fleet.ros_master_inside = own_pids
        for _ in range(2):
            self.fleet.stop_ros_robot()
            self.fleet.stop_master()
            self.fleet.start_ros_master()
            self.fleet.start_ros_robot()
            self.fleet.wait("a command arrives", self.arrives, 60)

    def arrives(self):
        return self.fleet.send("command", "move", "[2,0,0,0,0,0]").returncode == 0

    def test_a_master_that_hangs_is_told_of_and_is_used_again_when_it_goes_on(self):
        before = self.pids()
        self.fleet.ros_master.child.send_signal(signal.SIGSTOP)
        self.fleet.wait_robot("CONNECTION_BROKEN")
        self.assertIn("does not answer", self.fleet.profile()["detail"])
        self.assertEqual(self.fleet.services("ridgeback")["ros-bridge"]["state"], "up")
        self.fleet.ros_master.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE", 60)
        self.move(1.5)
        self.assertEqual(self.pids(), before)


@unittest.skipIf(MISSING, f"Debian's packages of {', '.join(MISSING)} are not installed")
@unittest.skipIf(not WORKER.exists(), "this build has no ROS: trb-ros-worker is not there")
class Late(unittest.TestCase):
    def test_a_node_comes_up_before_its_master(self):
        fleet = support.make_fleet(self, RosFleet)
        fleet.start()
        fleet.wait("the reason", lambda: "no ROS master at" in fleet.profile()["detail"], 60)
        fleet.start_ros_master()
        fleet.wait_robot("ONLINE")
        unknown = fleet.send("command", "move", "[1,0,0,0,0,0]")
        self.assertIn("the ROS master knows no topic cmd_vel", unknown.stderr)


if __name__ == "__main__":
    support.main()
