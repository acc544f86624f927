"""A drone's node and the cloud."""
import signal

import trb_fleet


class DroneFleet(trb_fleet.Fleet):
    """A drone's node and the cloud; the drone itself is for the tests to start."""

    def __init__(self, root, programs, block=144):
        super().__init__(root, programs, block=block, robots={"drone": ("ardrone", "drone", [])})

    def start_robot(self, node, *more):
        pass

    def start_drone(self, *more):
        super().start_robot("drone", *more)
        self.virtual["drone"].wait_line("ready", 60)
        return self.virtual["drone"]

    def kill_drone(self):
        self.virtual.pop("drone").stop(signal.SIGKILL)

    def profile(self):
        routes = self.json("route", "list", node="drone")["routes"]
        return next(route for route in routes if route["id"] == "drone")["profile"]

    def wait_robot(self, state, timeout=60):
        return self.wait(f"the drone is {state}", lambda: self.profile()["robot"] == state, timeout)

    def send(self, subtype, data="", *more):
        return self.trb("send", "drone", "command", subtype, data, *more, node="cloud", check=False)

    def ask(self, subtype):
        return self.trb("request", "drone", subtype, "--json", node="cloud", check=False)

    def counters(self):
        rows = self.json("service", "counters", "mode-adapter", node="drone")["values"]
        return {row["name"]: int(row["value"]) for row in rows}
