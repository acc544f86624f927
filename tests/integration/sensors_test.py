"""Sensors over D-Bus: two nodes, each with a real router, a real sensor-bus and a real dbus-daemon of its own."""
import json
import os
import re
import signal
import time
import unittest
import dbus
import dbus.bus
import dbus.lowlevel

from support import PROGRAMS, RouterFleet, main, make_fleet
import trb_fleet
from fake_devices import Devices
from feeder import Feeder
from sensor_dbus import OBSERVER, start_bus

NODES = ("hall", "office")
RULE = {"match": {"subsystem": "hwmon", "attributes": {"name": "lm75"}}, "read": "attributes",
        "identity": {"property": "ID_SERIAL_SHORT"},
        "sensors": [{"name": "temperature", "kind": "temperature", "unit": "degC", "attribute": "temp?_input",
                     "scale": 0.001, "every_s": 0.2}]}


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
        for _ in range(3 if check else 1):  # the next value is waited for 3 s, which a stalled machine uses up
            done = self.fleet.trb("sensor", "read", sensor, *more, "--json", node=node, check=False)
            if done.returncode == 0:
                break
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

    def test_the_unit_of_a_programs_sensor_is_known_once_it_was_read(self):
        self.feed("salinity", "double:3.5", "string:percent")
        self.wait_listed("hall", "salinity")

        def wait_unit(unit):
            line = re.compile(rf"(?m)^hall +salinity +salinity +{unit} +ok ")
            self.fleet.wait(f"its unit is {unit}", lambda: line.search(self.fleet.trb("sensor", "list", node="office").stdout), 60)

        wait_unit("not known")
        self.assertEqual(self.read("salinity")["unit"], "percent")
        wait_unit("percent")

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
        for _ in range(3):
            watch = self.watch("pressure", "--every", "0.2", "--count", "3")
            watch.wait_line('"count":3', 60)
            told = time.monotonic()
            self.wait_no_rule()
            took = time.monotonic() - told
            if took < 8:
                break
        self.assertLess(took, 8, "the lease of 10 s has ended it")

    def test_the_bus_is_killed_and_started_again(self):
        self.feed("humidity")
        self.wait_listed("hall", "humidity")
        watch = self.watch("humidity", "--every", "0.2")
        watch.wait_line('"number":47', 60)
        self.buses["hall"].stop(signal.SIGKILL)
        self.wait_bus("hall", there=False)
        error = self.read("humidity", check=False)
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
        self.assertLess(time.monotonic() - start, 15)  # a call on the bus waits for 25 s
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


if __name__ == "__main__":
    main()
