"""A robot of each maker is driven through the gateway, and then something dies: the page, the gateway, the link, the robot's node.
Prints how long each still moves, and how long a word takes from the page to the robot's node and back.

Addresses 127.0.228.x, 127.0.229.x.
"""
import os
import signal
import statistics
import threading
import time

import support
from driven_robots import MAKERS, MARGIN_S, PARTS, STANDS_S, Robot
from gateway_case import CLOUD, WAIT_S, GatewayCase

PERIOD_S = 0.1
MOST_TRIED = 3  # drives, of which the best counts: a stalled machine ends one, as it must, and adds to how long a robot moves
WAYS = ("page", "gateway", "link", "node")


class Page:
    """What the page does while a key is held; it measures as the page does."""

    def __init__(self, case, robot, part, speeds):
        self.live = case.operator.live()
        case.addCleanup(self.die)
        self.robot, self.part, self.speeds = robot, part, list(speeds)
        self.sent, self.trips, self.threads = {}, [], []
        self.silent, self.ends = threading.Event(), threading.Event()
        case.fleet.wait("the robot can be driven (a drone first reports that it is in the air)", self.begins, WAIT_S)
        self.threads = [threading.Thread(target=run, daemon=True) for run in (self.repeat, self.listen)]
        for thread in self.threads:
            thread.start()

    def begins(self):
        self.sequence = 0
        self.say([0] * len(self.speeds), take=True)
        return self.hear()["state"] == "driving"

    def say(self, speeds, **more):
        self.sequence += 1
        self.sent[self.sequence] = time.monotonic()
        self.live.say({"drive": self.robot, "part": self.part, "speeds": speeds, "sequence": self.sequence, **more})

    def repeat(self):
        try:
            while not self.silent.wait(PERIOD_S):
                self.say(self.speeds)
        except OSError:
            pass  # it is dead, or the gateway is

    def hear(self):
        return self.live.until(lambda heard: "drive" in heard)["drive"]

    def listen(self):
        try:
            while True:
                answer = self.hear()
                if answer["state"] == "driving":
                    self.trips.append((time.monotonic() - self.sent[answer["sequence"]], answer["round_trip_s"]))
        except (OSError, EOFError, ValueError, TimeoutError):
            pass

    def fall_silent(self):
        """As one whose machine has lost its network: nobody closes its connection."""
        self.silent.set()

    def die(self):
        self.fall_silent()
        if not self.ends.is_set():
            self.ends.set()
            self.live.abort(*self.threads)


class DeadMan(GatewayCase):
    block, udp_port = 228, 50228
    kinds = {name: maker.robot for name, maker in MAKERS.items()}
    robots = tuple(MAKERS)
    robot = "pioneer"
    speed = 1

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.figures = {name: {} for name in PARTS}

    @classmethod
    def tearDownClass(cls):
        heads = "".join(f"{head:>14}" for head in ("page silent", "gateway -9", "link cut", "node dead"))
        print(f"\nstill moves for (ms), after  {heads}     page - node - page (ms), of it gateway - node")
        for name, row in cls.figures.items():
            cells = "".join(f"{row[way] * 1000:14.0f}" if way in row else f"{'-':>14}" for way in WAYS)
            _, maker = PARTS[name]
            print(f"  {name:12} at {maker.speed:4.2f} {maker.unit + '/s':6}" + cells + f"     {row.get('trips', '-')}")

    def begin(self, name):
        robot = Robot(self.fleet, *PARTS[name])
        robot.make_ready(CLOUD)
        for _ in range(MOST_TRIED):
            page = Page(self, robot.name, robot.maker.part, robot.maker.speeds)
            try:
                robot.wait_speed()
                return robot, page
            except TimeoutError as late:
                page.die()
                problem = late
        raise problem

    def all_online(self):
        rows = self.viewer.ask("GET", "/api/v1/robots").json["items"]
        return len(rows) == len(MAKERS) and all(row["live"] == "live" and row["content"]["connection"] == "ONLINE" for row in rows)

    def keep(self, way, most, end):
        """Of each robot: how long it still moved after the end of its drive, which `end` begins, and ends, and tells."""
        for name, (_, maker) in PARTS.items():
            with self.subTest(name):
                bound = most(maker)
                seconds = end(name)
                for _ in range(MOST_TRIED - 1):
                    seconds = seconds if seconds <= bound else min(seconds, end(name))
                self.figures[name][way] = seconds
                self.assertLessEqual(seconds, bound, f"{name} moved on for {seconds:.2f} s")

    def test_1_the_page_falls_silent(self):
        def end(name):
            robot, page = self.begin(name)
            trips = page.trips[:]
            page.fall_silent()
            seconds = robot.moves_on(time.monotonic())
            page.die()
            whole, of_it = (statistics.median(trip) * 1000 for trip in zip(*trips))
            self.figures[name]["trips"] = f"{whole:.1f}, {of_it:.1f} (median of {len(trips)})"
            return seconds
        self.keep("page", lambda maker: STANDS_S, end)

    def test_2_the_link_is_cut(self):
        router = self.fleet.pid(CLOUD, "router")

        def end(name):
            robot, page = self.begin(name)
            os.kill(router, signal.SIGSTOP)
            try:
                seconds = robot.moves_on(time.monotonic())
            finally:
                page.die()
                os.kill(router, signal.SIGCONT)
            self.fleet.wait("the robots are back", self.all_online, WAIT_S)
            return seconds
        self.keep("link", lambda maker: STANDS_S, end)

    def test_3_the_gateway_is_killed(self):
        def end(name):
            robot, page = self.begin(name)
            os.kill(self.fleet.pid(CLOUD, "cloud-gateway"), signal.SIGKILL)
            seconds = robot.moves_on(time.monotonic())
            page.die()
            self.fleet.wait("another gateway", self.is_ready, WAIT_S)
            self.fleet.wait("the fleet is known", lambda: len(self.viewer.ask(
                "GET", "/api/v1/robots").json["items"]) == len(MAKERS), WAIT_S)
            return seconds
        self.keep("gateway", lambda maker: STANDS_S, end)

    def test_4_the_node_dies(self):
        """Nothing there orders the robot to stand, nor starts anything again: the robot's own watchdog decides."""
        def end(name):
            robot, page = self.begin(name)
            supervisor = self.fleet.nodes[robot.name].child
            supervisor.send_signal(signal.SIGSTOP)
            try:
                os.kill(self.fleet.pid(robot.name, "mode-adapter"), signal.SIGKILL)
                seconds = robot.moves_on(time.monotonic())
            finally:
                page.die()
                supervisor.send_signal(signal.SIGCONT)
            self.fleet.wait("the robots are back", self.all_online, WAIT_S)
            return seconds
        self.keep("node", lambda maker: maker.dies_s + MARGIN_S, end)


if __name__ == "__main__":
    support.main()
