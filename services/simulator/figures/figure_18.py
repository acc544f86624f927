"""Figure 18: the delay of a message by the mode in which its robot is told: ros, direct, field by field."""
import contextlib
import os
import pathlib
import socket
import statistics
import subprocess
import tempfile
import time

import measured
import fields_bench
import roads
import trb_fleet

WARM, MESSAGES, FIELDS, GAPS, TWISTS = 200, 1000, 500, 20, 200
PAPER = (("paper: direct, ros 1.8", 1.8), ("interpreter 10", 10))
ROBOT = "turtlebot"


class RosFleet(roads.Fleet):
    """a: its robot has the field channel; the other's robot is on a ROS master."""

    def __init__(self, root, programs, octet):
        super().__init__(root, programs, octet)
        self.robots = {"a": ("fields", "bench", []), ROBOT: ("ros", "turtlebot", ["--pose", "0,0,0"])}
        self.node_names = list(self.robots)
        self.ros_port = trb_fleet.free_port()

    def make_node(self, node):
        (trb_fleet.Fleet if node == ROBOT else roads.Fleet).make_node(self, node)

    def node_json(self, node):
        if node != ROBOT:
            return super().node_json(node)
        return {**trb_fleet.Fleet.node_json(self, node), "services": ["router", "mode-adapter", "ros-bridge"]}


class RosRoad:
    """From the robot of a, which is this program, to the callback of the virtual ROS robot, which says so by a line."""

    def __init__(self, fleet):
        self.fleet, self.number = fleet, 0
        fleet.make()
        fleet.start_ros_master()
        fleet.start_robot(ROBOT)
        for node in fleet.node_names:
            fleet.start_node(node)
        fleet.nodes["a"].wait_line("ready", 20)
        self.out = socket.create_connection((fleet.address("a"), 40000), 10, (fleet.robot_address("a"), 0))
        self.out.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        fleet.wait_formed(30)

    def one(self):
        """Milliseconds of one message."""
        self.number = self.number % 499 + 1
        x = f"{self.number / 1000:.3f}"
        data = f'{{"linear":{{"x":{x}}},"angular":{{"z":0.5}}}}'.ljust(48)
        robot = self.fleet.virtual[ROBOT]
        robot.pump(0)
        start, began = len(robot.lines), time.perf_counter()
        self.out.sendall(f"command\nmove\n{ROBOT}\n{len(data)}\n{data}\n".encode())
        robot.wait_line(f"twist {x}", 10, start)
        return 1000 * (time.perf_counter() - began)

    def round(self):
        self.one()
        self.fleet.pump()
        return statistics.median(self.one() for _ in range(TWISTS))


def fields_of(driver, fleet, node, messages):
    """One message in flight, read by an idle reader: the mean of a round."""
    def measure():
        result = fields_bench.order(driver, {}, node, messages, 0, 0, window=1)
        if result["lost"] or result["concatenated"]:
            raise RuntimeError(f"{node}: {result['lost']} messages lost, {result['concatenated']} fields concatenated")
        fleet.pump()
        return result["us_a_message"] / 1000
    return measure


def direct_of(road):
    def measure():
        road.order(f"latency {WARM}")
        return road.order(f"latency {MESSAGES}")["median_us"] / 1000
    return measure


def measure(arguments):
    octet = 64 + os.getpid() % 120
    with contextlib.ExitStack() as stack:
        root = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="trb-figure-")))
        (root / "direct").mkdir()
        direct = stack.enter_context(roads.Roads(root / "direct", arguments.programs, octet)).road("sealed")
        ros_fleet = stack.enter_context(RosFleet(root / "ros", arguments.programs, octet + 4))
        ros = RosRoad(ros_fleet)
        fields = stack.enter_context(fields_bench.Fleet(root / "fields", arguments.programs, octet + 5))
        driver = fields_bench.start(root, arguments.programs, fields)
        stack.callback(driver.stop)
        return measured.in_turns({
            "ros": ros.round,
            "direct": direct_of(direct),
            "interpreter, gap of 2 ms": fields_of(driver, fields, "gap", GAPS),
            "interpreter, acknowledged": fields_of(driver, fields, "lines", FIELDS)}, arguments.rounds)


def draw(arguments):
    measured.draw(arguments, 18, "Figure 18: delay by transmission mode, signed and encrypted", measure, PAPER,
                  {"ros": 1.8, "direct": 1.8, "interpreter, gap of 2 ms": 10})
