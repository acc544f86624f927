"""What both compositions are asked: rights, health, runs, docker kill; and the report of it."""
import json
import pathlib
import subprocess
import time

from trb_process import wait_until

DEPLOY = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "compose"
LONG_S = 120  # a deadline, not a measurement
ENDED = ("FINISHED", "FAILED", "ABORTED", "EXPIRED")


class Report:
    def __init__(self):
        self.faults, self.notes, self.times = [], {}, []

    def say(self, text):
        print(text, flush=True)

    def check(self, holds, text):
        if not holds:
            self.faults.append(text)
            self.say(f"FAULT {text}")
        return holds


def until(condition, timeout=LONG_S, step=0.3):
    """Seconds until it held; None: it has not in time."""
    return wait_until(condition, timeout, step)


# ---- what holds of each container

def check_rights(report, composition):
    """By the kernel's word on its first process: no root, no capability, nothing more to gain, a root that is not written to."""
    for service in composition.names:
        proc = pathlib.Path(f"/proc/{composition.pid(service)}")
        status = dict(line.split(":\t", 1) for line in (proc / "status").read_text().splitlines() if ":\t" in line)
        report.check(status["Uid"].split()[0] != "0", f"{service} runs as root")
        for kind in ("CapEff", "CapPrm", "CapBnd", "CapInh", "CapAmb"):
            report.check(int(status[kind], 16) == 0, f"{service} has capabilities: {kind} {status[kind]}")
        report.check(status["NoNewPrivs"] == "1", f"{service} may gain rights")
        root = next(line.split() for line in (proc / "mountinfo").read_text().splitlines() if line.split()[4] == "/")
        report.check("ro" in root[5].split(","), f"{service}'s root can be written to: {root[5]}")


def health(composition, service):
    return composition.engine.inspect(composition.names[service])["State"].get("Health", {}).get("Status", "")


# ---- runs

def submit(composition, service, scenario, folder):
    """The scenario's file goes by the node's own folder: the images have no shell to write it with."""
    text = scenario.read_text() if isinstance(scenario, pathlib.Path) else json.dumps(scenario)
    path = folder / "scenario.json"
    path.write_text(text)
    path.chmod(0o644)
    answer = composition.json(service, "scenario", "run", "/node/scenario.json")
    if "run" not in answer:
        raise RuntimeError(f"scenario run at {service}: {answer}")
    return answer["run"]


def view_of(composition, service, run):
    answer = composition.json(service, "scenario", "watch", run, "--once")
    return answer if "tasks" in answer else {"state": "", "tasks": [], "waits_for": ""}


def wait_ended(report, composition, service, run, tasks, what):
    seen = {}

    def ended():
        seen.update(view_of(composition, service, run))
        return seen["state"] in ENDED
    took = until(ended, 240, 1)
    states = {task["id"]: task["state"] for task in seen.get("tasks", [])}
    good = report.check(took is not None and seen["state"] == "FINISHED", f"{what}: the run is {seen.get('state')}, {states}, {seen.get('waits_for')}")
    if tasks:
        report.check(not good or list(states.values()) == ["FINISHED"] * tasks, f"{what}: {states}")
    return took


# ---- kills

def round_of(report, composition, service, is_whole, is_missed, what):
    """docker kill; what is gone is missed; docker start; everything is there again."""
    composition.kill(service)
    until(is_missed, 15)
    began = time.monotonic()
    composition.start(service)
    took = until(is_whole)
    report.times.append(time.monotonic() - began)
    report.check(took is not None, f"{what}: not whole {LONG_S} s after {service} was killed and started")


# ---- folders

def make_nodes(engine, which, root, **env):
    done = subprocess.run([DEPLOY / "make-nodes", which, root], capture_output=True, text=True, env=engine.env(**env))
    if done.returncode != 0:
        raise RuntimeError(f"make-nodes {which}: {done.stderr[-600:]}")
