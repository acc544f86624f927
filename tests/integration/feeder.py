"""A program that is no part of a node, and feeds a sensor by D-Bus."""
import subprocess

import trb_fleet


class Feeder:
    """A line of shell that emits a value five times a second; $i in it is 1, 2, 3 and so on."""

    def __init__(self, bus, name, value="double:47", more=""):
        emit = f"dbus-send --bus={bus.address} --type=signal /trbots/{name} trbots.{name}.value {value} {more}"
        line = f"i=0; while :; do i=$((i+1)); {emit} 2>/dev/null; sleep 0.2; done"
        self.child = subprocess.Popen(["sh", "-c", line], preexec_fn=trb_fleet.end_with_parent)

    def stop(self):
        self.child.terminate()
        self.child.wait()
