"""A robot of each maker that a person can drive, what it needs before it moves, and where it is by its own console: what the
tests share that measure how long a robot still moves once nobody drives it."""
import importlib.util
import math
import time

import support

ROS_MODULES = ("rosmaster", "geometry_msgs", "nav_msgs")
ROS_PROGRAMS = ("trb-ros-bridge", "trb-ros-worker", "trb-virtual-ros-robot")
NOT_THERE = [name for name in ROS_MODULES if importlib.util.find_spec(name) is None] + [
    name for name in ROS_PROGRAMS if not (support.PROGRAMS / name).exists()]
STILL_M = 0.002  # or rad: less is no motion
STILL_S = 0.4  # a robot that has not moved for so long stands
STEADY_S = 0.3  # a robot that has moved at a speed for so long has that speed
SAMPLE_S = 0.005
STANDS_S = 0.5  # so long after the last message at most; the node orders it after 0.25 s
MARGIN_S = 0.35  # of this machine, where the robot itself or a new process decides when it stands


class Maker:
    """A robot, how it is driven here, and how long it may move on when its node's process dies."""

    def __init__(self, framework, description, arguments, part, speeds, dies_s, pick=slice(0, 2), unit="m"):
        self.robot = (framework, description, arguments)
        self.part, self.speeds, self.pick, self.unit, self.dies_s = part, speeds, pick, unit, dies_s
        self.speed = math.hypot(*speeds)


MAKERS = {
    # E_STOP brakes with 1.5 m/s^2. Killed: the new process's STOP with 0.3 m/s^2, or before it the robot's own watchdog
    # of 2 s.
    "pioneer": Maker("pioneer", "pioneer", ["--pose", "1,3,0"], "base", [0.3, 0], 2 + 1),
    # A speed counts for 0.4 s on the arm itself.
    "ur3": Maker("ur", "ur3", [], "joints", [0.3], 0.4 + 0.08, slice(0, 1), "rad"),
    "conveyor": Maker("plc", "conveyor", [], "belt", [0.1], 0.4, slice(0, 1)),
    # It brakes with 2 m/s^2 once it hovers; killed, its own watchdog of 2 s lets it hover.
    "drone": Maker("ardrone", "drone", [], "base", [0.4, 0], 2 + 0.2, slice(0, 3)),
}
if not NOT_THERE:
    # Both bases have a time-out of their own for cmd_vel.
    MAKERS["turtlebot"] = Maker("ros", "turtlebot", ["--pose", "3,3,0"], "base", [0.3, 0], 0.5)
    MAKERS["ridgeback"] = Maker("ridgeback", "ridgeback", ["--arm", "--pose", "0,0,0"], "base", [0, 0.3], 0.5)
# The other part of a robot that has two: its tool, straight up.
PARTS = {name: (name, maker) for name, maker in MAKERS.items()}
PARTS["ur3 tool"] = ("ur3", Maker("ur", "ur3", [], "tool", [0, 0, 0.05], 0.4 + 0.08, slice(6, 9)))


class Robot:
    """A virtual robot, asked where it is by its own console: no part of the tested way."""

    def __init__(self, fleet, name, maker=None):
        self.fleet, self.name, self.maker = fleet, name, maker or MAKERS[name]

    @property
    def console(self):
        return self.fleet.virtual[self.name]

    def make_ready(self, cloud):
        """As a person would first do it: in the air, bent, with a box."""
        if self.name == "conveyor":
            for line in ("take", "box"):
                self.console.say(line)
        if self.name == "ur3":
            self.fleet.trb("send", self.name, "command", "move", "[0.4, -1.1, 1.3, -1.77, -1.57, 0]", "--take", node=cloud)
            self.fleet.wait("the arm is bent", lambda: abs(self.at(slice(2, 3))[1][0] - 1.3) < 0.001, 60)
        if self.name == "drone" and self.at(slice(2, 3))[1][0] < 0.7:
            self.fleet.trb("send", self.name, "command", "take_off", "--take", node=cloud)
            self.fleet.wait("the drone is in the air", lambda: self.at(slice(2, 3))[1][0] > 0.79, 60)

    def where(self):
        """(when, all numbers)"""
        self.console.pump(0)
        start = len(self.console.lines)
        self.console.say("where")
        line, _ = self.console.wait_line("where ", 60, start)
        return time.monotonic(), [float(word) for word in line.split()[1:]]

    def at(self, pick=None):
        when, numbers = self.where()
        return when, numbers[pick or self.maker.pick]

    def pass_time(self, seconds):
        """Keeps every process's output flowing meanwhile."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.fleet.pump()
            self.console.pump(min(left, 0.02))

    def speed(self, seconds, pick=None):
        before, start = self.at(pick)
        self.pass_time(seconds)
        after, now = self.at(pick)
        return math.dist(now, start) / (after - before)

    def moves_at(self, speed, pick=None):
        """Its ramp is over: it has moved at that speed for a while."""
        return abs(self.speed(STEADY_S, pick) - speed) < 0.08 * speed

    def wait_speed(self, timeout=15):
        self.fleet.wait(f"{self.name} moves at {self.maker.speed} {self.maker.unit}/s",
                        lambda: self.moves_at(self.maker.speed, self.maker.pick), timeout)

    def moves_on(self, since, timeout=12):
        """How long after `since` it still moved."""
        moved, place = self.at()
        while True:
            now, there = self.at()
            if math.dist(there, place) > STILL_M:
                moved, place = now, there
            if now - moved > STILL_S:
                return max(moved - since, 0)
            if now - since > timeout:
                raise TimeoutError(f"{self.name} still moves {timeout} s later")
            self.pass_time(SAMPLE_S)
