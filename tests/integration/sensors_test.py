"""Sensors over D-Bus: two nodes, each with a real router, a real sensor-bus and a real dbus-daemon of its own."""
import json
import os
import re
import signal
import subprocess
import time
import unittest
import dbus
import dbus.bus
import dbus.lowlevel

from support import PROGRAMS, RouterFleet, main, make_fleet, temporary_folder
import private_bus
import trb_fleet
from fake_devices import Devices
from feeder import Feeder

NODES = ("hall", "office")
RULE = {"match": {"subsystem": "hwmon", "attributes": {"name": "lm75"}}, "read": "attributes",
        "identity": {"property": "ID_SERIAL_SHORT"},
        "sensors": [{"name": "temperature", "kind": "temperature", "unit": "degC", "attribute": "temp?_input",
                     "scale": 0.001, "every_s": 0.2}]}
OBSERVER = "path_namespace='/trbots'"  # the only permanent rule: it discovers what other programs emit


class Bus(private_bus.PrivateBus):
    """A private D-Bus with queries and signals."""

    def call(self, *arguments, check=True):
        done = subprocess.run(["dbus-send", f"--bus={self.address}", *arguments], capture_output=True, text=True, timeout=10)
        if check and done.returncode != 0:
            raise RuntimeError(f"dbus-send {arguments}: {done.stderr}")
        return done.stdout + done.stderr

    def emit(self, name, *values):
        self.call("--type=signal", f"/trbots/{name}", f"trbots.{name}.value", *values)

    def rules(self):
        """Every match rule of every connection that is about sensors."""
        text = self.call("--dest=org.freedesktop.DBus", "--type=method_call", "--print-reply", "/org/freedesktop/DBus",
                         "org.freedesktop.DBus.Debug.Stats.GetAllMatchRules")
        return sorted(rule for rule in re.findall(r'string "(.*)"', text) if "trbots" in rule)

    def rules_but_observer(self):
        return [rule for rule in self.rules() if OBSERVER not in rule]


def huge_signal(address, name, size):
    """More than a command line holds."""
    signal_message = dbus.lowlevel.SignalMessage(f"/trbots/{name}", f"trbots.{name}", "value")
    signal_message.append("x" * size, signature="s")
    connection = dbus.bus.BusConnection(address)
    connection.send_message(signal_message)
    connection.flush()
    connection.close()


class SensorFleet(RouterFleet):
    """Nodes with a sensor-bus, each with a D-Bus and with devices of its own (umockdev's, by its preloaded library)."""

    buses, devices = {}, {}

    def node_json(self, node):
        return {**super().node_json(node), "dbus": self.buses[node].address}

    def make_node(self, node):
        super().make_node(node)
        (self.dir(node) / "sensors").mkdir()
        (self.dir(node) / "sensors" / "chip.json").write_text(json.dumps(RULE))

    def start_node(self, node):
        command = [self.programs / "trb", "up", self.dir(node), "--die-with-parent"]
        self.nodes[node] = trb_fleet.Process(command, self.root / f"up-{node}.log", env={**os.environ, **self.devices[node].env})


def start_bus(case, node):
    """A D-Bus of that node's own, until the test class ends; returns its folder."""
    folder = temporary_folder(case)
    case.buses[node] = Bus(folder)
    case.buses[node].start()
    case.addClassCleanup(case.buses[node].stop)
    return folder


class Sensors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        SensorFleet.buses = cls.buses = {}
        SensorFleet.devices = cls.devices = {}
        for node in NODES:
            folder = start_bus(cls, node)
            cls.devices[node] = Devices(folder / "devices.log")
            cls.addClassCleanup(cls.devices[node].stop)
        cls.fleet = make_fleet(cls, SensorFleet, block=164, udp_port=50164,
                               services={node: ["router", "sensor-bus"] for node in NODES})
        cls.fleet.bring_up(*NODES)
        cls.fleet.wait("the nodes meet", lambda: all(cls.fleet.formed(n) for n in NODES), 60)
        for node in NODES:
            cls.wait_bus(node)

    # ---- views

    @classmethod
    def table(cls, node):
        done = cls.fleet.trb("sensor", "list", "--unknown", "--json", node=node, check=False)
        return json.loads(done.stdout) if done.returncode == 0 else {"bus": done.stdout, "sensors": []}

    @classmethod
    def wait_bus(cls, node, there=True):
        cls.fleet.wait(f"the bus of {node}: {there}", lambda: (cls.table(node)["bus"] == "") == there, 60)

    def listed(self, node="office"):
        """A node's view of the fleet: {(NODE, SENSOR): its row}."""
        rows = self.fleet.json("sensor", "list", node=node)["sensors"]
        return {(row["node"], row["name"]): row for row in rows}

    def wait_listed(self, *key, there=True, node="office"):
        self.fleet.wait(f"{key} listed: {there}", lambda: (key in self.listed(node)) == there, 60)

    def read(self, sensor, *more, node="office", check=True):
        """The reading, or the error."""
        done = self.fleet.trb("sensor", "read", sensor, *more, "--json", node=node, check=False)
        self.assertEqual(done.returncode == 0, check, done.stdout + done.stderr)
        answer = json.loads(done.stdout)
        return answer if check else answer["error"]

    def wait_no_rule(self, node="hall", timeout=60):
        self.fleet.wait("no rule is left", lambda: self.buses[node].rules_but_observer() == [], timeout)

    def wait_rule(self, name, node="hall"):
        self.fleet.wait(f"a rule for {name}",
                        lambda: any(f"trbots.{name}" in rule for rule in self.buses[node].rules_but_observer()), 60)

    def wait_logged(self, text, node="hall"):
        log = self.fleet.dir(node) / "log" / "sensor-bus.log"
        self.fleet.wait(f"{text!r} in {log}", lambda: text in log.read_text(errors="replace"), 60)

    # ---- actions

    def feed(self, name, *more, node="hall"):
        feeder = Feeder(self.buses[node], name, *more)
        self.addCleanup(feeder.stop)
        return feeder

    def plug(self, node, milli_degrees=21500, serial="SN1"):
        self.devices[node].plug("hwmon7", serial, milli_degrees)
        self.addCleanup(self.unplug, node)

    def unplug(self, node):
        """Does nothing if it is not there."""
        self.devices[node].unplug("hwmon7")

    def watch(self, *arguments, node="office"):
        command = [PROGRAMS / "trb", "sensor", "watch", *arguments, "--json", "--node", self.fleet.dir(node)]
        watch = trb_fleet.Process(command, self.fleet.root / "watch.log")
        self.addCleanup(watch.stop, signal.SIGKILL)
        return watch

    # ---- tests

    def test_a_line_of_shell_is_a_sensor_that_a_remote_node_reads_and_no_rule_is_left(self):
        self.wait_no_rule()  # of the test before
        self.assertEqual([OBSERVER in rule for rule in self.buses["hall"].rules()], [True])
        self.feed("humidity", "double:47", "string:percent")
        self.wait_listed("hall", "humidity")
        before = self.buses["hall"].rules()
        for node in NODES:
            reading = self.read("humidity", node=node)
            self.assertEqual((reading["node"], reading["number"], reading["unit"], reading["quality"]),
                             ("hall", 47, "percent", "good"))
        def no_more_rules():  # the answer may be there before its rule is gone
            self.fleet.wait("no rule is left of it", lambda: self.buses["hall"].rules() == before, 60)
        no_more_rules()
        self.assertEqual(self.fleet.json("request", "hall", "humidity", node="office")["data"], "47")
        no_more_rules()

    def test_any_basic_type_or_a_variant_of_it_is_a_value(self):
        for name, value, number in (("whole", "int32:-3", -3), ("wide", "uint64:7", 7), ("yes", "boolean:true", 1),
                                    ("boxed", "variant:double:2.5", 2.5), ("small", "byte:9", 9)):
            feeder = self.feed(name, value)
            self.assertEqual(self.read(name, "--of", "hall")["number"], number)
            feeder.stop()
        self.feed("tag", "string:04A1B2")
        reading = self.read("tag", "--of", "hall")
        self.assertEqual((reading["is_text"], reading["text"]), (True, "04A1B2"))

    def test_a_device_is_told_to_the_fleet_and_its_values_are_signals_that_any_program_hears(self):
        monitor = trb_fleet.Process(["dbus-monitor", "--address", self.buses["hall"].address, "path_namespace='/trbots'"],
                                    self.fleet.root / "monitor.log")
        self.addCleanup(monitor.stop)
        self.plug("hall")
        self.wait_listed("hall", "temperature")
        row = self.listed()["hall", "temperature"]
        self.assertEqual((row["kind"], row["unit"], row["identity"]), ("temperature", "degC", "SN1"))
        routes = {route["id"]: route["profile"] for route in self.fleet.json("route", "list", node="office")["routes"]}
        self.assertIn("temperature", routes["hall"]["capabilities"])
        _, line = monitor.wait_line("interface=trbots.temperature; member=value", 60)
        monitor.wait_line("double 21.5", 60, line)
        monitor.wait_line('string "degC"', 60, line)
        xml = self.buses["hall"].call("--dest=trbots.sensors", "--print-reply", "/trbots/temperature",
                                      "org.freedesktop.DBus.Introspectable.Introspect")
        self.assertIn('interface name="trbots.temperature"', xml)
        self.assertIn('signal name="value"', xml)
        self.assertIn('node name="temperature"', self.buses["hall"].call(
            "--dest=trbots.sensors", "--print-reply", "/trbots", "org.freedesktop.DBus.Introspectable.Introspect"))
        reading = self.read("temperature")
        self.assertEqual((reading["number"], reading["unit"], reading["identity"]), (21.5, "degC", "SN1"))
        self.wait_no_rule()
        # A program cannot send for the device.
        self.buses["hall"].emit("temperature", "double:99")
        self.wait_logged("a program emits trbots.temperature, which is the name of a device")
        self.assertEqual(self.read("temperature")["number"], 21.5)
        self.unplug("hall")
        self.wait_listed("hall", "temperature", there=False)

    def test_a_watch_follows_its_sensor_to_the_node_where_it_is_plugged_in_next(self):
        self.plug("hall", serial="SN7")
        self.wait_listed("hall", "temperature")
        watch = self.watch("temperature", "--every", "0.5")
        watch.wait_line('"node":"hall"', 60)
        self.wait_rule("temperature")
        self.unplug("hall")
        self.wait_no_rule()
        self.plug("office", milli_degrees=30000, serial="SN7")
        line, _ = watch.wait_line('"node":"office"', 60)
        self.assertEqual((json.loads(line)["number"], json.loads(line)["identity"]), (30, "SN7"))

    def test_a_stream_ends_by_itself_when_its_asker_is_killed_and_its_rule_goes(self):
        self.feed("pressure", "double:1013")
        self.wait_listed("hall", "pressure")
        watches = [self.watch("pressure", node=node) for node in NODES]
        for watch in watches:
            watch.wait_line('"number":1013', 60)
        self.assertEqual(len(self.buses["hall"].rules_but_observer()), 1)  # one for all
        for watch in watches:
            watch.stop(signal.SIGKILL)
        self.wait_no_rule()  # its lease of 10 s

    def test_a_watch_that_has_its_values_ends_its_stream_itself(self):
        self.feed("pressure", "double:1013")
        self.wait_listed("hall", "pressure")
        watch = self.watch("pressure", "--every", "0.2", "--count", "3")
        watch.wait_line('"count":3', 60)
        self.wait_no_rule(timeout=8)  # a lease would take longer

    def test_the_bus_is_killed_and_started_again(self):
        self.feed("humidity")
        self.wait_listed("hall", "humidity")
        watch = self.watch("humidity", "--every", "0.2")
        watch.wait_line('"number":47', 60)
        self.buses["hall"].stop(signal.SIGKILL)
        self.wait_bus("hall", there=False)
        error = self.read("humidity", "--timeout", "1", check=False)
        self.assertIn("the D-Bus is not there", error["what"])
        self.buses["hall"].start()
        self.wait_bus("hall")
        self.assertEqual(self.read("humidity")["number"], 47)
        self.wait_rule("humidity")  # the watch goes on
        watch.wait_line('"number":47', 60, len(watch.lines))

    def test_a_bus_that_hangs_holds_up_nobody(self):
        self.feed("fog", node="office")
        self.wait_listed("office", "fog")
        daemon = self.buses["hall"].process.child
        daemon.send_signal(signal.SIGSTOP)
        self.addCleanup(daemon.send_signal, signal.SIGCONT)
        start = time.monotonic()
        self.assertEqual(self.read("fog", node="hall")["number"], 47)
        self.table("hall")
        self.assertLess(time.monotonic() - start, 4)
        self.wait_bus("hall", there=False)
        daemon.send_signal(signal.SIGCONT)
        self.wait_bus("hall")

    def test_the_sensor_bus_is_killed_and_started_again(self):
        self.plug("hall", serial="SN9")
        self.feed("humidity")
        self.wait_listed("hall", "humidity")
        pid = self.fleet.pid("hall", "sensor-bus")
        os.kill(pid, signal.SIGKILL)
        self.fleet.wait("it is started again", lambda: self.fleet.pid("hall", "sensor-bus") not in (None, pid), 60)
        self.wait_bus("hall")
        self.fleet.wait("both are told again", lambda: {("hall", "humidity"), ("hall", "temperature")} <= set(self.listed()), 60)
        self.assertEqual(self.read("humidity")["number"], 47)
        self.assertEqual(self.read("temperature")["number"], 21.5)
        self.wait_no_rule()

    def test_what_is_no_value_is_refused_and_the_next_good_one_taken(self):
        bus = self.buses["hall"]
        watch = self.watch("wind", "--of", "hall", "--every", "0.01")
        self.wait_rule("wind")
        for value in ("array:double:1,2", "double:nan", "objpath:/a", "dict:string:string:a,b"):
            bus.emit("wind", value)
        bus.emit("wind")
        bus.emit("wind", "double:1", "double:2")
        self.wait_logged("unit: is no text of at most 16 bytes")
        bus.call("--type=signal", "/trbots/wind", "trbots.other.value", "double:1")
        self.wait_logged("emit trbots.NAME at /trbots/NAME")
        huge_signal(bus.address, "wind", 10_000_000)
        self.wait_logged("value: 1025 bytes or more")
        bus.emit("wind", "double:8", "string:m/s")
        watch.wait_line('"number":8', 60)
        self.assertEqual(len([line for line in watch.lines if '"number"' in line]), 1)

    def test_no_foreign_name_is_owned_by_the_policy(self):
        def own(name):
            return self.buses["hall"].call("--dest=org.freedesktop.DBus", "--print-reply", "/org/freedesktop/DBus",
                                           "org.freedesktop.DBus.RequestName", f"string:{name}", "uint32:0", check=False)
        self.assertIn("uint32 1", own("trbots.hall_clock"))
        self.assertIn("AccessDenied", own("org.example.trbots"))
        self.assertIn("AccessDenied", own("trbotsx.a"))

    def test_errors_say_what_there_is_and_what_to_do(self):
        self.feed("humidity")
        self.wait_listed("hall", "humidity")
        error = self.read("temprature", check=False)
        self.assertEqual(error["code"], "unknown_target")
        self.assertIn("humidity of hall", error["cure"])
        error = self.read("temprature", "--of", "hall", check=False)
        self.assertEqual(error["code"], "unknown_target")
        self.assertIn("no program told of it in 3 s", error["what"])
        self.assertIn("humidity", error["cure"])
        self.assertEqual(self.read("humidity", "--of", "nobody", check=False)["code"], "unknown_target")


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
        """pioneer1 asks; the messages between robots and nodes, and between nodes, that it took."""
        taps = self.taps()
        before = self.said("humidity")
        robot = self.fleet.virtual["pioneer1"]
        robot.pump(0)
        heard = len(robot.lines)
        robot.say(f"say request humidity {target}")
        line, _ = robot.wait_line("message information humidity", 60, heard)
        self.assertTrue(line.endswith(" 47"), line)
        robots = [line for node in self.fleet.virtual.values() for line in node.lines[heard if node is robot else 0:]]
        to_robots = sum(line.startswith("message ") and "humidity" in line for line in robots)
        return self.said("humidity") - before + to_robots, self.link_messages(taps, "humidity")

    def feed(self, node):
        feeder = Feeder(self.buses[node], "humidity")
        self.addCleanup(feeder.stop)
        self.fleet.wait("it is listed", lambda: any(
            (row["node"], row["name"]) == (node, "humidity") for row in self.fleet.json("sensor", "list", node="pioneer1")["sensors"]), 60)

    def wait_no_rule(self, node):
        self.fleet.wait("no rule is left", lambda: self.buses[node].rules_but_observer() == [], 60)

    def test_of_its_own_node_it_takes_two_messages_and_of_another_four(self):
        self.feed("pioneer1")
        self.assertEqual(self.ask("-"), (2, 0))
        self.wait_no_rule("pioneer1")
        self.feed("pioneer2")
        self.assertEqual(self.ask("pioneer2"), (2, 2))
        self.wait_no_rule("pioneer2")


if __name__ == "__main__":
    main()
