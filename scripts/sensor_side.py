"""A node's sensors on a machine that has none: a D-Bus of its own, and a hall into which devices are plugged."""
import trb_fleet
import udev_hall

# The system bus's rules, and the project's policy.
BUS = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
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
  <policy user="{user}">
    <allow own_prefix="trbots"/>
  </policy>
  <include>{policy}</include>
</busconfig>
"""


class SensorSide:
    """The D-Bus, the hall and the sensor-bus of one node of the fleet, to be named before that is made: `trb up` leaves the
    sensor-bus to it. Where there can be no hall (`no_hall` says why), a program feeds the D-Bus instead."""

    def __init__(self, fleet, node):
        self.fleet, self.node = fleet, node
        self.socket = fleet.root / f"dbus-{node}"
        self.no_hall = udev_hall.why_not()
        self.bus = self.hall = self.service = self.feeder = None
        fleet.sensor_sides[node] = self

    def address(self):
        return f"unix:path={self.socket}"

    def start(self):
        self.start_bus()
        command = [self.fleet.programs / "trb-sensor-bus", self.fleet.dir(self.node)]
        if not self.no_hall:
            self.hall = udev_hall.Hall(self.fleet.root)
            command = self.hall.inside(command)
        self.service = trb_fleet.Process(command, self.fleet.root / f"sensor-bus-{self.node}.log")

    def start_bus(self):
        config = self.fleet.root / f"dbus-{self.node}.conf"
        policy = trb_fleet.REPO / "deploy" / "dbus" / "trbots.conf"
        config.write_text(BUS.format(socket=self.socket, policy=policy, user=trb_fleet.user()))
        self.socket.unlink(missing_ok=True)
        command = ["/usr/bin/dbus-daemon", f"--config-file={config}", "--nofork", "--nosyslog", "--print-address=1"]
        self.bus = trb_fleet.Process(command, self.fleet.root / f"dbus-{self.node}.log")
        self.bus.wait_line("unix:", 10)

    def plug_temperature(self, degrees):
        """A thermometer, in degC."""
        if self.hall:
            return self.hall.plug_temperature(degrees)
        emit = (f"dbus-send --bus={self.address()} --type=signal /trbots/temperature trbots.temperature.value "
                f"double:{degrees} string:degC")
        self.feeder = trb_fleet.Process(["/bin/sh", "-c", f"while {emit}; do sleep 1; done"], self.fleet.root / "feeder.log")
        return self.feeder

    def processes(self):
        return [process for process in (self.feeder, self.service, self.bus) if process]

    def stop(self):
        for process in self.processes():
            process.stop()
        if self.hall:
            self.hall.close()
        self.bus = self.hall = self.service = self.feeder = None
