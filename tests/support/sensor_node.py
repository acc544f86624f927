"""A node with a sensor-bus in a hall where devices are plugged in: for the tests of hot-plugging."""
import json
import os
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

import support  # noqa: E402
import trb_fleet  # noqa: E402
import udev_hall  # noqa: E402
from private_bus import PrivateBus  # noqa: E402

NODE = "cloud"


class HallFleet(support.RouterFleet):
    """With a D-Bus of its own."""

    dbus = None

    def node_json(self, node):
        return {**super().node_json(node), "dbus": self.dbus.address}


class SensorNode:
    """One node: its router as usual, its sensor-bus in the hall. `case` is the test class or case that it ends with."""

    def __init__(self, case, block, udp_port):
        add_cleanup = support.adder_of(case)
        self.dbus = PrivateBus(support.temporary_folder(case))
        self.dbus.start()
        add_cleanup(self.dbus.stop)
        self.fleet = support.make_fleet(case, lambda *where, **more: self.with_bus(HallFleet(*where, **more)),
                                        services={NODE: ["router", "sensor-bus"]}, block=block, udp_port=udp_port)
        self.dir = self.fleet.dir(NODE)
        shutil.copytree(support.REPO / "config" / "sensors", self.dir / "sensors")
        self.hall = udev_hall.Hall(self.fleet.root)
        add_cleanup(self.hall.close)
        up = [support.PROGRAMS / "trb", "up", self.dir, "--without", "sensor-bus", "--die-with-parent"]
        self.up = trb_fleet.Process(up, self.fleet.root / "up.log")
        add_cleanup(self.up.stop)
        self.bus = None
        add_cleanup(self.stop)

    def with_bus(self, fleet):
        fleet.dbus = self.dbus
        return fleet

    def read(self, sensor):
        """One value, requested like from any node of the fleet; with its unit, time and quality."""
        return self.fleet.json("request", NODE, "sensor_read", json.dumps({"sensor": sensor}), node=NODE)["body"]

    def start(self):
        before = len(self.logged("welcomed"))
        command = self.hall.inside([support.PROGRAMS / "trb-sensor-bus", self.dir])
        self.bus = trb_fleet.Process(command, self.fleet.root / "sensor-bus.log")
        self.fleet.wait("the sensor-bus is up", lambda: len(self.logged("welcomed")) > before, 60)

    def stop(self):
        if self.bus:
            self.bus.stop()
        self.bus = None

    def logged(self, event):
        path = self.dir / "log" / "sensor-bus.log"
        lines = path.read_text(errors="replace").splitlines() if path.exists() else []
        return [line for line in lines if f" {event} " in line]

    def table(self, unknown=False):
        asked = '{"unknown":true}' if unknown else "{}"
        return self.fleet.json("request", NODE, "sensor_list", asked, node=NODE)["body"]

    def sensors(self, state=None):
        """name: what the node reports about it."""
        return {each["name"]: each for each in self.table()["sensors"] if state in (None, each["state"])}

    def wait(self, what, holds, timeout=60):
        """Waits until the table of sensors is as given; returns how long it took."""
        last = {}

        def look():
            last["seen"] = self.sensors()
            return holds(last["seen"])

        try:
            return self.fleet.wait(what, look, timeout)
        except TimeoutError as late:
            raise TimeoutError(f"{late}; there is {last['seen']}") from None

    def wait_state(self, name, state, timeout=60):
        return self.wait(f"{name} is {state}", lambda there: there.get(name, {}).get("state") == state, timeout)

    # ---- the process

    def pid(self):
        """The pid of the sensor-bus itself: nsenter has executed it."""
        return self.bus.child.pid

    def figures(self):
        """Its resident memory in kB, its threads and its descriptors."""
        status = dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{self.pid()}/status").read_text().splitlines() if ":" in line)
        return int(status["VmRSS"].split()[0]), int(status["Threads"]), len(os.listdir(f"/proc/{self.pid()}/fd"))


def skip_reason():
    """Why no hall is possible here; empty: it is."""
    return udev_hall.why_not()
