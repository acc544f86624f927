"""What must be so after a round of faults, looked up at the robots, in every node's journal and in every member's view."""
import sqlite3
from collections import Counter

from fault_fleet import command_of
from trb_fleet import CLOUD

OVER = ("FINISHED", "ABORTED", "EXPIRED")
SHOWN = ("FINISHED", "SKIPPED", "FAILED", "RETRIABLE")  # a task's result is held
RESULT, START = "journal_result", "journal_start"


def journal(fleet, node, run):
    """What a node's scheduler has on disk about the run: [(kind, body)]."""
    path = fleet.dir(node) / "state" / "journal.db"
    if not path.exists():
        return []
    file = sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=5)
    try:
        return [tuple(row) for row in file.execute("SELECT kind, body FROM records WHERE run = ? ORDER BY seq", (run,))]
    except sqlite3.OperationalError:  # not yet a table in it
        return []
    finally:
        file.close()


def results(rows):
    return {body for kind, body in rows if kind == RESULT}


def lost_records(fleet, run, seen):
    """`seen`: node -> its journal before something was killed. What was on disk stays there."""
    out = []
    for node, before in seen.items():
        gone = Counter(before) - Counter(journal(fleet, node, run))
        out += [f"{node} had a {kind} on disk that is gone" for kind, _ in gone]
    return out


def missing_results(fleet, run):
    """Results that a node has journaled and the cloud does not have."""
    of_cloud = results(journal(fleet, CLOUD, run))
    out = []
    for node in fleet.node_names:
        missing = results(journal(fleet, node, run)) - of_cloud
        if missing:
            out.append(f"{len(missing)} result(s) of {node} never came to the cloud")
    return out


def members_of(view):
    robots = {task["robot"] for task in view["tasks"]} | {task["moved_from"] for task in view["tasks"]}
    return sorted(robots - {"", CLOUD})


def has_begun(view, node):
    """A robot whose turn has not come has not heard of the run."""
    return any(task["robot"] == node and task["state"] not in ("WAITING", "SKIPPED") for task in view["tasks"])


def disagreements(fleet, run, view):
    """Where a member's view contradicts the cloud's. A member need not know what it has no need of."""
    out = []
    for node in members_of(view):
        other = fleet.ask("scenario", "watch", run, "--once", node=node)
        if "tasks" not in other:
            if has_begun(view, node):
                out.append(f"{node} does not know the run: {other}")
            continue
        if other["epoch"] != view["epoch"]:
            out.append(f"{node} is in epoch {other['epoch']}, the cloud in {view['epoch']}")
        for mine, theirs in zip(view["tasks"], other["tasks"]):
            if theirs["robot"] != mine["robot"]:
                out.append(f"{mine['id']} is {mine['robot']}'s, and for {node} {theirs['robot']}'s")
            elif theirs["state"] in SHOWN and theirs["state"] != mine["state"]:
                out.append(f"{mine['id']} is {mine['state']}, and for {node} {theirs['state']}")
    return out


def starts(fleet, node, run):
    """task -> how many start records its node has: one is written for each attempt, before the command."""
    bodies = [body for kind, body in journal(fleet, node, run) if kind == START]
    return lambda task: sum(packed(task) in body for body in bodies)


def packed(text):
    """A short text as msgpack has it."""
    return bytes([0xA0 + len(text)]) + text.encode()


def begun_too_often(fleet, view, scenario):
    """Tasks that were begun again though no decision says so."""
    begun = [starts(fleet, node, view["run"]) for node in fleet.node_names]
    out = []
    for task in scenario["tasks"]:
        rulings = [r for decision in view["decisions"] for r in decision["tasks"]
                   if r["task"] == task["id"] and r["ruling"] in ("move", "retry")]
        count = sum(node(task["id"]) for node in begun)
        if count > 1 + len(rulings):
            out.append(f"{task['id']} was begun {count} times, with {len(rulings)} decision(s) to")
    return out


def commanded_too_often(fleet, view, scenario):
    """What robots, by their own words, were told to do more often than their nodes have begun it."""
    out = []
    for robot in fleet.robots:
        begun, may = starts(fleet, robot, view["run"]), Counter()
        for task in scenario["tasks"]:
            may[command_of(robot, task)] += begun(task["id"])
        for command, count in Counter(fleet.commands(robot)).items():
            if count > may[command]:
                out.append(f"{robot} was commanded {count} times to {command}, begun {may[command]} times")
    return out


def waits_for_a_person(view, alerts):
    """It says what it waits for, and an alert of it asks somebody."""
    return bool(view.get("waits_for")) and any(a["run"] == view["run"] and a.get("state") == "OPEN" for a in alerts)


def unexplained(view, alerts):
    """Why this is no proper end of a round; empty: it is one."""
    state = view.get("state", "unknown")
    if state == "FINISHED":
        return ""
    if state == "ABORTED":
        failed = [t for t in view["tasks"] if t["state"] in ("FAILED", "RETRIABLE")]
        return "" if any(t["reason"] for t in failed) else "ABORTED, and no task says why"
    # A task whose robot is out of use holds up nothing but what follows it.
    if state == "RUNNING" and waits_for_a_person(view, alerts):
        return ""
    if state != "PAUSED":
        return f"{state}, waiting for {view.get('waits_for') or 'nothing that it names'}"
    if not view["waits_for"]:
        return "PAUSED, and it does not say what it waits for"
    if not any(alert["run"] == view["run"] for alert in alerts):
        return f"PAUSED, waiting for {view['waits_for']}, and no alert tells anybody"
    return ""
