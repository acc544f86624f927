"""The simulator's world against a fleet of real processes: the same robots, the same scenario, the same times of tasks."""
import collections
import dataclasses
import json
import math
import pathlib
import sys
import threading
import time

REPO = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "services" / "simulator" / "figures")]

import sensor_side  # noqa: E402
import trb_fleet  # noqa: E402
import tapped  # noqa: E402

UPKEEP_WITHIN = 0.02  # of the messages of upkeep, which go by the clock
MAKESPAN_WITHIN = 0.05
TIE_S = 0.1  # two events so close together may come in either order
EARLY_S = 0.05  # an answer may be read at one tap before the first baton is read at another
REST_S = 12  # of the count, behind the last task: a robot is let go after 10 s
SETTLE_S = 5.5  # from the start to the run: what was said while the fleet formed is sealed by then, and is not counted
STROKE_S = 2.5  # between two keep-alives: a count over whole strokes has as many, whenever the links came up
UNTOLD = "robot_state"  # the world's robots have no values to tell
PHASES = ["identification", "devices", "task", "forward", "sensor", "fail", "upkeep"]


@dataclasses.dataclass
class Message:
    at_s: float  # from the first baton on
    subtype: str
    source: str
    target: str


class TimedTaps(tapped.Taps):
    """Every message that leaves a node for another one, with its time."""

    def __init__(self, buses):
        super().__init__(buses)
        self.lock = threading.Lock()
        self.seen = []

    def take(self, frame):
        at = time.monotonic()
        one = tapped.wire.decode(frame)
        with self.lock:
            self.seen.append(Message(at, one.subtype, one.source, one.target))

    def until_now(self):
        with self.lock:
            return list(self.seen)


@dataclasses.dataclass
class Side:
    """One of the two: what was sent, and when each task was begun and done; times from the first baton on."""

    messages: list
    events: list  # (seconds, task, "begin" or "end")
    makespan_s: float

    def from_start(self, until_s):
        """By subtype, what went between computers since the fleet was started."""
        return collections.Counter(one.subtype for one in self.messages if one.at_s <= until_s)

    def run(self, until_s):
        """Of the run alone."""
        return collections.Counter(one.subtype for one in self.messages if -EARLY_S <= one.at_s < until_s - EARLY_S)

    def acquainted(self):
        """Hellos, without those of second connections of pairs that have dialled each other at once."""
        counts = self.from_start(0)
        return counts["hello"] - counts["goodbye"]


def count_until(last_s):
    """How long messages are counted from the first baton on, if the last task is done then."""
    return STROKE_S * math.ceil((last_s + REST_S) / STROKE_S)


def sent_hellos(fleet):
    """By the routers themselves: the first words of one may come before its tap is heard."""
    counters = [fleet.json("service", "counters", "router", node=node)["values"] for node in fleet.node_names]
    return sum(row["value"] for values in counters for row in values if row["name"] == "sent.hello")


def side_of(messages, tasks):
    """`tasks`: (id, begin, end) on the clock of the messages."""
    first = min(one.at_s for one in messages if one.subtype == "baton")
    shifted = [dataclasses.replace(one, at_s=one.at_s - first) for one in messages]
    events = sorted((at - first, task, what) for task, begin, end in tasks for at, what in ((begin, "begin"), (end, "end")))
    return Side(shifted, events, max(at for at, _, _ in events) - min(at for at, _, _ in events))


# ---- the two sides

class Break:
    """A robot that breaks so long after the first baton, by a line to the virtual one. Its node's cloud decides by itself."""

    def __init__(self, robot, after_s):
        self.robot, self.after_s, self.at_s = robot, after_s, None

    def configure(self, fleet):
        (fleet.dir(trb_fleet.CLOUD) / "resilience.json").write_text(json.dumps({"policy": {"mode": "automatic"}}))

    def follow(self, fleet, taps):
        first = next((one.at_s for one in taps.until_now() if one.subtype == "baton"), None)
        if self.at_s is None and first is not None and time.monotonic() >= first + self.after_s:
            self.at_s = time.monotonic() - first
            capabilities = json.loads(fleet.description(self.robot).read_text())["capabilities"]
            for one in capabilities:
                fleet.virtual[self.robot].say(f"fault {one} CRITICAL broken")

    def job(self):
        """For the world, whose times count from the submission: that is some milliseconds earlier."""
        return [{"at": round(self.at_s, 3), "kind": "fail", "node": self.robot}]


class Thermometer:
    """Plugged in at one node's PC before the run; the fleet is not made yet."""

    def __init__(self, fleet, node, degrees):
        self.node, self.degrees = node, degrees
        self.side = sensor_side.SensorSide(fleet, node)

    def plug(self, fleet):
        self.side.plug_temperature(self.degrees)

        def known():
            routes = fleet.json("route", "list", node=trb_fleet.CLOUD)["routes"]
            plugged = next(route for route in routes if route["id"] == self.node)["profile"]["plugged"]
            return any(sensor["kind"] == "temperature" and sensor["state"] == "ok" for sensor in plugged)
        fleet.wait("the cloud knows the thermometer", known, 20)

    def job(self):
        return [{"node": self.node, "name": "temperature", "unit": "degC", "value": self.degrees}]


def run_scenario(fleet, path, timeout, meanwhile):
    """Submits it and waits until it is over. The final view."""
    done = fleet.json("scenario", "run", path, node=trb_fleet.CLOUD)
    over = {}

    def is_over():
        meanwhile()
        over.update(fleet.json("scenario", "watch", done["run"], "--once", node=trb_fleet.CLOUD, check=False))
        return over["state"] not in ("RUNNING", "ACCEPTED", "OPEN")
    fleet.wait("the run ends", is_over, timeout)
    if over["state"] != "FINISHED":
        raise RuntimeError(f"the run is {over['state']}: {over.get('waits_for')}")
    return over


def play_real(fleet, path, fault=None, thermometer=None, timeout=180):
    """Starts the fleet, which is made, runs the scenario, and counts until REST_S behind its last task."""
    taps = TimedTaps(fleet.dir(node) / "bus" for node in fleet.node_names)
    taps.start()
    try:
        fleet.start()
        settled = time.monotonic() + SETTLE_S
        fleet.wait_formed(60)
        formed, hellos = time.monotonic(), sent_hellos(fleet)
        if thermometer:
            thermometer.plug(fleet)
        fleet.wait("the fleet rests", lambda: time.monotonic() > settled, SETTLE_S + 1)
        skew = time.time() - time.monotonic()
        view = run_scenario(fleet, path, timeout, lambda: fault and fault.follow(fleet, taps))
        tasks = [(task["id"], task["started"] / 1e9 - skew, task["ended"] / 1e9 - skew) for task in done_of(view)]
        begun, ended = min(begin for _, begin, _ in tasks), max(end for _, _, end in tasks)
        fleet.wait("the count is over", lambda: time.monotonic() > begun + count_until(ended - begun) + STROKE_S, 60)
    finally:
        taps.end()
    messages = taps.until_now()
    unheard = hellos - sum(one.subtype == "hello" for one in messages)
    return side_of(messages + [Message(formed, "hello", "", "")] * unheard, tasks), view


def done_of(view):
    """Its tasks without those that a condition has left out."""
    return [task for task in view["tasks"] if task["state"] == "FINISHED"]


def play_world(fleet, path, **more):
    """`more`: what `trb simulate` has an option with a file for."""
    trace, options = fleet.root / "trace.jsonl", []
    for name, content in more.items():
        file = fleet.root / f"{name}.json"
        file.write_text(json.dumps(content))
        options += [f"--{name.replace('_', '-')}", file]
    answer = fleet.json("simulate", "--fleet", fleet.root / "nodes", "--scenario", path, *options,
                        "--relays", trb_fleet.CLOUD, "--trace", trace)
    if answer["world"]["state"] != "FINISHED" or answer["world"]["broken"]:
        raise RuntimeError(f"the simulated run: {answer['world']}")
    # A trace tells more than messages.
    lines = [line for line in map(json.loads, trace.read_text().splitlines()) if "subtype" in line]
    messages = [Message(line["at_s"], line["subtype"], line["from"], line["to"]) for line in lines if line["from"] != line["to"]]
    # Beacons are no messages of a link: the taps do not see them.
    messages = [one for one in messages if one.subtype != "beacon"]
    return side_of(messages, [(task["id"], task["begin_s"], task["end_s"]) for task in answer["tasks"] if "end_s" in task])


def times_of(view):
    """How long each task has taken its robot."""
    return {f"task:{task['id']}": max(task["duration_s"], 0.001) for task in done_of(view)}


# ---- the comparison

def by_phase(counts):
    phase_of = tapped.phases()
    out = collections.Counter()
    for subtype, messages in counts.items():
        out[phase_of.get(subtype, "task").replace("updates", "sensor")] += messages
    return out


def close(one, other, within):
    return abs(one - other) <= within * max(one, other)


def phase_rows(real, world, until_s):
    """(phase, real, world, holds) of the run, and who has said Hello to whom before it."""
    counted, simulated = real.run(until_s), world.run(until_s)
    untold = counted.pop(UNTOLD, 0)
    counted, simulated = by_phase(counted), by_phase(simulated)
    rows = [("acquainted", real.acquainted(), world.acquainted(), real.acquainted() == world.acquainted())]
    for phase in PHASES:
        one, other = counted[phase], simulated[phase]
        rows.append((phase, one, other, close(one, other, UPKEEP_WITHIN if phase == "upkeep" else 0)))
    return [*rows, (f"({UNTOLD})", untold, 0, True)]


def turned(real, world):
    """Pairs of events that come the other way round in the world, and no tie in either."""
    at = {(task, what): seconds for seconds, task, what in real.events}
    events = [(seconds, (task, what)) for seconds, task, what in world.events]
    return [(one, other) for i, (first, one) in enumerate(events) for then, other in events[i + 1:]
            if then - first > TIE_S and at[one] - at[other] > TIE_S]


def model_rows(real, terms, until_s):
    """(term, real, model, holds): everything since the fleet's start; what goes by time within 2 %."""
    counted = real.from_start(until_s)
    ends, before = real.acquainted(), real.from_start(0)
    early = before["node_profile"] + before["neighbours"]
    rows = []
    for term in terms:
        name, said = term["term"], term["messages"]
        if name == "beacon":  # no message of a link
            continue
        if name == "values":  # words of the user's
            counted["values"] = sum(counted.pop(word) for word in list(counted) if word not in tapped.phases())
        messages = counted.pop(name, 0)
        # All links come up in a second: a clock may strike once less or more at each end, and a seal may cover several words.
        within = UPKEEP_WITHIN * said + ends / 2 + (early if name == "seal" else 0) if term["by_time"] else 0
        rows.append((name, messages, round(said, 1), abs(messages - said) <= within))
    return rows + [(name, messages, 0, False) for name, messages in sorted(counted.items())]


def model_terms(fleet, path, view, real, until_s):
    """Our own protocol's model for this run: its parameters read off the scenario, but for how the fleet came up."""
    before = real.from_start(0)
    hellos = [one.at_s for one in real.messages if one.subtype == "hello"]
    asked = sum(one.subtype not in tapped.phases() for one in real.messages) // 2
    words = {"robots": len(fleet.robots), "times": fleet.root / "times.json",
             "asked": asked, "states": real.from_start(until_s)[UNTOLD] // len(fleet.robots),
             "crossed": before["goodbye"] // 2, "told": before["node_profile"], "introduced": before["neighbours"],
             "seconds": round(until_s - sum(hellos) / len(hellos), 3)}
    late = [task["id"] for task in json.loads(path.read_text())["tasks"] if "robot" not in task]
    if late:
        words["bound-to"] = ",".join(f"{task['id']}={task['robot']}" for task in view["tasks"] if task["id"] in late)
    options = [word for name, value in words.items() for word in (f"--{name}", value)]
    return fleet.json("model", "--protocol", "talkrobots", "--scenario", path, *options)["terms"]


@dataclasses.dataclass
class Compared:
    name: str
    phases: list
    model: list
    order: list  # pairs of events that are turned round
    makespans: tuple

    def holds(self):
        rows = self.phases + self.model
        return all(row[3] for row in rows) and not self.order and close(*self.makespans, MAKESPAN_WITHIN)

    def as_json(self):
        keys = ("name", "real", "simulated", "holds")
        return {"case": self.name, "holds": self.holds(), "makespan_s": list(self.makespans),
                "turned_round": [[list(one), list(other)] for one, other in self.order],
                "phases": [dict(zip(keys, row)) for row in self.phases],
                "model": [dict(zip(("term", "real", "model", "holds"), row)) for row in self.model]}


def compare(fleet, name, path, fault=None, thermometer=None):
    """`fleet` is made and not started; `path`: the scenario; `fault`: a Break."""
    if fault:
        fault.configure(fleet)
    real, view = play_real(fleet, path, fault, thermometer)
    more = {"faults": fault.job()} if fault else {"sensor_values": thermometer.job()} if thermometer else {}
    world = play_world(fleet, path, times=times_of(view), **more)
    until_s = count_until(max(at for at, _, _ in real.events))
    # The model's robot breaks in a task, this one between two; and it has no tasks that a condition leaves out.
    rows = [] if more else model_rows(real, model_terms(fleet, path, view, real, until_s), until_s)
    makespans = (round(real.makespan_s, 3), round(world.makespan_s, 3))
    return Compared(name, phase_rows(real, world, until_s), rows, turned(real, world), makespans)
