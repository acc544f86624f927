"""Driving by hand: a person's speeds from the cloud to each maker's robot, which moves at that speed, and stands when
they cease: because the person's program died, the node lost the cloud, or the mode-adapter was killed or ended. Prints how long
each still moves. Real processes; addresses 127.0.184.x and 127.0.185.x.
"""
import json
import math
import os
import signal
import time
import unittest

import support
import trb_fleet
from driven_robots import MAKERS, MARGIN_S, NOT_THERE, STANDS_S, STILL_M, Robot


class DriveFleet(trb_fleet.Fleet):
    """Each maker's robot and the cloud, without what driving does not need."""

    def node_json(self, node):
        made = super().node_json(node)
        made["services"] = [name for name in made["services"] if name not in ("scheduler", "resilience")]
        return made


MOST_BEGUN = 5  # drives, until one moves the robot
MOST_MEASURED = 3  # of which the best counts: what a stalled machine adds comes and goes


class HandDrive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        robots = {name: maker.robot for name, maker in MAKERS.items()}
        cls.fleet = support.make_fleet(cls, DriveFleet, block=184, udp_port=50184, robots=robots)
        cls.fleet.start()
        cls.fleet.wait_formed()
        cls.figures = {}

    @classmethod
    def tearDownClass(cls):
        if not cls.figures:
            return
        print("\nstill moves for (s), after                messages cease   cloud lost   mode-adapter killed, ended")
        for name, row in cls.figures.items():
            cells = [f"{row[key]:.2f}" if key in row else "-" for key in ("cease", "cloud", "killed", "ended")]
            speed = f"{MAKERS[name].speed:.2f} {MAKERS[name].unit}/s"
            print(f"  {name:12} at {speed:20}" + "".join(f"{cell:>14}" for cell in cells))

    def trb(self, *words, check=True):
        return self.fleet.trb(*words, node="cloud", check=check)

    def make_ready(self, name):
        robot = Robot(self.fleet, name)
        robot.make_ready("cloud")
        return robot

    def begin(self, name, speeds=None, part=None, pick=None):
        """`trb drive` for longer than any test; returns its process once the robot moves at its speed."""
        maker = MAKERS[name]
        robot = self.make_ready(name)
        speeds = speeds or maker.speeds
        words = ["drive", name, "--part", part or maker.part, "--speeds", ",".join(map(str, speeds)), "--for", "60", "--take",
                 "--json", "--node", self.fleet.dir("cloud")]
        log = self.fleet.root / f"drive-{name}.log"
        wanted, begun = math.hypot(*speeds), []

        def drive():
            begun.append(trb_fleet.Process([support.PROGRAMS / "trb", *words], log))
            self.addCleanup(begun[-1].stop, signal.SIGKILL)

        def moves():
            """A refused drive is begun anew: a drone is up before it says so, and a stalled machine ends a drive, as it must."""
            if begun[-1].child.poll() is not None and len(begun) < MOST_BEGUN:
                drive()
            return robot.moves_at(wanted, pick)

        drive()
        try:
            self.fleet.wait(f"{name} moves at {wanted} {maker.unit}/s", moves, 15)
        except TimeoutError as late:
            raise AssertionError(f"{late}; its drives said: {log.read_text()}") from late
        driver = begun[-1]
        return robot, driver

    def begin_at_speed(self, name, wanted, within, speeds=None, part=None, pick=None):
        """As begin(), and the robot keeps that speed, with where it was before and after: of some tries one, for a stalled
        machine lets it stand, as it must."""
        for _ in range(MOST_BEGUN):
            robot, driver = self.begin(name, speeds, part, pick)
            _, before = robot.at(pick)
            speed = robot.speed(0.6, pick)
            _, after = robot.at(pick)
            if abs(speed - wanted) <= within:
                break
            driver.stop(signal.SIGKILL)
        self.assertAlmostEqual(speed, wanted, delta=within)
        return robot, driver, before, after

    def keep(self, name, key, most, end):
        """How long the robot still moved after the end of its drive, which `end` begins, and ends, and tells."""
        seconds = end(name)
        for _ in range(MOST_MEASURED - 1):
            seconds = seconds if seconds <= most else min(seconds, end(name))
        type(self).figures.setdefault(name, {})[key] = seconds
        self.assertLessEqual(seconds, most, f"{name} moved on for {seconds:.2f} s")

    def control(self, name):
        routes = self.fleet.json("route", "list", node="cloud")["routes"]
        return next(route for route in routes if route["id"] == name)["profile"]["control"]

    def cease(self, name):
        speed = MAKERS[name].speed
        robot, driver, *_ = self.begin_at_speed(name, speed, 0.08 * speed)
        self.assertEqual(self.control(name), "cloud")
        ended = time.monotonic()
        driver.stop(signal.SIGKILL)
        seconds = robot.moves_on(ended)
        self.fleet.wait("control is free", lambda: self.control(name) == "", 60)
        return seconds

    def lose_cloud(self, name):
        router = self.fleet.pid("cloud", "router")
        robot, driver = self.begin(name)
        lost = time.monotonic()
        os.kill(router, signal.SIGSTOP)
        try:
            seconds = robot.moves_on(lost)
        finally:
            os.kill(router, signal.SIGCONT)
        # What had waited in the cloud arrives now.
        _, place = robot.at()
        driver.child.wait(60)
        robot.moves_on(time.monotonic())
        self.assertLess(math.dist(robot.at()[1], place), 2 * STILL_M)
        self.assertNotEqual(driver.child.returncode, 0)
        self.fleet.wait_formed()
        return seconds

    def end_adapter(self, name, how):
        robot, driver = self.begin(name)
        driver.child.send_signal(signal.SIGSTOP)  # else the new process would be driven on
        adapter = self.fleet.pid(name, "mode-adapter")
        os.kill(adapter, how)
        seconds = robot.moves_on(time.monotonic())
        self.fleet.wait("the process has ended by itself", lambda: not os.path.exists(f"/proc/{adapter}"), 15)
        driver.stop(signal.SIGKILL)
        self.fleet.wait_formed()
        return seconds

    def test_1_each_moves_at_the_speed_that_it_is_given_and_stands_when_messages_cease(self):
        for name in MAKERS:
            with self.subTest(name):
                self.keep(name, "cease", STANDS_S, self.cease)

    def test_2_each_stands_when_its_node_has_lost_the_cloud_and_nothing_late_moves_it(self):
        for name in MAKERS:
            with self.subTest(name):
                self.keep(name, "cloud", STANDS_S, self.lose_cloud)

    def test_3_each_stands_when_its_mode_adapter_is_killed(self):
        for name, maker in MAKERS.items():
            with self.subTest(name):
                self.keep(name, "killed", maker.dies_s + MARGIN_S, lambda name: self.end_adapter(name, signal.SIGKILL))

    def test_4_each_stands_before_its_mode_adapter_ends(self):
        for name in MAKERS:
            with self.subTest(name):
                self.keep(name, "ended", STANDS_S, lambda name: self.end_adapter(name, signal.SIGTERM))

    def test_who_lets_go_has_it_stand_at_once_and_knows_how_long_messages_took(self):
        robot = self.make_ready("pioneer")
        for _ in range(MOST_BEGUN):  # other load may delay one, but not the quickest of some
            report = self.fleet.json("drive", "pioneer", "--speeds", "0.2,0.2", "--for", "1", node="cloud", check=False)
            moved_on = robot.moves_on(time.monotonic())
            if moved_on < 0.5 and report.get("answered", 0) >= 8 and report["round_trip_ms"]["median"] < 100:
                break
        self.assertLess(moved_on, 0.5)
        self.assertEqual((report["robot"], report["part"]), ("pioneer", "base"))
        self.assertGreaterEqual(report["answered"], 8)
        self.assertEqual(len(report["round_trips_ms"]), report["answered"])
        self.assertLess(report["round_trip_ms"]["median"], 100)
        print(f"\nthere and back: {report['round_trip_ms']} ms, {report['answered']} of {report['sent']} answered")
        self.assertEqual(self.control("pioneer"), "")

    def test_the_tool_of_an_arm_goes_straight_up(self):
        robot, driver, before, after = self.begin_at_speed("ur3", 0.05, 0.005, [0, 0, 0.05], "tool", slice(6, 9))
        self.assertLess(math.dist(before[:2], after[:2]), 0.001)
        driver.stop(signal.SIGKILL)
        robot.moves_on(time.monotonic())

    def test_a_belt_goes_back_too(self):
        driven = self.make_ready("conveyor")
        for _ in range(MOST_BEGUN):  # a stalled machine ends a drive, as it must
            forth = self.trb("drive", "conveyor", "--speeds", "0.2", "--for", "1.5", check=False)
            _, there = driven.at()
            back = self.trb("drive", "conveyor", "--speeds", "-0.1", "--for", "1", check=False)
            way = there[0] - driven.at()[1][0]
            if (forth.returncode, back.returncode) == (0, 0) and abs(way - 0.1) <= 0.05:
                break
        self.assertEqual((forth.returncode, back.returncode), (0, 0), forth.stderr + back.stderr)
        self.assertAlmostEqual(way, 0.1, delta=0.05)

    def test_a_stop_ends_it_and_it_does_not_go_on_after_the_release(self):
        robot, driver = self.begin("pioneer")
        self.trb("stop", "pioneer")
        driver.child.wait(60)
        self.assertNotEqual(driver.child.returncode, 0)
        refused = self.trb("drive", "pioneer", "--speeds", "0.2", check=False)
        self.assertIn("trb release pioneer", refused.stdout + refused.stderr)
        self.trb("release", "pioneer")
        robot.moves_on(time.monotonic())

    def test_what_nobody_confirmed_in_time_is_not_done_later(self):
        """The robot's PC stalls: whoever releases it is told that there was no answer, and counts on the fence."""
        name = "pioneer"
        self.make_ready(name)
        self.trb("stop", name)
        self.addCleanup(self.trb, "release", name)
        for service in ("mode-adapter", "router"):
            pid = self.fleet.pid(name, service)
            os.kill(pid, signal.SIGSTOP)
            late = self.trb("release", name, "--timeout", "2", check=False)
            os.kill(pid, signal.SIGCONT)
            self.assertNotEqual(late.returncode, 0, f"{service}: {late.stdout}")
            self.fleet.wait("its node answers again", lambda: self.control(name) is not None, 60)

            def is_fenced():
                # In the moment behind the stall a speed may be as old as that, and is refused for its age.
                drive = self.trb("drive", name, "--part", MAKERS[name].part, "--speeds", ",".join(map(str, MAKERS[name].speeds)),
                                 "--for", "0.1", "--take", check=False)
                self.assertNotEqual(drive.returncode, 0, service)
                return "was stopped" in drive.stderr
            self.fleet.wait(f"the fence stands behind the stall of its {service}", is_fenced, 60)

    def test_what_cannot_be_driven_says_so(self):
        for words, wanted in (
            (("drive", "pioneer", "--part", "tool", "--speeds", "0.1"), "use one of: base"),
            (("drive", "pioneer", "--speeds", "0.1,0,0"), "'base' has 2 axes"),
            (("drive", "pioneer", "--speeds", "0.1,nan"), "is no number"),
            (("drive", "pioneer"), "--speeds"),
            (("drive", "pioneer", "--speeds", "0.1", "--part", "leg"), "base, joints, tool or belt"),
            (("drive", "pioneer", "--speeds", "0.1", "--for", "9999"), "from 0.1 to 3600"),
        ):
            with self.subTest(words=words):
                done = self.trb(*words, check=False)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(wanted, done.stdout + done.stderr)

    def test_bases_with_ros_were_driven_too(self):
        if NOT_THERE:
            self.skipTest(f"the bases with ROS are left out: {', '.join(NOT_THERE)} not there")
        self.assertIn("turtlebot", MAKERS)

    def test_the_fleet_knows_what_can_be_driven(self):
        routes = self.fleet.json("route", "list", node="cloud")["routes"]
        drives = {route["id"]: route["profile"]["drives"] for route in routes}
        self.assertEqual(json.dumps(drives["conveyor"]), json.dumps([{"part": "belt", "axes": ["x"], "limits": [0.5]}]))
        self.assertEqual([drive["part"] for drive in drives["ur3"]], ["joints", "tool"])


if __name__ == "__main__":
    support.main()
