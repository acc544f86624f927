"""A D-Bus of a node's own, for tests of sensors."""
import re
import subprocess

import private_bus
from support import temporary_folder

OBSERVER = "path_namespace='/trbots'"  # the only permanent rule: it discovers what other programs emit


class Bus(private_bus.PrivateBus):
    """A private D-Bus with queries and signals."""

    def call(self, *arguments, check=True):
        done = subprocess.run(["dbus-send", f"--bus={self.address}", *arguments], capture_output=True, text=True, timeout=60)
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


def start_bus(case, node):
    """A D-Bus of that node's own, until the test class ends; returns its folder."""
    folder = temporary_folder(case)
    case.buses[node] = Bus(folder)
    case.buses[node].start()
    case.addClassCleanup(case.buses[node].stop)
    return folder
