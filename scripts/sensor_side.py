"""A node's sensors on a machine that has none: a D-Bus of its own, and a hall into which devices are plugged."""
import private_bus
import trb_fleet
import udev_hall


class SensorSide:
    """The D-Bus, the hall and the sensor-bus of one node of the fleet, to be named before that is made: `trb up` leaves the
    sensor-bus to it. Where there can be no hall (`no_hall` says why), a program feeds the D-Bus instead."""

    def __init__(self, fleet, node):
        self.fleet, self.node = fleet, node
        self.bus = private_bus.PrivateBus(fleet.root, f"dbus-{node}")
        self.no_hall = udev_hall.why_not()
        self.hall = self.service = self.feeder = None
        fleet.sensor_sides[node] = self

    def start(self):
        self.bus.start()
        if not self.no_hall:
            self.hall = udev_hall.Hall(self.fleet.root)
        self.start_service()

    def start_service(self):
        command = [self.fleet.programs / "trb-sensor-bus", self.fleet.dir(self.node)]
        if self.hall:
            command = self.hall.inside(command)
        self.service = trb_fleet.Process(command, self.fleet.root / f"sensor-bus-{self.node}.log")

    def plug_temperature(self, degrees):
        """A thermometer, in degC."""
        if self.hall:
            return self.hall.plug_temperature(degrees)
        emit = (f"dbus-send --bus={self.bus.address} --type=signal /trbots/temperature trbots.temperature.value "
                f"double:{degrees} string:degC")
        self.feeder = trb_fleet.Process(["/bin/sh", "-c", f"while {emit}; do sleep 1; done"], self.fleet.root / "feeder.log")
        return self.feeder

    def processes(self):
        return [process for process in (self.feeder, self.service, self.bus.process) if process]

    def stop(self):
        for process in (self.feeder, self.service, self.bus):
            if process:
                process.stop()
        if self.hall:
            self.hall.close()
        self.hall = self.service = self.feeder = None
