"""How many messages a robot's question to a sensor takes (Equation 10): two nodes, virtual robots, a D-Bus each."""
import unittest

from support import PROGRAMS, main, make_fleet
from feeder import Feeder
from sensor_dbus import start_bus
import trb_fleet


class RobotFleet(trb_fleet.Fleet):
    """Robots on the field channel, each node with a sensor-bus and a D-Bus of its own."""

    buses = {}

    def node_json(self, node):
        json_of = super().node_json(node)
        return {**json_of, "services": [*json_of["services"], "sensor-bus"], "dbus": self.buses[node].address}


class Robots(unittest.TestCase):
    """A robot sends over its field channel a request whose subtype is the sensor's name."""

    @classmethod
    def setUpClass(cls):
        robots = {name: trb_fleet.ROBOTS[name] for name in ("pioneer1", "pioneer2")}
        RobotFleet.buses = cls.buses = {}
        for node in robots:
            start_bus(cls, node)
        cls.fleet = make_fleet(cls, RobotFleet, block=166, udp_port=50166, robots=robots, cloud=False)
        cls.fleet.start()
        cls.fleet.wait("the fleet forms", lambda: all(cls.fleet.formed(node) for node in robots), 60)

    def said(self, subtype):
        """The messages from robots to their adapters."""
        total = 0
        for node in self.fleet.node_names:
            rows = self.fleet.json("service", "counters", "mode-adapter", node=node)["values"]
            total += sum(int(row["value"]) for row in rows if row["name"] == f"from_robot.{subtype}")
        return total

    def taps(self):
        taps = []
        for node in self.fleet.node_names:
            command = [PROGRAMS / "trb", "tap", "--all", "--node", self.fleet.dir(node)]
            taps.append(trb_fleet.Process(command, self.fleet.root / f"tap-{node}.log"))
            self.addCleanup(taps[-1].stop)
            taps[-1].wait_line("service_alive", 60)  # it receives everything from here on
        return taps

    def link_messages(self, taps, subtype):
        """The messages between the nodes: "> information NAME"."""
        for tap in taps:
            tap.wait_line("service_alive", 60, len(tap.lines))  # earlier messages have come by then
        return sum(f"> {kind} {subtype} " in line for tap in taps for line in tap.lines for kind in ("request", "information"))

    def ask(self, target):
        """pioneer1 asks; the answer, and the messages between robots and nodes, and between nodes, that it took."""
        taps = self.taps()
        before = self.said("humidity")
        robot = self.fleet.virtual["pioneer1"]
        robot.pump(0)
        heard = len(robot.lines)
        robot.say(f"say request humidity {target}")
        line, _ = robot.wait_line("message information humidity", 60, heard)
        robots = [line for node in self.fleet.virtual.values() for line in node.lines[heard if node is robot else 0:]]
        to_robots = sum(line.startswith("message ") and "humidity" in line for line in robots)
        return line.split()[-1], self.said("humidity") - before + to_robots, self.link_messages(taps, "humidity")

    def assert_takes(self, target, *counts):
        for _ in range(3):  # a value is waited for 3 s, which a stalled machine uses up
            asked = self.ask(target)
            if asked[0] == "47":
                break
        self.assertEqual(asked, ("47", *counts))

    def feed(self, node):
        feeder = Feeder(self.buses[node], "humidity")
        self.addCleanup(feeder.stop)
        self.fleet.wait("it is listed", lambda: any(
            (row["node"], row["name"]) == (node, "humidity") for row in self.fleet.json("sensor", "list", node="pioneer1")["sensors"]), 60)

    def wait_no_rule(self, node):
        self.fleet.wait("no rule is left", lambda: self.buses[node].rules_but_observer() == [], 60)

    def test_of_its_own_node_it_takes_two_messages_and_of_another_four(self):
        self.feed("pioneer1")
        self.assert_takes("-", 2, 0)
        self.wait_no_rule("pioneer1")
        self.feed("pioneer2")
        self.assert_takes("pioneer2", 2, 2)
        self.wait_no_rule("pioneer2")


if __name__ == "__main__":
    main()
