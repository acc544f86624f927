"""The ROS worker alone, between a bridge that the test plays, a real master and nodes in rospy. Addresses 127.0.135.x."""
import importlib.util
import os
import pathlib
import struct
import time
import unittest

import ros_worker
import support
import trb_fleet
import trb_process

HERE = pathlib.Path(__file__).resolve().parent
BLOCK = 135
MASTER = (f"127.0.{BLOCK}.1", 11311)
URI = f"http://{MASTER[0]}:{MASTER[1]}/"
MISSING = [name for name in ("rospy", "rosmaster", "geometry_msgs", "std_msgs") if importlib.util.find_spec(name) is None]
WORKER = support.PROGRAMS / "trb-ros-worker"
TWIST = ("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a", "")


@unittest.skipIf(MISSING, f"Debian's packages of {', '.join(MISSING)} are not installed")
@unittest.skipIf(not WORKER.exists(), "this build has no ROS: trb-ros-worker is not there")
class WorkerAlone(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        support.hold_blocks(BLOCK)
        cls.folder = support.temporary_folder(cls)
        cls.env = dict(os.environ, ROS_MASTER_URI=URI, ROS_IP=MASTER[0], ROS_HOME=str(cls.folder / "ros"), PYTHONUNBUFFERED="1")
        master = trb_fleet.Process(["/usr/bin/rosmaster", "--core", "-p", MASTER[1]], cls.folder / "master.log", env=cls.env)
        cls.addClassCleanup(master.stop)
        if trb_process.wait_until(lambda: trb_fleet.answers(MASTER), trb_fleet.LONG_S) is None:
            raise TimeoutError(f"the ROS master does not answer within {trb_fleet.LONG_S} s: {cls.folder / 'master.log'}")

    def worker(self):
        worker = ros_worker.Worker(WORKER, self.folder / "worker.log", URI, self.env)
        self.addCleanup(worker.stop)
        worker.wait_up()
        return worker

    def node(self, *words):
        node = trb_fleet.Process(["/usr/bin/python3", HERE / "ros_topics.py", *words], self.folder / "nodes.log", env=self.env)
        self.addCleanup(node.stop)
        node.wait_line("ready", 60)
        return node

    def publish(self, worker, topic, x, patience_s):
        deadline = time.monotonic_ns() + int(patience_s * 1e9)
        worker.say(ros_worker.PUBLISH, "1", topic, *TWIST, deadline, struct.pack("<6d", x, 0, 0, 0, 0, 0))
        return worker.answer()

    def test_the_first_message_of_a_topic_reaches_each_node_that_subscribes(self):
        """ROS connects them one by one: it went to the first alone, which may be a recorder, and was told as published."""
        topics = [f"/first/{i}" for i in range(12)]
        nodes = [self.node(name, "listen", *topics) for name in ("recorder", "robot")]
        worker = self.worker()
        for topic in topics:
            self.assertEqual(self.publish(worker, topic, 0.5, 60)[0], ros_worker.PUBLISHED)
        for node in nodes:
            for topic in topics:
                node.wait_line(f"{topic} 0.5", 20)

    def test_a_node_that_the_master_names_but_that_is_gone_holds_up_nobody(self):
        gone = self.node("crashed", "listen", "/half")
        gone.child.kill()
        robot = self.node("alive", "listen", "/half")
        self.assertEqual(self.publish(self.worker(), "/half", 0.5, 60)[0], ros_worker.PUBLISHED)
        robot.wait_line("/half 0.5", 20)

    def test_what_only_the_worker_itself_listens_to_is_not_published(self):
        worker = self.worker()
        worker.say(ros_worker.SUBSCRIBE, "/own")
        word, (_, code, what, _) = self.publish(worker, "/own", 0.5, 1)
        self.assertEqual((word, code), (ros_worker.FAILED, "timeout"))
        self.assertIn("nobody subscribes to it as geometry_msgs/Twist", what)
        robot = self.node("late", "listen", "/own")
        self.assertEqual(self.publish(worker, "/own", 0.25, 60)[0], ros_worker.PUBLISHED)
        robot.wait_line("/own 0.25", 20)
        self.assertEqual(robot.lines.count("/own 0.5"), 0)

    def test_a_topic_whose_type_changes_is_heard_on(self):
        """A subscription of ROS' stays with the type of its first publisher."""
        worker = self.worker()
        worker.say(ros_worker.SUBSCRIBE, "/changing")
        for kind in ("String", "UInt8", "Empty"):
            node = self.node("teller", "say", kind, "/changing")
            deadline = time.monotonic() + 30
            while True:
                word, parts = worker.answer()
                if word == ros_worker.MESSAGE and parts[1] == f"std_msgs/{kind}":
                    break
                self.assertLess(time.monotonic(), deadline, kind)
            node.child.kill()

    def test_a_worker_whose_name_another_node_has_taken_says_so_and_ends(self):
        worker = self.worker()
        worker.say(ros_worker.SUBSCRIBE, "/any")
        self.worker().say(ros_worker.SUBSCRIBE, "/any")
        with self.assertRaises(EOFError):
            worker.answer()
        self.assertEqual(worker.process.child.wait(20), 4)


if __name__ == "__main__":
    support.main()
