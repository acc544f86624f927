"""What scripts/test-upgrade does with the two versions' programs; its figures are in deploy/upgrade/README.md."""
import argparse
import hashlib
import json
import pathlib
import shutil
import sqlite3
import subprocess
import tempfile
import time

import demo_place
import trb_fleet
from trb_fleet import CLOUD, Process, run_main
from upgrade_traffic import Traffic

ROBOTS = ["arm1", "arm2", "arm3"]
TASK_S = 6
TASKS = 18
PATIENCE_S = 120  # a deadline, not a measurement
# A refusal that has nothing to do with versions: what is sent to a robot whose node is away.
HARMLESS = ("refused.peer_unreachable", "refused.unknown_target", "refused.peer_expired", "refused.no_field_channel",
            "refused.robot_offline", "refused.no_service")
# Not history.db: without it the gateway goes on, for the page and its Stop (history_file_test.cpp).
NEWER = {CLOUD: {"capability.db": "trb-resilience", "gateway.db": "trb-cloud-gateway"},
         "arm1": {"journal.db": "trb-scheduler"}}


def say(text):
    print(text, flush=True)


class MixedFleet(trb_fleet.Fleet):
    """Each node runs the programs of its own version; trb, which asks, is the newer one's."""

    def __init__(self, root, old, new, block):
        robots = {name: ("lines", "ridgeback", ["--skill", f"load_out={TASK_S}", "--pose", "0,0,0"]) for name in ROBOTS}
        super().__init__(root, new, block=block, udp_port=50000 + block, robots=robots, gateway_port=trb_fleet.free_port())
        self.old = pathlib.Path(old)
        self.of = dict.fromkeys(self.node_names, self.old)

    def make(self):
        """The folders, keys and certificates are N-1's."""
        new, self.programs = self.programs, self.old
        super().make()
        self.programs = new

    def start_supervisor(self, node):
        self.nodes[node] = Process([self.of[node] / "trb", "up", self.dir(node), "--die-with-parent"],
                                   self.root / f"up-{node}.log")

    def pump(self):
        for process in self.nodes.values():
            process.pump(0)  # the robots' output is the traffic's

    def refused(self, node):
        rows = {row["name"]: row["value"] for row in self.json("service", "counters", "router", node=node)["values"]}
        return {name: value for name, value in rows.items() if name.startswith("refused.") and not name.startswith(HARMLESS)}


class Upgrade:
    def __init__(self, fleet, old, new):
        self.fleet, self.old, self.new = fleet, pathlib.Path(old), pathlib.Path(new)
        self.broken, self.figures = [], {}

    def check(self, what, good):
        say(f"  {'good' if good else 'BROKEN'}: {what}")
        if not good:
            self.broken.append(what)

    # ---- runs

    def submit(self, tasks):
        path = self.fleet.root / "chain.json"
        path.write_text(json.dumps({"name": "chain", "tasks": [
            {"id": f"t{i}", "robot": ROBOTS[i % len(ROBOTS)], "skill": "load_out", **({"after": [f"t{i - 1}"]} if i else {})}
            for i in range(tasks)]}))
        return self.fleet.json("scenario", "run", path, node=CLOUD)["run"]

    def view(self, run):
        return self.fleet.json("run", "show", run, node=CLOUD)

    def wait_over(self, run, seconds):
        self.fleet.wait("the run is over", lambda: self.view(run)["state"] not in ("RUNNING", "WAITING"), seconds)

    def begun(self):
        return sum(line.split()[:2] == ["start", "load_out"] for robot in ROBOTS for line in self.fleet.virtual[robot].lines)

    # ---- the rolling upgrade

    def far_from_its_turn(self, node, run):
        """Another robot works, and this one is not the next."""
        at_work = [task["robot"] for task in self.view(run)["tasks"] if task["state"] == "RUNNING"]
        return node == CLOUD or at_work == [ROBOTS[(ROBOTS.index(node) + 1) % len(ROBOTS)]]

    def replace(self, node, programs, traffic):
        begun = time.monotonic()
        self.check(f"{node}: no link was refused until now: {self.fleet.refused(node)}", not self.fleet.refused(node))
        process = self.fleet.nodes.pop(node)
        process.stop(timeout=PATIENCE_S)
        self.check(f"{node} ends in order", process.child.returncode == 0)
        self.fleet.of[node] = programs
        self.fleet.start_supervisor(node)
        self.fleet.nodes[node].wait_line("ready", PATIENCE_S)
        self.fleet.wait_formed(PATIENCE_S)
        traffic.note_away(node, begun, time.monotonic())
        took = time.monotonic() - begun
        self.figures.setdefault("away_s", {})[node] = round(took, 1)
        say(f"  {node} is of the other version, {took:.1f} s")

    def roll(self):
        say("== upgrade, one node after the other, under a run")
        before = self.begun()
        run = self.submit(TASKS)
        with Traffic(self.fleet, ROBOTS) as traffic:
            for node in [*ROBOTS, CLOUD]:
                self.fleet.wait(f"{node} is not next", lambda n=node: self.far_from_its_turn(n, run), PATIENCE_S)
                self.replace(node, self.new, traffic)
            self.check("the run was under way until the last node", self.view(run)["state"] == "RUNNING")
            self.wait_over(run, TASKS * TASK_S + PATIENCE_S)
        self.check(f"messages went on to the end ({traffic.problem or 'no problem'})", traffic.problem is None)
        for _ in range(20):  # what is under way comes
            traffic.pump()
            self.fleet.wait("an answer", lambda: self.fleet.formed(), PATIENCE_S)
        self.judge(run, traffic, self.begun() - before)

    def judge(self, run, traffic, begun):
        view, tally = self.view(run), traffic.tally()
        self.figures["messages"] = dict(tally)
        say(f"  messages: {dict(tally)}")
        self.check("the run is FINISHED", view["state"] == "FINISHED")
        self.check("every task was begun once", begun == TASKS and all(task["attempt"] == 1 for task in view["tasks"]))
        self.check("no message came twice", tally["twice"] == 0)
        self.check("none was lost but of or to a node that was away", tally["lost"] == 0)
        for node in self.fleet.node_names:
            self.check(f"{node}: no link was refused: {self.fleet.refused(node)}", not self.fleet.refused(node))

    # ---- what N-1 has written

    def read_old_files(self, run):
        say("== what N-1 has written is read")
        for node in self.fleet.node_names:
            shown = self.fleet.json("run", "show", run, node=node, check=False)
            self.check(f"{node}: the run of N-1 is in its archive", shown.get("state") == "FINISHED")
            done = self.fleet.trb("check", self.fleet.dir(node), check=False)
            self.check(f"{node}: trb check", done.returncode == 0)
            proof = self.fleet.trb("proof", self.fleet.dir(node) / "log/proof", "--fleet", self.fleet.authority_dir(), check=False)
            self.check(f"{node}: the proof log", proof.returncode == 0)
        answer = self.fleet.json("robot", "history", "arm1", node=CLOUD, check=False)
        self.check("the capability database's history", "error" not in answer)

    # ---- newer files, and the way back

    def refuse_newer(self):
        say("== files of a later version")
        for node, files in NEWER.items():
            for name, program in files.items():
                for version, programs in (("N-1", self.old), ("N", self.new)):
                    self.refuse(node, name, programs / program, version)

    def refuse(self, node, name, program, version):
        folder = self.fleet.root / "later" / f"{name}-{version}"
        shutil.copytree(self.fleet.dir(node), folder, ignore=shutil.ignore_patterns("bus", "log"))
        path = folder / "state" / name
        with sqlite3.connect(path) as db:
            later = db.execute("PRAGMA user_version").fetchone()[0] + 1
            db.execute(f"PRAGMA user_version = {later}")
        db.close()
        before = hashlib.sha256(path.read_bytes()).hexdigest()
        done = subprocess.run([program, folder], capture_output=True, text=True, timeout=PATIENCE_S)
        said = done.stdout + done.stderr
        self.check(f"{version}: {name} is refused by its version, with what to do",
                   done.returncode == 1 and f"version {later}" in said and "start the build that wrote it" in said)
        self.check(f"{version}: {name} is untouched", hashlib.sha256(path.read_bytes()).hexdigest() == before)

    def go_back(self):
        say("== back to N-1, one node")
        with Traffic(self.fleet, ROBOTS) as traffic:
            self.replace("arm2", self.old, traffic)
            run = self.submit(len(ROBOTS))
            self.wait_over(run, len(ROBOTS) * TASK_S + PATIENCE_S)
        self.check("a run of both versions is FINISHED", self.view(run)["state"] == "FINISHED")
        self.check("no message came twice", traffic.tally()["twice"] == 0)

    def play(self):
        say("== a fleet of N-1")
        self.fleet.make()
        self.fleet.start()
        self.fleet.wait_formed(PATIENCE_S)
        run = self.submit(len(ROBOTS))
        with Traffic(self.fleet, ROBOTS):
            self.wait_over(run, len(ROBOTS) * TASK_S + PATIENCE_S)
        self.roll()
        self.read_old_files(run)
        self.go_back()
        self.fleet.stop()
        self.refuse_newer()


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/test-upgrade", description="A fleet is upgraded node by node.")
    parser.add_argument("--from", help="the commit that is version N-1")
    parser.add_argument("--old", type=pathlib.Path, required=True, help="programs of version N-1")
    parser.add_argument("--new", type=pathlib.Path, required=True, help="programs of this version")
    parser.add_argument("--json", type=pathlib.Path, help="writes the figures there")
    return parser.parse_args()


def main():
    given = arguments()
    held = next(pair for pair in ((demo_place.hold(b), demo_place.hold(b + 1), b) for b in range(41, 59, 2)) if all(pair))
    with tempfile.TemporaryDirectory(prefix="trb-upgrade-") as root, \
            MixedFleet(pathlib.Path(root) / "fleet", given.old, given.new, held[2]) as fleet:
        upgrade = Upgrade(fleet, given.old, given.new)
        upgrade.play()
    if given.json:
        given.json.write_text(json.dumps({"broken": upgrade.broken, **upgrade.figures}, indent=2) + "\n")
    say(f"== {len(upgrade.broken)} broken" + "".join(f"\n   {text}" for text in upgrade.broken))
    return 1 if upgrade.broken else 0


if __name__ == "__main__":
    run_main(main, "scripts/test-upgrade")
