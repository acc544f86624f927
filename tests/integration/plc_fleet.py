"""One node with a conveyor: its virtual PLC, or a device of the test's own in its place."""
import json
import subprocess

import trb_fleet

RUN = {"name": "belt", "tasks": [{"id": "run", "robot": "conveyor", "skill": "run"}]}


class PlcFleet(trb_fleet.Fleet):
    """Its device is on a port of its own: 502 is the superuser's."""

    def __init__(self, root, programs, port=None, framework="plc", block=142):
        super().__init__(root, programs, block=block, robots={"conveyor": (framework, "conveyor", [])}, cloud=False)
        self.port = port
        self.speed = 4.0

    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "commands.json"  # a virtual device answers late on a stalled machine
        path.write_text(path.read_text().replace('"transport": "modbus",', '"transport": "modbus", "timeout_s": 2,'))
        if self.port:
            self.set_port(self.port)

    def set_port(self, port):
        path = self.dir("conveyor") / "commands.json"
        path.write_text(path.read_text().replace('"port": 502', f'"port": {port}'))

    def start_robot(self, node, *more):
        if self.port and node not in self.virtual:
            return  # the test's own device
        self.start_plc("auto")
        self.set_port(self.plc_port)

    def start_plc(self, port):
        command = [self.programs / "trb-virtual-plc", "--address", self.robot_address("conveyor"), "--port", str(port),
                   "--bring-boxes", "--speed", str(self.speed), "--die-with-parent"]
        self.virtual["conveyor"] = trb_fleet.Process(command, self.root / "plc.log", stdin=subprocess.PIPE)
        self.plc_port = int(self.virtual["conveyor"].wait_line("ready", 60)[0].split()[1])

    def profile(self):
        routes = self.json("route", "list", node="conveyor")["routes"]
        return next(route for route in routes if route["id"] == "conveyor")["profile"]

    def wait_robot(self, state, timeout=60):
        return self.wait(f"the robot is {state}", lambda: self.profile()["robot"] == state, timeout)

    def send(self, subtype, *data):
        return self.trb("send", "conveyor", "command", subtype, *data, node="conveyor", check=False)

    def ask(self, name):
        done = self.trb("request", "conveyor", name, node="conveyor", check=False)
        return done.stdout.strip().splitlines()[-1] if done.returncode == 0 else done.stderr

    def counters(self):
        rows = self.json("service", "counters", "mode-adapter", node="conveyor")["values"]
        return {row["name"]: int(row["value"]) for row in rows}

    def submit(self, scenario=RUN):
        path = self.root / "scenario.json"
        path.write_text(json.dumps(scenario))
        return self.json("scenario", "run", path, node="conveyor")["run"]

    def task(self, run):
        done = self.trb("scenario", "watch", run, "--once", "--json", node="conveyor", check=False)
        view = json.loads(done.stdout.splitlines()[-1])
        return view["tasks"][0] if view.get("tasks") else {"state": ""}

    def wait_task(self, run, *states, timeout=60):
        self.wait(f"the task is {states}", lambda: self.task(run)["state"] in states, timeout)
        return self.task(run)

    def wait_idle(self, timeout=60):
        """Waits until the last command's lease is over and any node may command the robot."""
        self.wait("nobody holds the robot", lambda: not self.profile().get("control"), timeout)
