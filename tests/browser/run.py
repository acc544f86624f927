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
STILL_S = 0.4  # a robot that has not moved for so long stands
STORIES_S = 1500


class Orders:
    def __init__(self, fleet):
        self.fleet = fleet
        self.plug()

    def plug(self):
        """A thermometer, at the conveyor's PC."""
        self.thermometer = self.fleet.sensor_sides[SENSOR_NODE].plug_temperature(DEGREES)

    def unplug(self):
        if isinstance(self.thermometer, trb_fleet.Process):  # a program that feeds the D-Bus in its place
            self.thermometer.stop()
        else:
            self.thermometer.unplug()

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
            self.fleet.trb(word, robot, node=CLOUD)

    def renew(self, node, days):
        """Its new certificate is valid for so many days; the cloud hands it to the fleet."""
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), node, "--days", str(days), "--via", self.fleet.dir(CLOUD))

    def scenario(self):
        return SCENARIO.read_text()

    def await_run(self, run):
        """Its state once it is over."""
        def state():
            return self.fleet.json("scenario", "watch", run, "--once", node=CLOUD, check=False)["state"]
        self.fleet.wait("the run ends", lambda: state() not in ("", "RUNNING", "PAUSED"), ORDER_S)
        return state()

    def where(self, robot):
        """(when, where) by the robot's own console: no part of the page's way."""
        console = self.fleet.virtual[robot]
        start = len(console.lines)
        console.say("where")
        line, _ = console.wait_line("where ", 5, start)
        return time.time(), [float(word) for word in line.split()[1:3]]

    def await_moving(self, robot):
        """False: it does not, for its drive has ended meanwhile."""
        places = [self.where(robot)[1]]

        def moves():
            """Since the last look: the wait looks every 0.05 s."""
            places.append(self.where(robot)[1])
            return math.dist(*places[-2:]) > MOVES_M
        try:
            return self.fleet.wait(f"{robot} moves", moves, SOON_S) >= 0
        except TimeoutError:
            return False

    def last_move(self, robot):
        """When it was last seen to move, in ms of the clock: once it has stood for a while. 0: it stood from the first look."""
        start, place = self.where(robot)
        moved, end = 0, start + ORDER_S
        while True:
            now, there = self.where(robot)
            if math.dist(there, place) > MOVES_M:
                moved, place = now, there
            if now - (moved or start) > STILL_S:
                return moved * 1000
            if now > end:
                raise TimeoutError(f"{robot} still moves after {ORDER_S} s")
            self.fleet.pump()

    def release(self):
        self.fleet.trb("release", "--all", node=CLOUD)

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
        self.held = [self.fleet.pid(CLOUD, service) for service in ("resilience", "scheduler")]
        for program in self.held:
            os.kill(program, signal.SIGSTOP)

    def let_tables_go(self):
        for program in self.held:
            os.kill(program, signal.SIGCONT)
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
        except (RuntimeError, TimeoutError) as problem:
            answer = {"error": str(problem)}
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
