#!/usr/bin/env python3
"""The page in a real browser: starts the demonstration's fleet with a gateway, and stories.mjs beside it.

    tests/browser/run.py [--page DIR] [--pictures DIR]      scripts/test-browser sets all of it up

What only the starter can do for a story (kill the gateway, let a robot fail) is a method of Orders: a line "@[name, words]"
on the stories' standard output asks for it, a line of JSON on their standard input answers.
"""
import argparse
import json
import math
import os
import pathlib
import select
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))
import support  # noqa: E402
import demo_fault  # noqa: E402
import demo_page  # noqa: E402
import gateway_page  # noqa: E402
import judge  # noqa: E402
import sensor_side  # noqa: E402
import skips  # noqa: E402
import trb_fleet  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402

SCENARIO = trb_fleet.REPO / "config/scenarios/paper-temperature.json"
BLOCK = 98
SENSOR_NODE = "conveyor"
REPORTED = "pioneer1"
DEGREES = 15
SPEED = 4
ORDER_S = 60
SOON_S = 3  # a robot that is driven is seen to move within this
MOVES_M = 0.002
LOOK_S = 0.02
STILL_S = 0.4  # a robot that has not moved for so long stands
STORIES_S = 1500


class Orders:
    def __init__(self, fleet):
        self.fleet = fleet
        self.held = []  # services that are silent
        self.plug()

    def plug(self):
        """A thermometer, at the conveyor's PC."""
        self.thermometer = self.fleet.sensor_sides[SENSOR_NODE].plug_temperature(DEGREES)

    def unplug(self):
        if isinstance(self.thermometer, trb_fleet.Process):  # a program that feeds the D-Bus in its place
            self.thermometer.stop()
        else:
            self.thermometer.unplug()
        self.thermometer = None

    def fail_robot(self):
        """The Ridgeback's base stands half way to its next goal."""
        self.fleet.virtual[demo_fault.FAILS].say(f"fail_next_goal {demo_fault.TEXT}")
        return demo_fault.FAILS

    def fault(self, capability):
        """A person reports a fault of a robot that is in no run."""
        self.fleet.trb("robot", "fault", REPORTED, capability, "--text", "a wheel is loose", node=CLOUD)
        return REPORTED

    def repair(self, robot):
        self.fleet.trb("robot", "fault", robot, "--clear", node=CLOUD)
        for word in ("stop", "release"):  # which switches its motors on again
            self.confirmed(word, robot)

    def renew(self, node, days):
        """Its new certificate is valid for so many days; the cloud hands it to the fleet."""
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), node, "--days", str(days), "--via", self.fleet.dir(CLOUD))

    def begin(self, robot, places=("ur3_front", "dock") * 6):
        """A run that drives it to and fro, for half a minute: however long a page takes to be opened."""
        client = gateway_page.client(self.fleet)
        client.sign_in("olga", gateway_page.PASSWORD)
        names = ["there", "again", *(f"leg{i + 1}" for i in range(2, len(places)))]
        tasks = [{"id": name, "robot": robot, "skill": "go_to", "data": {"place": place}} for name, place in zip(names, places)]
        for task, before in zip(tasks[1:], names):
            task["after"] = [before]
        answer = client.ask("POST", "/api/v1/runs", {"scenario": {"name": "there and again", "tasks": tasks}})
        if answer.status >= 300:
            raise RuntimeError(answer.bytes.decode())
        return answer.json["run"]

    def stop_amid(self, robot):
        """A run whose first drive was stopped, before any page has to be opened. A stop that came too late is tried anew."""
        for place in ("ur3_front", "dock", "ur3_front"):
            run = self.begin(robot, (place, place))
            self.await_moving(robot, ORDER_S)
            self.stop(robot)

            def first(run=run):
                return self.view(run)["tasks"][0]
            self.fleet.wait("its first task is over", lambda: first()["state"] in ("RETRIABLE", "FINISHED"), ORDER_S)
            if first()["outcome"] == "interrupted":
                return run
            self.end(run)
            self.release()
        raise RuntimeError(f"{robot} was three times stopped too late")

    def scenario(self):
        return SCENARIO.read_text()

    def await_run(self, run):
        """Its state once it is over."""
        shown = {}

        def is_over():
            shown.update(self.view(run))
            return shown["state"] not in ("", "RUNNING", "PAUSED")
        self.fleet.wait("the run ends", is_over, ORDER_S)
        return shown["state"]

    def view(self, run):
        """Without a state: it could not be asked just now."""
        said = self.fleet.trb("scenario", "watch", run, "--once", "--json", node=CLOUD, check=False).stdout.splitlines()
        shown = json.loads(said[-1]) if said else {}
        return shown if "tasks" in shown else {"state": "", "tasks": [{"state": "", "outcome": ""}]}

    def end(self, run):
        """Unless it is over already."""
        self.fleet.trb("scenario", "abort", run, "--timeout", ORDER_S, node=CLOUD, check=False, timeout=2 * ORDER_S)

    def where(self, robot):
        """(when it was asked, where) by the robot's own console: no part of the page's way."""
        console = self.fleet.virtual[robot]
        start, asked = len(console.lines), time.time()
        console.say("where")
        line, _ = console.wait_line("where ", ORDER_S, start)
        return asked, [float(word) for word in line.split()[1:3]]

    def await_moving(self, robot, seconds=SOON_S):
        """False: it does not, for its drive has ended meanwhile."""
        places = [self.where(robot)[1]]

        def moves():
            """Since the last look: the wait looks every 0.05 s."""
            places.append(self.where(robot)[1])
            return math.dist(*places[-2:]) > MOVES_M
        try:
            return self.fleet.wait(f"{robot} moves", moves, seconds) >= 0
        except TimeoutError:
            return False

    def last_move(self, robot):
        """When it surely still moved, in ms of the clock, told once it has stood for a while: the last look before it was found
        elsewhere. A gap between two looks is nobody's motion. 0: it stood from the first look."""
        start, place = self.where(robot)
        looked, changed, moved = start, start, 0
        while True:
            time.sleep(LOOK_S)  # who looks without a pause takes a core from what is to stop the robot
            now, there = self.where(robot)
            if math.dist(there, place) > MOVES_M:
                moved, changed, place = looked, now, there
            if now - changed > STILL_S:
                return moved * 1000
            if now > start + ORDER_S:
                raise TimeoutError(f"{robot} still moves after {ORDER_S} s")
            looked = now
            self.fleet.pump()

    def stop(self, robot):
        self.confirmed("stop", robot)

    def release(self):
        self.confirmed("release", "--all")

    def confirmed(self, word, robots):
        """Said again until all have confirmed it: one of their processes may not have been let run meanwhile."""
        self.fleet.wait(f"{word} {robots} is confirmed",
                        lambda: self.fleet.trb(word, robots, node=CLOUD, check=False).returncode == 0, ORDER_S)

    def mend(self):
        """What a story that failed may have left: so that the next ones find the fleet as it was."""
        self.let_tables_go()
        self.revive_gateway()
        for run in self.fleet.json("scenario", "list", node=CLOUD)["runs"]:
            self.end(run["run"])
        for robot in (demo_fault.FAILS, REPORTED):
            self.fleet.trb("robot", "fault", robot, "--clear", node=CLOUD, check=False)
        self.release()
        if not self.thermometer:
            self.plug()

    def store(self, name, tasks):
        """A scenario that the gateway keeps."""
        client = gateway_page.client(self.fleet)
        client.sign_in("olga", gateway_page.PASSWORD)
        answer = client.ask("POST", "/api/v1/scenarios", {"name": name, "tasks": tasks})
        if answer.status >= 300:
            raise RuntimeError(answer.bytes.decode())

    def hostile(self, text):
        """Lets everybody who may choose a text say this one; who it was."""
        client = gateway_page.client(self.fleet)
        client.sign_in(text[:64], "a wrong password")  # the audit names who tried
        client.sign_in("olga", gateway_page.PASSWORD)
        task = {"id": text, "robot": text, "skill": text, "data": {text: text}, "when": {"sensor": text, "op": text, "value": text}}
        said = [client.ask("POST", "/api/v1/scenarios", {"name": text, "description": text, "tasks": [task]}),
                client.ask("POST", "/api/v1/robots/kuka1/retired", {"reason": text})]
        for answer in said:
            if answer.status >= 300:
                raise RuntimeError(answer.bytes.decode())
        self.fleet.trb("robot", "fault", "ridgeback", "carry", "--text", text, node=CLOUD)
        side = self.fleet.sensor_sides[SENSOR_NODE]
        if side.hall:
            side.hall.plug_serial(maker=text, model=text, serial=text)
        return "a user, a scenario, two robots, a message" + (", a sensor" if side.hall else "")

    def say(self, text):
        """A message from the cloud."""
        self.fleet.trb("send", "ur3", "command", "say", json.dumps(text), node=CLOUD, check=False)  # which the robot refuses

    def kill_gateway(self):
        """kill -9; its supervisor is held, so that nothing starts it again before revive_gateway."""
        self.fleet.nodes[CLOUD].child.send_signal(signal.SIGSTOP)
        os.kill(self.fleet.pid(CLOUD, "cloud-gateway"), signal.SIGKILL)

    def revive_gateway(self):
        """When it was ready again, in ms of the clock."""
        self.fleet.nodes[CLOUD].child.send_signal(signal.SIGCONT)
        self.fleet.wait("the gateway is ready again", lambda: demo_page.is_ready(self.fleet), ORDER_S)
        return time.time() * 1000

    def hold_tables(self):
        """Who tells the gateway of alerts and runs is silent; the supervisor is held, so that it kills neither for that."""
        self.fleet.nodes[CLOUD].child.send_signal(signal.SIGSTOP)
        for service in ("resilience", "scheduler"):
            program = self.fleet.pid(CLOUD, service)
            os.kill(program, signal.SIGSTOP)
            self.held.append(program)

    def let_tables_go(self):
        while self.held:
            support.send_signal(self.held.pop(), signal.SIGCONT)
        self.fleet.nodes[CLOUD].child.send_signal(signal.SIGCONT)


class Preview:
    """A built page that no gateway has embedded yet: vite serves it under the gateway's policy, and passes on what it asks."""

    def __init__(self, folder, gateway, policy, log, **env):
        self.port = trb_fleet.free_port()
        self.url = f"http://localhost:{self.port}/"
        command = ["node", gateway_page.WEB / "node_modules/vite/bin/vite.js", "preview", "--outDir", folder.resolve(),
                   "--port", str(self.port), "--strictPort"]
        self.log = open(log, "wb")
        self.child = subprocess.Popen(command, cwd=gateway_page.WEB, env=dict(os.environ, TRB_GATEWAY=gateway, TRB_POLICY=policy, **env),
                                      stdout=self.log, stderr=self.log, stdin=subprocess.DEVNULL, preexec_fn=trb_fleet.end_with_parent)
        support.wait_until("the page is served", lambda: trb_fleet.answers(("localhost", self.port)), 60)

    def stop(self):
        self.child.terminate()
        self.child.wait()
        self.log.close()


class Stories:
    """stories.mjs; while it runs, the fleet's output is kept flowing."""

    def __init__(self, fleet, settings):
        self.fleet, self.orders = fleet, Orders(fleet)
        command = ["node", HERE / "stories.mjs", json.dumps(settings)]
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      preexec_fn=trb_fleet.end_with_parent)
        self.rest = b""

    def follow(self):
        """Its exit status."""
        end = time.monotonic() + STORIES_S
        while time.monotonic() < end:
            self.fleet.pump()
            if not select.select([self.child.stdout], [], [], 0.05)[0]:
                continue
            data = os.read(self.child.stdout.fileno(), 65536)
            if not data:
                return self.child.wait()
            *lines, self.rest = (self.rest + data).split(b"\n")
            for line in lines:
                self.hear(line.decode())
        raise TimeoutError(f"the stories took over {STORIES_S} s")

    def hear(self, line):
        if not line.startswith("@"):
            return print(line, flush=True)
        try:
            name, *words = json.loads(line[1:])
            answer = {"value": getattr(self.orders, name)(*words)}
        except (RuntimeError, OSError, ValueError, LookupError, TypeError, subprocess.SubprocessError) as problem:
            answer = {"error": f"{type(problem).__name__}: {problem}"}  # of this story alone: the next ones go on
        self.child.stdin.write((json.dumps(answer) + "\n").encode())
        self.child.stdin.flush()

    def stop(self):
        self.child.terminate()
        self.child.wait()


def parse():
    parser = argparse.ArgumentParser(prog="scripts/test-browser")
    parser.add_argument("--page", type=pathlib.Path, metavar="DIR", help="a built page, instead of the one in the gateway")
    parser.add_argument("--prism", action="store_true", help="with prism between page and gateway: it judges every answer (Node 20)")
    parser.add_argument("--short", action="store_true", help="a phone in the dark and a desk in the light, not all sizes and colours")
    parser.add_argument("--only", default="", metavar="WORDS", help="only stories whose title contains these words")
    parser.add_argument("--pictures", type=pathlib.Path, metavar="DIR", help="keep a picture of every view here")
    return parser.parse_args()


def main():
    arguments = parse()
    if missing := gateway_page.why_not() or (judge.why_not() if arguments.prism else ""):
        skips.leave(missing)
    began = time.monotonic()
    block = support.take_block(BLOCK)
    root = support.temporary_folder()
    with trb_fleet.Fleet(root / "fleet", support.PROGRAMS, block=block, udp_port=50000 + block, robots=demo_fault.ROBOTS,
                         speed=SPEED, gateway_port=trb_fleet.free_port()) as fleet:
        sensor_side.SensorSide(fleet, SENSOR_NODE)
        fleet.make()
        demo_fault.Fault(fleet, "ask", STORIES_S, print).configure()
        fleet.start()
        fleet.wait_formed(60)
        policy = gateway_page.open_to_people(fleet)
        gateway = f"https://localhost:{fleet.gateway_port}"
        prism = judge.Judge(gateway, fleet.dir(CLOUD) / "keys/gateway.crt", root / "prism.log") if arguments.prism else None
        page = arguments.page or (gateway_page.WEB / "dist" if prism else None)
        judged = {"TRB_JUDGE": prism.url} if prism else {}
        preview = Preview(page, gateway, policy, root / "preview.log", **judged) if page else None
        print(f"== the fleet is up after {time.monotonic() - began:.0f} s", flush=True)
        stories = Stories(fleet, {
            "only": arguments.only, "short": arguments.short, "url": preview.url if preview else gateway + "/", "password": gateway_page.PASSWORD,
            "pictures": str(arguments.pictures.resolve()) if arguments.pictures else "", "judged": prism is not None})
        try:
            status = stories.follow()
            verdict = prism.verdict() if prism else 0
            return status or verdict
        finally:
            stories.stop()
            for beside in (preview, prism):
                if beside:
                    beside.stop()


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/test-browser")
