"""scripts/test-faults: rounds of the demonstration's run, a process killed in each, a robot broken in every second one."""
import argparse
import json
import pathlib
import random
import re
import shutil
import statistics
import time

import demo_fleet
import fault_rules as rules
import trb_fleet
from fault_fleet import FaultFleet
from fault_tally import print_tally, say, tally_of, text_of
from trb_fleet import CLOUD

SCENARIO = trb_fleet.REPO / "config" / "scenarios" / "paper-temperature.json"
FAULTS = [("ridgeback", "mobile"), ("ridgeback", "carry"), ("ur3", "grab"), ("drone", "fly"), ("conveyor", "convey")]
SEVERITIES = ("CRITICAL", "CRITICAL", "FATAL")
SETTLED_S = 6.5  # a run that shows the same for so long waits for somebody; the policy decides within 5 s
TIMEOUT_S = 20.0  # of each task: the robots are faster than real, and so is what finds a silent one
STUCK_S = 45.0  # a run that says RUNNING, and nothing happens: longer than any time-out
AGREE_S = 20.0
WORDS = 4  # how often a person says "try again" in a round


class Round:
    """One run with what happens to it; what it has come to is in `row`."""

    def __init__(self, fleet, number, plan):
        self.fleet, self.plan = fleet, plan
        self.scenario = json.loads(SCENARIO.read_text())
        for task in self.scenario["tasks"]:
            task["timeout_s"] = TIMEOUT_S
        self.row = {"round": number, **plan, "broken": []}
        self.before_kill = {}

    # ---- what happens

    def play(self):
        self.fleet.mark()
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps(self.scenario))
        self.run = self.fleet.json("scenario", "run", path, node=CLOUD)["run"]
        self.row["run"] = self.run
        self.began = time.monotonic()
        todo = sorted((self.plan[key]["at_s"], key) for key in ("kill", "fault") if self.plan[key])
        view, alerts = self.settle(todo)
        self.row.update(state=view.get("state", "unknown"), waits_for=view.get("waits_for", ""),
                        run_s=round(time.monotonic() - self.began, 2), epoch=view.get("epoch", 0),
                        alerts=[f"{a['robot']} {a['capability'] or 'whole'} {a['state']} {a['cause']}, {a['policy']}"
                                for a in alerts if a["run"] == self.run])
        self.judge(view, alerts)

    def do(self, what):
        if what == "kill":
            self.before_kill = {node: rules.journal(self.fleet, node, self.run) for node in self.fleet.node_names}
            self.fleet.kill(self.plan["kill"]["who"])
        else:
            fault = self.plan["fault"]
            self.fleet.tell(fault["robot"], f"fault {fault['capability']} {fault['severity']} broken by the round")

    def settle(self, todo=()):
        """Lets everything in `todo` happen and waits until the run is over, or shows the same for long. (view, alerts)"""
        todo, seen, since = list(todo), None, time.monotonic()
        while True:
            self.fleet.tend()
            now = time.monotonic()
            if todo and now - self.began >= todo[0][0]:
                self.do(todo.pop(0)[1])
                since = time.monotonic()
            view, alerts = self.look()
            shown = {**view, "left_s": 0}, [(a["id"], a["state"], a["verdict"], a["epoch"]) for a in alerts]
            if shown != seen:
                seen, since = shown, time.monotonic()
            if not todo and view and self.has_settled(view, alerts, time.monotonic() - since):
                return view, alerts
            if time.monotonic() - since > 2 * STUCK_S:
                return view, alerts
            time.sleep(0.05)

    def look(self):
        if not self.fleet.runs(CLOUD):
            return {}, []
        view = self.fleet.ask("scenario", "watch", self.run, "--once")
        alerts = [a for a in self.fleet.ask("alert", "list").get("alerts", []) if a["id"]]
        return (view if "tasks" in view else {}), alerts

    @staticmethod
    def has_settled(view, alerts, for_s):
        if view["state"] in rules.OVER:
            return True
        under_way = any(a["state"] == "RELEASING" and not a["needs_word"] for a in alerts)
        asked = view["state"] == "PAUSED" or rules.waits_for_a_person(view, alerts)
        return for_s > (SETTLED_S if asked and not under_way else STUCK_S)

    # ---- what has come of it

    def judge(self, view, alerts):
        broken = self.row["broken"]
        if why := rules.unexplained(view, alerts):
            broken.append(f"end: {why}")
        if not view:
            return
        broken += [f"twice: {text}" for text in rules.commanded_too_often(self.fleet, view, self.scenario)]
        broken += [f"twice: {text}" for text in rules.begun_too_often(self.fleet, view, self.scenario)]
        broken += [f"lost: {text}" for text in rules.lost_records(self.fleet, self.run, self.before_kill)]
        broken += [f"lost: {text}" for text in self.patiently(lambda: rules.missing_results(self.fleet, self.run))]
        broken += [f"apart: {text}" for text in self.patiently(lambda: self.disagreements())]

    def disagreements(self):
        view, _ = self.look()
        return rules.disagreements(self.fleet, self.run, view) if view else ["the cloud does not answer"]

    def patiently(self, problems):
        """What is still wrong when everything has had the time to get about."""
        end = time.monotonic() + AGREE_S
        while True:
            found = problems()
            if not found or time.monotonic() > end:
                return found
            self.fleet.tend()
            time.sleep(0.1)

    # ---- a person comes

    def mend(self):
        """Robots are mended, and whoever is asked says: try again, it stands. A run that is not over then is aborted."""
        for word in range(WORDS + 1):
            view, alerts = self.look()
            if view and view["state"] in rules.OVER:
                break
            if word == WORDS:
                self.fleet.trb("scenario", "abort", self.run, "--timeout", "10", node=CLOUD, check=False)
            else:
                self.fleet.mend_robots()
                self.say_retry(alerts)
                self.settle()
        view, alerts = self.look()
        self.row["after_words"] = view.get("state", "unknown")
        if self.row["after_words"] != "FINISHED":
            self.row["broken"].append(f"word: {WORDS} times 'try again' did not end it; now it is {self.row['after_words']}")
        self.judge(view, alerts)

    def say_retry(self, alerts):
        for alert in alerts:
            self.fleet.trb("alert", "decide", alert["id"], "--retry", "--stands", "--person", "rounds", node=CLOUD,
                           check=False)

    def say_mended(self):
        """A fault stands for the fleet until somebody says that it is over: of what is decided or closed, too."""
        alerts = self.fleet.ask("alert", "list", "--all").get("alerts", [])
        self.say_retry([a for a in alerts if a["run"] == self.run])

    def heal(self):
        """All as before, for the next round; how long that took."""
        self.fleet.mend_robots()
        self.fleet.ground_drone()
        try:
            self.row["healed_s"] = round(self.fleet.wait_whole(lambda: self.say_retry(self.look()[1])), 2)
            self.say_mended()
        except TimeoutError as problem:
            self.row["broken"].append(f"heal: {problem}")


# ---- many of them

def planned(rng, with_fault, labels, usual_s, within_s):
    fault = None
    if with_fault:
        robot, capability = rng.choice(FAULTS)
        fault = {"robot": robot, "capability": capability, "severity": rng.choice(SEVERITIES),
                 "at_s": round(rng.uniform(0, usual_s), 2)}
    return {"kill": {"who": rng.choice(labels), "at_s": round(rng.uniform(0, within_s), 2)}, "fault": fault}


def usual_length(fleet):
    """Of the run when nothing happens: the second and third time, as the robots stand elsewhere at the first."""
    times = []
    for number in range(3):
        one = Round(fleet, number, {"kill": None, "fault": None})
        one.play()
        if one.row["state"] != "FINISHED" or one.row["broken"]:
            raise RuntimeError(f"a run to which nothing happens: {one.row}")
        times.append(one.row["run_s"])
        one.heal()
    return statistics.mean(times[1:])


def keep_evidence(fleet, one, folder):
    """Logs, journals and words of a round that broke a rule."""
    folder = folder / f"round-{one.row['round']:03d}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for node in fleet.node_names:
        for sub in ("log", "state"):
            shutil.copytree(fleet.dir(node) / sub, folder / node / sub, ignore=shutil.ignore_patterns("proof*"))
    for path in fleet.root.glob("*.log"):
        shutil.copy(path, folder)
    views = {node: fleet.ask("scenario", "watch", one.row.get("run", ""), "--once", node=node)
             for node in fleet.node_names}
    more = {"round": one.row, "views": views, "alerts": fleet.ask("alert", "list", "--all"),
            "said": {robot: fleet.said(robot) for robot in fleet.robots}}
    (folder / "round.json").write_text(json.dumps(more, indent=2) + "\n")
    say(f"           evidence: {folder}")


def play_round(fleet, number, plan, evidence):
    one = Round(fleet, number, plan)
    try:
        one.play()
        if one.row["state"] not in rules.OVER:
            one.mend()
        one.heal()
    except (RuntimeError, TimeoutError, OSError) as problem:
        one.row["broken"].append(f"script: {type(problem).__name__}: {problem}")
    say(text_of(one.row))
    if one.row["broken"] or one.row.get("run_s", 0) > STUCK_S:
        keep_evidence(fleet, one, evidence)
    return one.row


def build(arguments, root):
    fleet = FaultFleet(root, arguments.programs, block=arguments.block, udp_port=arguments.udp_port, speed=arguments.speed,
                       name="faults")
    fleet.make()
    fleet.start()
    fleet.all_labels = sorted(fleet.victims())
    return fleet


def play_all(arguments, root):
    rng, rows, fleet = random.Random(arguments.seed), [], None
    usual_s = 0.0
    try:
        fleet = build(arguments, root / "fleet")
        usual_s = usual_length(fleet)
        labels = [label for label in fleet.all_labels if re.search(arguments.who, label)]
        if not labels:
            raise RuntimeError(f"--who {arguments.who}: none of {', '.join(fleet.all_labels)}")
        say(f"== seed {arguments.seed}: one of {len(labels)} processes in each round, within "
            f"{arguments.within or usual_s:.2f} s of a run that usually takes {usual_s:.2f} s")
        for number in range(1, arguments.rounds + 1):
            plan = planned(rng, number % arguments.fault_every == 0, labels, usual_s, arguments.within or usual_s)
            if arguments.only and number not in arguments.only:
                continue
            rows.append(play_round(fleet, number, plan, root / "evidence"))
            if any(text.startswith(("heal", "script")) for text in rows[-1]["broken"]):
                say("           the fleet is built anew")
                fleet.stop()
                fleet = build(arguments, root / "fleet")
    finally:
        if fleet:
            fleet.stop()
    return rows, tally_of(rows, usual_s)


def parse():
    parser = argparse.ArgumentParser(
        prog="scripts/test-faults",
        description="Runs the demonstration's scenario again and again on a fleet of ten nodes. In each round a random "
        "process is killed (kill -9) at a random moment, in every second one a robot fails as well. No task may be commanded "
        "twice, no result be lost, all members must agree, and each run must be FINISHED, ABORTED with its reason, or PAUSED "
        "with an alert and what it waits for. Exit 1 if a round breaks one of these rules.",
        epilog="examples:  scripts/test-faults      scripts/test-faults --rounds 10 --seed 7 --json faults.json      "
        "scripts/test-faults --only 37 (that round again)      "
        "scripts/test-faults --who '^cloud (router|scheduler|resilience)' --within 8 --fault-every 1")
    parser.add_argument("--rounds", type=int, default=100, help="how many (100)")
    parser.add_argument("--seed", type=int, default=1, help="what happens in each round follows from it (1)")
    parser.add_argument("--only", type=int, action="append", metavar="N",
                        help="of these rounds only this one; repeated: several")
    parser.add_argument("--who", default="", metavar="PATTERN",
                        help="kill only processes that match, as 'NODE router', 'NODE trb up', 'NODE virtual robot' (all)")
    parser.add_argument("--within", type=float, metavar="S", help="kill within the first S seconds (the usual run's length)")
    parser.add_argument("--fault-every", type=int, default=2, metavar="N", help="a robot fails in every Nth round (2)")
    parser.add_argument("--json", metavar="FILE", help="write the rounds and the tally")
    parser.add_argument("--speed", type=float, default=10.0, help="how much faster than real the robots move (10)")
    parser.add_argument("--programs", metavar="DIR", default=trb_fleet.REPO / "build/release/bin",
                        help="the built programs (build/release/bin)")
    parser.add_argument("--root", default=trb_fleet.REPO / ".faults",
                        help="where the fleet and the evidence of broken rounds are kept (.faults)")
    parser.add_argument("--block", type=int, default=3, help=argparse.SUPPRESS)
    parser.add_argument("--udp-port", type=int, default=50003, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.rounds < 1 or arguments.fault_every < 1 or not 0 < arguments.speed <= 100:
        parser.error("--rounds and --fault-every: at least 1; --speed: between 0 and 100")
    return arguments


def main():
    arguments = parse()
    root, lock = demo_fleet.take_root(arguments.root)
    rows, tally = play_all(arguments, root)
    print_tally(tally)
    if arguments.json:
        told = {"seed": arguments.seed, "tally": tally, "rounds": rows}
        pathlib.Path(arguments.json).write_text(json.dumps(told, indent=2) + "\n")
    lock.close()
    return 1 if tally["rounds_broken"] else 0


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/test-faults")
