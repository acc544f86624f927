"""scripts/test-faults: a few rounds of it, and that its rules find what they must."""
import json
import pathlib
import sqlite3
import subprocess
import sys
import unittest

import support
import fault_rules as rules  # from scripts/, which support has made known
from trb_fleet import CLOUD

SEED = 4
BUSY = "^(ridgeback|conveyor|ur3|drone|cloud) "  # the nodes with a task, and the decider
BLOCK = support.take_block(90)
SCENARIO = {"tasks": [{"id": "go", "robot": "ridgeback", "skill": "go_to", "data": {"place": "dock"}},
                      {"id": "pick", "robot": "ur3", "skill": "pick", "data": {"side": "left"}}]}


def task_view(task, robot, state, **more):
    return {"id": task, "robot": robot, "state": state, "moved_from": "", "attempt": 1, "reason": "", **more}


def view_of(*tasks, state="PAUSED", waits_for="a person", decisions=()):
    return {"run": "f00d", "state": state, "waits_for": waits_for, "epoch": 1 + len(decisions), "tasks": list(tasks),
            "decisions": list(decisions)}


class FakeFleet:
    """As much of a fleet as the rules need."""

    node_names = ["ridgeback", "ur3", CLOUD]
    robots = {"ridgeback": None, "ur3": None}

    def __init__(self):
        self.root = support.temporary_folder()
        self.told, self.views = {}, {}

    def dir(self, node):
        return pathlib.Path(self.root, node)

    def commands(self, robot):
        return self.told.get(robot, [])

    def ask(self, *words, node):
        return self.views[node]

    def write_journal(self, node, *rows):
        folder = self.dir(node) / "state"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "journal.db").unlink(missing_ok=True)
        file = sqlite3.connect(folder / "journal.db")
        file.execute("CREATE TABLE records(seq INTEGER PRIMARY KEY, run TEXT, kind TEXT, body BLOB)")
        file.executemany("INSERT INTO records(run, kind, body) VALUES('f00d', ?, ?)", rows)
        file.commit()
        file.close()


class Rules(unittest.TestCase):
    def setUp(self):
        self.fleet = FakeFleet()
        self.begun = view_of(task_view("go", "ridgeback", "FINISHED"), task_view("pick", "ur3", "WAITING", attempt=0))

    def start(self, node, *tasks):
        """Their start records."""
        self.fleet.write_journal(node, *(("journal_start", b"\x94\xa4f00d" + rules.packed(task) + bytes([n]))
                                         for n, task in enumerate(tasks)))

    def too_often(self):
        return rules.commanded_too_often(self.fleet, self.begun, SCENARIO)

    def test_a_second_command_is_seen_at_the_robot(self):
        self.start("ridgeback", "go")
        self.fleet.told = {"ridgeback": ["go_to dock"]}
        self.assertEqual(self.too_often(), [])
        self.fleet.told = {"ridgeback": ["go_to dock", "go_to dock"]}
        self.assertEqual(len(self.too_often()), 1)
        self.fleet.told = {"ridgeback": ["go_to table1"]}
        self.assertEqual(len(self.too_often()), 1)
        self.fleet.told = {"ur3": ["program"]}  # commanded without a start record
        self.assertEqual(len(self.too_often()), 1)

    def test_an_attempt_that_no_decision_allows(self):
        ruling = {"task": "go", "ruling": "retry", "robot": "ridgeback", "attempt": 2}
        ruled = view_of(*self.begun["tasks"], decisions=[{"tasks": [ruling]}])
        for begun, view, faults in ((1, self.begun, 0), (2, self.begun, 1), (2, ruled, 0), (3, ruled, 1)):
            self.start("ridgeback", *["go"] * begun)
            self.assertEqual(len(rules.begun_too_often(self.fleet, view, SCENARIO)), faults)

    def test_a_result_that_is_gone_or_never_came(self):
        self.fleet.write_journal("ridgeback", ("journal_result", b"one"), ("journal_start", b"go"))
        self.fleet.write_journal(CLOUD, ("journal_result", b"one"))
        seen = {"ridgeback": rules.journal(self.fleet, "ridgeback", "f00d")}
        self.assertEqual((rules.lost_records(self.fleet, "f00d", seen), rules.missing_results(self.fleet, "f00d")), ([], []))
        self.fleet.write_journal(CLOUD)
        self.assertEqual(len(rules.missing_results(self.fleet, "f00d")), 1)
        self.fleet.write_journal("ridgeback", ("journal_start", b"go"))
        self.assertEqual(len(rules.lost_records(self.fleet, "f00d", seen)), 1)

    def test_members_that_contradict_the_cloud(self):
        self.fleet.views = {"ridgeback": self.begun, "ur3": {"error": {"code": "unknown_run"}}}
        self.assertEqual(rules.disagreements(self.fleet, "f00d", self.begun), [])
        other = view_of(task_view("go", "ridgeback", "FAILED"), self.begun["tasks"][1])
        self.assertEqual(len(rules.disagreements(self.fleet, "f00d", other)), 1)
        moved = view_of(task_view("go", "ur3", "FINISHED"), self.begun["tasks"][1], decisions=[{"tasks": []}])
        self.fleet.views["ur3"] = moved
        self.assertEqual(len(rules.disagreements(self.fleet, "f00d", moved)), 0)
        self.fleet.views["ur3"] = self.begun
        self.assertEqual(len(rules.disagreements(self.fleet, "f00d", moved)), 2)  # its epoch, and the task's robot

    def test_ends_that_explain_nothing(self):
        alert = {"run": "f00d"}
        self.assertEqual(rules.unexplained(self.begun, [alert]), "")
        self.assertNotEqual(rules.unexplained(self.begun, []), "")
        self.assertNotEqual(rules.unexplained(view_of(waits_for=""), [alert]), "")
        self.assertNotEqual(rules.unexplained(view_of(state="RUNNING"), [alert]), "")
        self.assertEqual(rules.unexplained(view_of(state="RUNNING"), [{**alert, "state": "OPEN"}]), "")
        self.assertNotEqual(rules.unexplained({}, []), "")
        self.assertNotEqual(rules.unexplained(view_of(state="ABORTED"), []), "")
        stuck = task_view("go", "ridgeback", "FAILED", reason="stuck")
        self.assertEqual(rules.unexplained(view_of(stuck, state="ABORTED"), []), "")


class Rounds(unittest.TestCase):
    def test_a_few_rounds(self):
        folder = support.temporary_folder()
        command = [sys.executable, support.REPO / "scripts" / "fault_rounds.py", "--programs", support.PROGRAMS,
                   "--root", folder / "faults", "--json", folder / "faults.json", "--rounds", 5, "--seed", SEED,
                   "--speed", 20, "--who", BUSY, "--block", BLOCK, "--udp-port", 50000 + BLOCK]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=450)
        support.tell(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(support.processes_of(folder / "faults", BLOCK), {})
        tally = json.loads((folder / "faults.json").read_text())["tally"]
        self.assertEqual((tally["rounds"], tally["rounds_with_a_fault"], tally["rounds_broken"]), (5, 2, 0))


if __name__ == "__main__":
    support.main()
