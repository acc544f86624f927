"""The demonstration's fault: the Ridgeback's base fails on its way to the UR3, and somebody else drives in its place.

What is told here is what the fleet tells: the robot by its own protocol, `trb alert list`, the decision by the run's view,
the messages by `trb tap` at the cloud's router and at the Ridgeback's.
"""
import datetime
import hashlib
import json
import shlex
import time

import trb_fleet
from trb_fleet import CLOUD

FAILS = "ridgeback"
TEXT = "the left drive does not turn"
TASK = "go_to_ur3"
SCENARIO_S = 120  # what the run may take, people apart
LOOK_S = 0.25
VALUES_S = 5  # as long as an answer changes the proposals
ASK_AFTER_S = 8  # the policy gathers for 2 s; after this it is waiting for a person, too
# Not equally charged, so that the nearest is not the best by that alone.
ROBOTS = {
    **trb_fleet.DEMO_ROBOTS,
    "pioneer1": ("pioneer", "pioneer", ["--name", "pioneer1", "--pose", "1,3,0", "--battery", "90"]),
    "pioneer2": ("pioneer-fields", "pioneer-fields", ["--name", "pioneer2", "--pose", "2,3,0", "--battery", "85"]),
    "turtlebot": ("ros", "turtlebot", ["--pose", "3,3,0", "--battery", "30"]),
}
# Words of the fault that go from node to node, and what for. Equation 11 has the first two, once each.
TWO = {"robot_fault": "the faulty robot tells the cloud", "run_decision": "the changed scenario to who takes over"}
MORE = [
    ("robot_fault", "to every other node: anybody may show it, or decide one day"),
    ("run_decision", "to the run's other members: nobody goes on in the old epoch"),
    ("release_tasks", "it is to give back what it has not begun"),
    ("position", "where are you? and the answers"),
    ("battery", "how much charge is left? and the answers"),
    ("decision_journaled", "proofs that the decision is on a member's disk"),
    ("ack", "proofs that release_tasks was taken"),
]


def seconds(later_ns, earlier_ns):
    return round((later_ns - earlier_ns) / 1e9, 3)


def iso(ns):
    return datetime.datetime.fromtimestamp(ns / 1e9, datetime.timezone.utc).isoformat(timespec="milliseconds")


def ns_of(text):
    return int(datetime.datetime.fromisoformat(text.replace("Z", "+00:00")).timestamp() * 1000) * 1_000_000


class Fault:
    """One fault of the Ridgeback's base in one run, from before it until after the run."""

    def __init__(self, fleet, policy, patience_s, say):
        self.fleet, self.policy, self.patience_s, self.say = fleet, policy, patience_s, say
        self.taps = {}
        self.alert = None  # as it is now
        self.offered = None  # as it was shown
        self.told = False
        self.failed_at = self.asked_at = None
        self.look_at = 0.0

    # ---- before the run

    def configure(self):
        """The cloud's node decides by this file. To be called once the fleet is made and not yet started."""
        policy = {"mode": self.policy, **({"conditions": {"max_severity": "CRITICAL"}} if self.policy == "automatic" else {})}
        settings = {
            "_comment": "Figure 8's priorities; what this fleet does without asking.",
            "judgments": [["distance", "battery", 2], ["distance", "availability", 3], ["battery", "availability", 2]],
            "policy": policy, "expires_s": max(60, self.patience_s)}
        (self.fleet.dir(CLOUD) / "resilience.json").write_text(json.dumps(settings, indent=2) + "\n")

    def begin(self):
        """Listens at two routers, and lets the robot fail half way to its next goal."""
        for node in (CLOUD, FAILS):
            command = [self.fleet.programs / "trb", "tap", "--all", "--json", "--node", self.fleet.dir(node)]
            self.taps[node] = trb_fleet.Process(command, self.fleet.root / f"tap-{node}.log")
            self.taps[node].wait_line("{", trb_fleet.LONG_S)
        self.fleet.virtual[FAILS].say(f"fail_next_goal {TEXT}")

    def run_limit_s(self):
        return SCENARIO_S + self.patience_s

    # ---- during the run

    def follow(self):
        """What is new is said; to be called again and again. False: nobody has decided in time."""
        self.pump()
        if not self.failed_at:
            if any(line == f"fault {TEXT}" for line in self.fleet.virtual[FAILS].lines):
                self.failed_at = time.monotonic()
                self.say(f"\n== half way to the UR3 the {FAILS}'s base stands: \"{TEXT}\". Its arm is whole.")
        elif not self.told and time.monotonic() >= self.look_at:
            self.look()
            self.look_at = time.monotonic() + LOOK_S
        if self.told or not self.asked_at or time.monotonic() - self.asked_at < self.patience_s:
            return True
        self.say(f"\n== nobody has decided within {self.patience_s:.0f} s: the run stays PAUSED, and nothing of it is lost")
        return False

    def pump(self):
        for tap in self.taps.values():
            for _ in range(20):
                tap.pump(0)

    def look(self):
        before = self.alert
        alerts = self.fleet.json("alert", "list", "--all", node=CLOUD)["alerts"]
        self.alert = next((alert for alert in alerts if alert["robot"] == FAILS and alert["run"]), None)
        if not self.alert:
            return
        # Who is proposed is asked where it is and how much charge it has; a topic answers with its next message.
        unknown = any("not known" in one["note"] for one in self.alert["proposals"])
        waits = unknown and time.monotonic() - self.failed_at < VALUES_S
        settled = before and before["proposals"] == self.alert["proposals"] and not waits
        if not self.offered and self.alert["state"] == "OPEN" and settled and self.alert["proposals"]:
            self.offer()
        if self.offered and not self.asked_at and self.alert["state"] in ("OPEN", "EXPIRED"):
            waited = time.monotonic() - self.failed_at
            if self.policy == "ask" or waited > ASK_AFTER_S:
                self.ask()
        if self.alert["state"] in ("DECIDED", "CLOSED"):
            if not self.offered:  # it was decided before its proposals were seen twice
                self.offer()
            self.tell_decision()

    def offer(self):
        self.offered = self.alert
        self.say("\n== the cloud's alert: who could take over, best first, and what each criterion gives to the score")
        listed = self.fleet.trb("alert", "list", node=CLOUD).stdout.splitlines() if self.alert["state"] == "OPEN" else []
        for line in listed or proposal_lines(self.alert):
            self.say(("  " + line).rstrip())

    def ask(self):
        self.asked_at = time.monotonic()
        path, best = self.alert["id"][:8], self.alert["proposals"][0]["robot"]
        if self.policy != "ask":
            self.say(f"\n== the policy leaves it to you: {self.alert['policy']}")
        self.say(f"\n== you decide, within {self.patience_s:.0f} s; the robots wait. In another terminal, from this folder:")
        self.say(f"  {self.command()} alert decide {path} --node {shlex.quote(trb_fleet.short(self.fleet.dir(CLOUD)))}")
        others = [one["robot"] for one in self.alert["proposals"][1:] if one["robot"]]
        self.say(f"  that accepts the best, {best}; at its end you may say"
                 + (f" --robot {others[0]} for another one," if others else "")
                 + "\n  or --retry (it works again), --skip (leave these tasks out), --abort (end the run)")

    def command(self):
        return shlex.quote(trb_fleet.short(self.fleet.programs / "trb"))

    def tell_decision(self):
        self.told = True
        if self.alert["state"] == "CLOSED":
            return self.say(f"\n== the alert is closed: {self.alert['waits_for']}")
        who = f"'{self.alert['person']}'" if self.alert["person"] else "the policy"
        self.say(f"\n== {who} has decided ({self.alert['verdict']}); the decision is signed, and epoch {self.alert['epoch']} "
                 "begins:")
        for ruling in self.decision()["tasks"]:
            self.say(f"  {ruling['task']}: " + {"move": f"{FAILS} -> {ruling['robot']}", "retry": "once more",
                                                "skip": "left out"}[ruling["ruling"]])
        self.say()

    def decision(self):
        view = self.fleet.json("scenario", "watch", "--once", node=CLOUD, check=False)
        return next(one for one in view["decisions"] if one["alert"] == self.alert["id"])

    # ---- after the run

    def next_steps(self):
        """What mends the robot: its own fault, then the fleet's word of it."""
        if not self.alert:
            return []
        return ["trb alert list --all", f"trb robot fault {FAILS} --clear",
                f"trb alert decide {self.alert['id'][:8]} --retry"]

    def stop(self):
        for tap in self.taps.values():
            tap.stop()

    def result(self, view):
        """What --json tells under "fault", and who drove in the end."""
        if not self.alert or not self.failed_at:
            raise RuntimeError(f"the {FAILS} did not fail: see {self.fleet.root}/robot-{FAILS}.log")
        shown = self.offered or self.alert
        out = {"robot": FAILS, "policy": self.policy,
               "alert": {key: self.alert[key] for key in ("id", "robot", "capability", "severity", "cause", "text", "state")},
               "proposals": shown["proposals"], "unfit": shown["unfit"]}
        out["alert"]["tasks"] = shown["tasks"]
        decided = [one for one in view["decisions"] if one["alert"] == self.alert["id"]]
        if not decided:
            return out
        decision = decided[-1]
        out["decision"] = {"alert": decision["alert"], "digest": self.digest(), "epoch": decision["epoch"],
                           "by": decision["by"], "decided_by": decision["person"] or "policy", "verdict": self.alert["verdict"],
                           "reason": decision["reason"], "tasks": decision["tasks"]}
        out["times"] = self.times(view, decision)
        return out

    def times(self, view, decision):
        started = next(task["started"] for task in view["tasks"] if task["id"] == TASK)
        fault = self.fault_ns()
        return {"fault": iso(fault), "alert": iso(self.alert["time"]), "decision": iso(decision["time"]),
                "replacement_commanded": iso(started), "fault_to_alert_s": seconds(self.alert["time"], fault),
                "alert_to_decision_s": seconds(decision["time"], self.alert["time"]),
                "decision_to_commanded_s": seconds(started, decision["time"])}

    def fault_ns(self):
        """When the Ridgeback's node heard of it from the robot, by its own log (ms)."""
        log = self.fleet.dir(FAILS) / "log" / "mode-adapter.log"
        line = next(line for line in log.read_text().splitlines() if " robot_fault " in line and TEXT in line)
        return ns_of(line.split()[0])

    def messages(self, node):
        return [json.loads(line) for line in self.taps[node].lines if line.startswith("{")]

    def digest(self):
        """BLAKE2b-256 of what was signed: the next epoch's decision would name it."""
        for message in self.messages(CLOUD):
            if message["subtype"] == "run_decision":
                return hashlib.blake2b(bytes.fromhex(message["body"]["decision"]["payload"]), digest_size=32).hexdigest()
        return ""

    def wire(self, view):
        """Messages of the fault that went from node to node: Equation 11's two, and what is more, each once a node that
        it was for or came from. What was sent once more, because no proof of delivery had come yet, is told apart."""
        taker = next(task["robot"] for task in view["tasks"] if task["id"] == TASK)
        at_cloud, at_robot = self.messages(CLOUD), self.messages(FAILS)
        again = {}

        def nodes(messages, direction, subtype, end):
            ends = [one[end] for one in messages if one["direction"] == direction and one["subtype"] == subtype]
            again[subtype] = again.get(subtype, 0) + len(ends) - len(set(ends))
            return set(ends)

        def faults(messages, direction):  # its target is everybody; nobody is told twice
            return sum((one["direction"], one["subtype"], one["source"]) == (direction, "robot_fault", FAILS) for one in messages)

        told = faults(at_cloud, "<")
        moved = nodes(at_cloud, ">", "run_decision", "target")
        nodes(at_cloud, "=", "run_decision", "target")  # on its way to the own scheduler: only what is sent again is told
        more = {
            "robot_fault": faults(at_robot, ">") - told,
            "run_decision": len(moved - {taker}),
            "release_tasks": len(nodes(at_cloud, ">", "release_tasks", "target")),
            "position": self.values(at_cloud, "position"),
            "battery": self.values(at_cloud, "battery") + self.values(at_cloud, "state_of_charge"),
            "decision_journaled": len(nodes(at_cloud, "<", "decision_journaled", "source")),
            "ack": self.acks(at_cloud),
        }
        return {"equation11": 2, "two": {"robot_fault": told, "run_decision": int(taker in moved)}, "more": more,
                "again": again, "to": taker}

    def values(self, messages, subtype):
        asked = {one["id"] for one in messages if one["direction"] == ">" and one["subtype"] == subtype
                 and one["type"] == "request"}
        return len(asked) + sum(one["direction"] == "<" and one.get("reply_to") in asked for one in messages)

    def acks(self, messages):
        """Of them one: of what was sent again, there may be more."""
        released = {one["id"] for one in messages if one["direction"] == ">" and one["subtype"] == "release_tasks"}
        return int(any(one["direction"] == "<" and one.get("reply_to") in released for one in messages))


def proposal_lines(alert):
    """Of an alert that is decided: `trb alert list` shows only those of open ones."""
    for number, one in enumerate(alert["proposals"], 1):
        parts = [f"{part['criterion']} {part['value']:.4g} {part['unit']}".strip() + f" ({part['contribution']:.3f})"
                 for part in one["parts"]]
        yield f"{number}  {one['robot']}  {one['score']:.3f}  {', '.join(parts)}"


def wire_rows(wire):
    """The table of a fault's messages."""
    rows = [["MESSAGE", "FROM", "TO", "NUMBER", ""]]
    ends = {"robot_fault": (FAILS, CLOUD), "run_decision": (CLOUD, wire["to"])}
    for subtype, what in TWO.items():
        rows.append([subtype, *ends[subtype], wire["two"][subtype], f"Equation 11: {what}"])
    others = {"robot_fault": (FAILS, "others"), "run_decision": (CLOUD, "members"), "release_tasks": (CLOUD, FAILS),
              "decision_journaled": ("members", CLOUD), "ack": (FAILS, CLOUD)}
    for subtype, what in MORE:
        rows.append([subtype, *others.get(subtype, (CLOUD, "candidates, and back")), wire["more"][subtype], "more: " + what])
    for subtype, number in wire["again"].items():
        if number:
            rows.append([subtype, "", "", number, "once more: no proof of delivery had come yet"])
    return rows
