"""Sensors over D-Bus: two nodes, each with a real router, a real sensor-bus and a real dbus-daemon of its own."""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

from support import PROGRAMS, REPO, RouterFleet, make_fleet
import trb_fleet

CONFIG = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>unix:path={socket}</listen>
  <auth>EXTERNAL</auth>
  <policy context="default">
    <allow user="*"/>
    <deny own="*"/>
    <deny send_type="method_call"/>
    <allow send_type="signal"/>
    <allow send_requested_reply="true" send_type="method_return"/>
    <allow send_requested_reply="true" send_type="error"/>
    <allow receive_type="method_call"/>
    <allow receive_type="method_return"/>
    <allow receive_type="error"/>
    <allow receive_type="signal"/>
    <allow send_destination="org.freedesktop.DBus"/>
  </policy>
  <include>{policy}</include>
</busconfig>
"""
OBSERVER = "path_namespace='/trbots'"  # the one permanent rule: it discovers what other programs feed


class Bus:
    """A private dbus-daemon with the system bus's rules and our policy."""

    def __init__(self, folder):
        self.folder = folder
        self.socket = folder / "bus"
        self.config = folder / "bus.conf"
        self.config.write_text(CONFIG.format(socket=self.socket, policy=REPO / "deploy/dbus/trbots.conf"))
        self.address = f"unix:path={self.socket}"
        self.process = None
        self.start()

    def start(self):
        self.socket.unlink(missing_ok=True)
        command = ["dbus-daemon", f"--config-file={self.config}", "--nofork", "--nosyslog", "--print-address=1"]
        self.process = trb_fleet.Process(command, self.folder / "bus.log")
        self.process.wait_line("unix:", 10)

    def stop(self, how=signal.SIGTERM):
        if self.process:
            self.process.stop(how)
            self.process = None

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


class Feeder:
    """A line of shell that emits a value five times a second."""

    def __init__(self, bus, name, value="double:47", more=""):
        line = f"while :; do dbus-send --bus={bus.address} --type=signal /trbots/{name} trbots.{name}.value {value} {more}; sleep 0.2; done"
        self.child = subprocess.Popen(["sh", "-c", line], preexec_fn=trb_fleet.end_with_parent)

    def stop(self):
        self.child.terminate()
        self.child.wait()


class SensorFleet(RouterFleet):
    """Nodes with a sensor-bus, each with a D-Bus of its own."""

    buses = {}

    def node_json(self, node):
        return {**super().node_json(node), "dbus": self.buses[node].address}


class Sensors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.buses = {}
        for node in ("hall", "office"):
            folder = tempfile.TemporaryDirectory(prefix="trb-bus-")
            cls.addClassCleanup(folder.cleanup)
            cls.buses[node] = Bus(pathlib.Path(folder.name))
            cls.addClassCleanup(cls.buses[node].stop)
        SensorFleet.buses = cls.buses
        cls.fleet = make_fleet(cls, SensorFleet, block=164, udp_port=50164,
                               services={"hall": ["router", "sensor-bus"], "office": ["router", "sensor-bus"]})
        cls.fleet.bring_up("hall", "office")
        cls.fleet.wait("the nodes meet", lambda: all(cls.fleet.formed(n) for n in ("hall", "office")), 15)
        cls.fleet.wait("the buses are there", lambda: not any(cls.bus_fault(n) for n in ("hall", "office")), 10)

    @classmethod
    def table(cls, node):
        done = cls.fleet.trb("request", node, "sensor_list", "--json", node=node, check=False)
        return json.loads(done.stdout)["body"] if done.returncode == 0 else {"bus": done.stdout, "sensors": []}

    @classmethod
    def bus_fault(cls, node):
        return cls.table(node)["bus"]

    def feed(self, name, *more, node="hall"):
        feeder = Feeder(self.buses[node], name, *more)
        self.addCleanup(feeder.stop)
        return feeder

    def read(self, node, sensor, of="hall"):
        """The reading, or the error."""
        done = self.fleet.trb("request", of, "sensor_read", json.dumps({"sensor": sensor}), "--json", node=node, check=False)
        answer = json.loads(done.stdout)
        return answer.get("body", answer.get("error"))

    def test_a_line_of_shell_is_a_sensor_that_a_remote_node_reads_and_no_rule_is_left(self):
        before = self.buses["hall"].rules()
        self.assertEqual(len(before), 1)
        self.feed("humidity", "double:47", "string:percent")
        self.fleet.wait("it is listed", lambda: any(s["name"] == "humidity" for s in self.table("hall")["sensors"]), 5)
        for node in ("hall", "office"):
            reading = self.read(node, "humidity")
            self.assertEqual((reading["number"], reading["unit"], reading["quality"]), (47, "percent", "good"))
        self.assertEqual(self.buses["hall"].rules(), before)


if __name__ == "__main__":
    unittest.main()
