"""The demonstration's fleet for rounds of faults: any of its processes can be killed, and whatever ends is started again as
its machine would start it; every word of the virtual robots is kept, over their restarts."""
import json
import os
import pathlib
import re
import signal
import socket
import time

import fleet_cost
import sensor_side
import trb_fleet
from trb_fleet import CLOUD

# The policy takes whatever is best; a person is asked for what only a person can say.
POLICY = {"policy": {"mode": "automatic"}}
SENSOR_NODE = "conveyor"
TEMPERATURE = 15.0
RESTART_S = 0.5  # until whoever looks after a supervisor or a robot has started it again
WHOLE_S = 30.0
CHARGE_S = 10.0
WITH_BATTERY = ("drone", "ridgeback", "turtlebot", "pioneer1", "pioneer2")
SUPERVISOR, ROBOT, SENSOR_BUS = "trb up", "virtual robot", "sensor-bus"
# What a robot says for each command that it takes. The other ones' words do not tell their skills apart.
COMMANDED = {
    "ridgeback": {r"goal (\S+) (\S+) .*": "go_to", r"fetch .*": "fetch", r"load_out": "load_out"},
    "turtlebot": {r"goal (\S+) (\S+) .*": "go_to"},
    "ur3": {r"program \S+ started": "program"},
    "conveyor": {r"belt on .*": "run"},
    "drone": {r"state taking_off": "take_off", r"state landing": "land"},
}
PLACES = json.loads((trb_fleet.REPO / "config" / "places.json").read_text())["places"]


def command_in(robot, line):
    """"go_to ur3_front" out of a robot's own words; None if it was not commanded."""
    for pattern, command in COMMANDED.get(robot, {}).items():
        if match := re.fullmatch(pattern, line):
            return f"{command} {place_at(*map(float, match.groups()))}" if match.groups() else command
    return None


def place_at(x, y):
    return next((name for name, is_at in PLACES.items()
                 if isinstance(is_at, dict) and abs(is_at["x"] - x) + abs(is_at["y"] - y) < 0.02), f"{x} {y}")


def command_of(robot, task):
    """The same for a task of the scenario that the robot does; None if its words do not tell."""
    skill = "program" if robot == "ur3" and task["skill"] in ("pick", "grasp_and_put_down") else task["skill"]
    if skill not in COMMANDED.get(robot, {}).values():
        return None
    return f"go_to {task['data']['place']}" if skill == "go_to" else skill


class FaultFleet(trb_fleet.Fleet):
    def __init__(self, root, programs, **more):
        super().__init__(root, programs, robots=trb_fleet.DEMO_ROBOTS, **more)
        self.side = sensor_side.SensorSide(self, SENSOR_NODE)
        self.heard = {}  # robot: [(its process, lines before the mark)] since the mark
        self.to_start = {}  # what has ended: when it is started again
        self.charged = 0.0
        self.all_labels = ()  # every process that the whole fleet has

    def make(self):
        super().make()
        (self.dir(CLOUD) / "resilience.json").write_text(json.dumps(POLICY) + "\n")

    def start(self):
        super().start()
        self.wait_formed(WHOLE_S)
        self.side.plug_temperature(TEMPERATURE)
        self.wait("the cloud knows the thermometer", self.knows_sensor, WHOLE_S)

    def knows_sensor(self):
        routes = self.ask("route", "list").get("routes", [])
        return any(sensor["state"] == "ok" for route in routes if route["id"] == SENSOR_NODE
                   for sensor in route["profile"]["plugged"])

    def ask(self, *words, node=CLOUD, timeout=20):
        """What `trb … --json` answers; {} while nobody does."""
        done = self.trb(*words, "--json", node=node, check=False, timeout=timeout)
        try:
            return json.loads(done.stdout.splitlines()[-1])
        except (IndexError, ValueError):
            return {}

    def runs(self, node):
        return self.nodes[node].child.poll() is None

    # ---- who can be killed

    def victims(self):
        """label -> pid of every process of the fleet: `NODE PROGRAM`."""
        below, out = fleet_cost.children(), {}
        for node, up in self.nodes.items():
            if not self.runs(node):
                continue
            out[f"{node} {SUPERVISOR}"] = up.child.pid
            todo = list(below.get(up.child.pid, []))
            while todo:
                pid = todo.pop()
                todo += below.get(pid, [])
                if name := program_of(pid):
                    out[f"{node} {name}"] = pid
        for robot, process in self.virtual.items():
            if process.child.poll() is None:
                out[f"{robot} {ROBOT}"] = process.child.pid
        if self.side.service.child.poll() is None:
            out[f"{SENSOR_NODE} {SENSOR_BUS}"] = self.side.service.child.pid
        return out

    def kill(self, label):
        """kill -9; waits for one that is being started again just now."""
        found = {}

        def is_there():
            found.update(self.victims())
            self.tend()
            return label in found
        self.wait(f"{label} runs", is_there, WHOLE_S)
        os.kill(found[label], signal.SIGKILL)
        return found[label]

    # ---- who starts again what has ended

    def tend(self):
        """What `trb up` does not look after: supervisors, the sensor-bus in its hall, and the robots themselves."""
        self.pump()
        if time.monotonic() - self.charged > CHARGE_S:
            self.charge()
        for kind, name, process in self.looked_after():
            if process.child.poll() is None:
                continue
            at = self.to_start.setdefault((kind, name), time.monotonic() + RESTART_S)
            if time.monotonic() >= at:
                del self.to_start[(kind, name)]
                if kind == "robot":
                    while process.pump(0):  # to the end of its words
                        pass
                process.stop()
                self.start_again(kind, name)

    def looked_after(self):
        return [*(("node", name, process) for name, process in self.nodes.items()),
                *(("robot", name, process) for name, process in self.virtual.items()),
                ("sensor-bus", SENSOR_NODE, self.side.service)]

    def start_again(self, kind, name):
        if kind == "robot":
            self.start_robot(name)
            self.heard.setdefault(name, []).append((self.virtual[name], 0))
        elif kind == "sensor-bus":
            self.side.start_service()
        else:
            self.start_supervisor(name)

    # ---- robots

    def mark(self):
        """From here on the robots' words count."""
        self.pump()
        self.heard = {name: [(process, len(process.lines))] for name, process in self.virtual.items()}

    def said(self, robot):
        self.pump()
        return [line for process, at in self.heard[robot] for line in process.lines[at:]]

    def commands(self, robot):
        """The commands that a robot has taken since the mark. That a drone lands without its node is none."""
        out, watchdog = [], False
        for line in self.said(robot):
            watchdog = line == "communication lost" or (watchdog and line != "watchdog off")
            command = command_in(robot, line)
            if command and not (watchdog and command == "land"):
                out.append(command)
        return out

    def tell(self, robot, line):
        """A line for the virtual robot: a fault, or its end. As a datagram: whatever was killed, the robot hears it."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.sendto(line.encode(), (self.robot_address(robot), trb_fleet.CONTROL_PORT))

    def mend_robots(self):
        """The hall's people: no fault, batteries full."""
        for robot in self.robots:
            self.tell(robot, "clear")
        self.tell("ur3", "brake_release")  # an emergency stop takes an arm's power
        self.charge()

    def charge(self):
        """What runs fast empties fast; batteries are not what is tried here."""
        for robot in WITH_BATTERY:
            self.tell(robot, "battery 100")
        self.charged = time.monotonic()

    def ground_drone(self):
        """One that a round left in the air is taken down by hand."""
        words = [line for line in self.virtual["drone"].lines if line.startswith("state ")]
        if words and words[-1] != "state landed":
            self.virtual["drone"].stop(signal.SIGKILL)
            self.start_robot("drone")

    # ---- as it was before

    def why_not_whole(self):
        """Empty if every node knows every other, every robot is connected, the thermometer is told and no alert is open."""
        self.tend()
        missing = sorted(set(self.all_labels) - set(self.victims()))
        if missing:
            return f"not running: {', '.join(missing)}"
        for node in self.node_names:
            if not self.formed(node):
                return f"{node} does not see the whole fleet"
        if not self.knows_sensor():
            return "the cloud does not know the thermometer"
        alerts = self.ask("alert", "list").get("alerts")
        if alerts is None:
            return "the cloud's resilience does not answer"
        return "".join(f"alert {a['id'][:8]} of {a['robot']} is {a['state']} ({a['cause']}: {a['text']})"
                       for a in alerts if a["id"])  # without one: a lesser fault, only shown

    def wait_whole(self, and_then=lambda: None):
        """Seconds until everything is as before; `and_then` is done again and again meanwhile."""
        why = {}

        def whole():
            and_then()
            why["not"] = self.why_not_whole()
            return not why["not"]
        try:
            return self.wait("whole", whole, WHOLE_S)
        except TimeoutError:
            raise TimeoutError(f"the fleet is not as before after {WHOLE_S:.0f} s: {why['not']}") from None


def program_of(pid):
    """"router" of a trb-router; empty for what is no program of the fleet's."""
    try:
        words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
        ended = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1][0] in "ZX"
    except OSError:
        return ""
    name = pathlib.Path(words[0].decode(errors="replace")).name
    return name.removeprefix("trb-") if name.startswith("trb-") and not ended else ""
