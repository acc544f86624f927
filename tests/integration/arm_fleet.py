"""A fleet of one arm and the cloud, for the tests of the arms' transports."""
import json
import os
import pathlib
import signal
import socket
import subprocess

import support
import trb_fleet

CLOUD = trb_fleet.CLOUD
PROGRAM = {"kuka": "trb-virtual-kuka", "abb": "trb-virtual-abb"}


class ArmFleet(trb_fleet.Fleet):
    """The robot is named after its framework; its commands.json may be changed before the node starts."""

    def __init__(self, root, programs, framework, block, **more):
        super().__init__(root, programs, block=block, udp_port=50000 + block, name="arms",
                         robots={framework: (framework, framework, [])}, **more)
        self.arm = framework

    def start_robot(self, node, *more):
        command = [self.programs / PROGRAM[self.arm], "--address", self.robot_address(node), "--die-with-parent",
                   "--speed", str(self.speed), *more]
        self.virtual[node] = trb_fleet.Process(command, self.root / f"robot-{node}.log", stdin=subprocess.PIPE)
        self.virtual[node].wait_line("ready", 60)

    @property
    def robot(self):
        return self.virtual[self.arm]

    def restart_robot(self):
        self.start_robot(self.arm)
        self.wait_formed(60)


class ArmTest:
    """A mixin with what both arms' tests share. FRAMEWORK and BLOCK select the arm; BEGUN is what the virtual robot prints when it
    begins a long motion; LOST and SILENT are what the fleet is told when the robot ends in the middle of it, and when it hangs."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, ArmFleet, framework=cls.FRAMEWORK, block=cls.BLOCK)
        cls.fleet.start()
        cls.fleet.wait_formed(60)

    def setUp(self):
        """Brings the robot back: there, free and at home, whatever the last test has left."""
        if self.fleet.arm not in self.fleet.virtual:
            self.fleet.restart_robot()
        self.fleet.robot.child.send_signal(signal.SIGCONT)
        self.fleet.robot.say("clear")
        self.fleet.wait_formed(60)
        self.fleet.trb("release", self.arm, node=CLOUD)
        self.start = len(self.fleet.robot.lines)

    @property
    def arm(self):
        return self.fleet.arm

    def said(self, wanted, timeout=60):
        """A line that the virtual robot prints in this test. A run may wait 10 s for the last holder's lease."""
        line, _ = self.fleet.robot.wait_line(wanted, timeout, self.start)
        return line

    def ask(self, *arguments):
        done = self.fleet.trb(*arguments, "--json", node=CLOUD, check=False)
        self.fleet.pump()
        return json.loads(done.stdout.splitlines()[-1])

    def send(self, subtype, data="", *options):
        """The answer to a command: its state, or (code, what, cure)."""
        answer = self.ask("send", self.arm, "command", subtype, *([data] if data else []), "--take", *options)
        return answer["error"] if "error" in answer else answer["body"]["state"]

    def refusal(self, subtype, data="", *options):
        answer = self.send(subtype, data, *options)
        self.assertIsInstance(answer, dict, answer)
        self.assertIn("code", answer)
        self.assertTrue(answer["cure"], answer)
        return answer

    def request(self, subtype):
        return self.ask("request", self.arm, subtype)

    def run_skill(self, skill, data=None, **more):
        task = {"id": "t", "robot": self.arm, "skill": skill, **({"data": data} if data else {}), **more}
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps({"name": "one", "tasks": [task]}))
        return self.fleet.json("scenario", "run", path, node=CLOUD)["run"]

    def end_of(self, run, timeout=60):
        """The task's (outcome, reason) once the run has ended or is paused."""
        seen = {}

        def over():
            answer = self.ask("scenario", "watch", run, "--once")
            seen.update(answer if "tasks" in answer else {})
            return seen.get("state") in ("FINISHED", "PAUSED")

        self.fleet.wait("the task is over", over, timeout)
        task = seen["tasks"][0]
        if seen["state"] == "PAUSED":
            self.fleet.trb("scenario", "abort", run, node=CLOUD, check=False)
        return task["outcome"], task["reason"]

    def kill_robot(self):
        self.fleet.virtual.pop(self.arm).stop(signal.SIGKILL)

    def pause_robot(self):
        os.kill(self.fleet.robot.child.pid, signal.SIGSTOP)

    def begin_motion(self, **more):
        """A run whose robot is in the middle of a long motion."""
        run = self.run_skill("grasp_and_put_down", **more)
        self.said(self.BEGUN)
        return run

    def check_interrupted(self, run, why):
        outcome, reason = self.end_of(run)
        self.assertEqual(outcome, "interrupted")
        self.assertIn(why, reason)
        self.assertEqual(self.refusal("go_home")["code"], "robot_offline")

    def test_a_robot_that_is_killed_in_the_middle(self):
        run = self.begin_motion()
        self.kill_robot()
        self.check_interrupted(run, self.LOST)

    def test_a_robot_that_hangs_in_the_middle(self):
        run = self.begin_motion()
        self.pause_robot()
        self.check_interrupted(run, self.SILENT)

    def start_tap(self, node):
        tap = trb_fleet.Process([self.fleet.programs / "trb", "tap", "--all", "--json", "--node", self.fleet.dir(node)],
                                self.fleet.root / "tap.log")
        self.addCleanup(tap.stop)

        def heard():
            self.ask("service", "list")
            tap.pump(0.05)
            return tap.lines

        self.fleet.wait("the tap listens", heard, 60)
        return tap


def dial(address, port):
    client = socket.create_connection((address, port), timeout=60)
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return client


def start_program(case, name, *arguments):
    """A virtual robot alone, on free ports; returns (process, its ports)."""
    log = pathlib.Path(case.folder.name) / f"{name}.log"
    robot = trb_fleet.Process([support.PROGRAMS / name, "--die-with-parent", *arguments], log, stdin=subprocess.PIPE)
    case.addCleanup(robot.stop)
    ports = robot.wait_line("ready", 60)[0].split()[1:]
    return robot, [int(port) for port in ports]
