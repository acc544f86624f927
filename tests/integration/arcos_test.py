"""The virtual Pioneer, tested by a client written from the maker's description; and Pioneers in a fleet, through
router, mode-adapter and virtual robot. Addresses 127.0.146.x and 127.0.147.x.
"""
import json
import math
import os
import signal
import socket
import statistics
import subprocess
import time
import unittest

import arcos_client
import support
import trb_fleet

ROBOT = support.PROGRAMS / "trb-virtual-pioneer"
SPEED = 4
LONG_S = 60
PLACES = {"pioneer1": (1, 3, 0), "pioneer2": (2, 3, 1.5708)}


class Robot(trb_fleet.Process):
    """A virtual Pioneer of its own, on a free port."""

    def __init__(self, case, *arguments):
        folder = support.temporary_folder(case)
        super().__init__([ROBOT, "--address", "127.0.147.200", "--port", "auto", "--control", "127.0.147.200:auto",
                          "--die-with-parent", *arguments],
                         folder / "robot.log", stdin=subprocess.PIPE)
        case.addCleanup(self.stop)
        self.port = int(self.wait_line("ready", 60)[0].split()[1])
        self.control = int(self.wait_line("control", 60)[0].split()[1])
        self.case = case

    def client(self):
        client = arcos_client.Client("127.0.147.200", self.port)
        self.case.addCleanup(client.close)
        return client

    def open(self):
        client = self.client()
        client.connect()
        client.send(4, 1)
        client.wait("the motors are on", lambda sip: sip.motors)
        return client


@unittest.skipUnless(ROBOT.exists(), f"{ROBOT} is not built")
class Protocol(unittest.TestCase):
    def test_the_hand_shake_names_the_robot_and_packets_come_ten_times_a_second(self):
        robot = Robot(self, "--name", "Frieda")
        client = robot.client()
        self.assertEqual(client.connect(), [b"Frieda", b"Pioneer", b"p3dx-sh"])
        sip = client.sip()
        self.assertEqual((sip.x, sip.y, sip.heading, sip.motors, sip.moving), (0, 0, 0, False, False))
        self.assertEqual((sip.volts, sip.volts_again, len(sip.sonar)), (12.8, 12.8, 4))
        times = []
        for _ in range(21):
            client.sip()
            times.append(time.monotonic())
        self.assertAlmostEqual(statistics.median(b - a for a, b in zip(times, times[1:])), 0.1, delta=0.015)

    def test_it_drives_and_turns_with_limits_and_stands_where_it_was_told_to(self):
        client = Robot(self, "--speed", str(SPEED)).open()
        client.send(8, -800)
        speeds = []
        client.wait("it drives", lambda sip: speeds.append(sip.left) or sip.moving)
        client.wait("it stands", lambda sip: speeds.append(sip.left) or not sip.moving)
        self.assertTrue(all(-760 <= speed <= 0 for speed in speeds), speeds)
        sip = client.sip()
        self.assertAlmostEqual(sip.x, -800, delta=2)
        self.assertEqual(sip.words[0], sip.x & 0x7FFF)  # 15 bits, as ARIA masks them
        client.send(12, 135)
        client.wait("it turns", lambda sip: sip.left < 0 < sip.right)
        sip = client.wait("it stands", lambda sip: not sip.moving)
        self.assertAlmostEqual(sip.heading, 135, delta=0.5)
        client.send(7)
        sip = client.wait("SETO", lambda sip: sip.x == 0)
        self.assertAlmostEqual(sip.heading, 0, delta=0.1)

    def test_without_a_packet_for_two_seconds_it_halts(self):
        robot = Robot(self)
        client = robot.open()
        client.send(11, 200)
        for _ in range(3):  # what a stalled machine adds comes and goes
            client.wait("it drives", lambda sip: sip.left == 200)
            client.fresh_sip()
            began = time.monotonic()
            client.send(0)
            client.wait("it halts", lambda sip: sip.left == 0, awake=False)
            took = time.monotonic() - began
            client.wait("it goes on", lambda sip: sip.left > 0)
            if took <= 4:
                break
        self.assertTrue(2 <= took <= 4, took)
        robot.wait_line("watchdog halted", 60)

    def test_noise_and_wrong_checksums_harm_nothing(self):
        robot = Robot(self)
        client = robot.open()
        bad = bytearray(arcos_client.command(11, 300))
        bad[-1] ^= 1
        client.socket.sendall(os.urandom(20000).replace(b"\xfa\xfb", b"") + bytes(bad) + arcos_client.command(4, 0))
        client.wait("the packet after the noise is read", lambda sip: not sip.motors)
        robot.wait_line("wrong_checksum 1", 60)

    def test_one_client_at_a_time_and_what_it_left_open_the_next_one_finds(self):
        robot = Robot(self)
        client = robot.open()
        second = robot.client()
        self.assertEqual(second.socket.recv(10), b"")
        client.close()
        robot.wait_line("disconnected", 60)
        third = robot.client()
        self.assertTrue(third.sip().motors)
        third.send(2)
        third.send(0)
        while third.receive() != b"\0":
            pass
        third.connect()

    def test_its_settings_are_told_in_the_order_of_the_manual(self):
        client = Robot(self).open()
        client.send(18, 1)
        data = client.receive()
        while data[0] != 0x20:
            data = client.receive()
        kind, subtype, serial, rest = data[1:].split(b"\0", 3)
        self.assertEqual((kind, subtype, serial), (b"Pioneer", b"p3dx-sh", b"VIRTUAL"))
        turn, speed = arcos_client.struct.unpack("<HH", rest[1:5])
        self.assertEqual((turn, speed), (300, 1500))

    def test_it_fails_by_word_as_a_pioneer_fails(self):
        robot = Robot(self)
        client = robot.open()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
            wire.connect(("127.0.147.200", robot.control))
            wire.send(b"fault mobile URGENT a chair")
            sip = client.wait("a stall", lambda sip: sip.stall)
            self.assertEqual((sip.stall, sip.motors), (0x0103, True))
            wire.send(b"fault mobile")
            self.assertTrue(client.wait("motors off", lambda sip: not sip.motors).stall)
            wire.send(b"fault mobile FATAL")
            client.wait("the button", lambda sip: sip.stop_button)
            robot.pump(0)
            mark = len(robot.lines)
            client.send(4, 1)
            robot.wait_line("command 4 1", 60, mark)
            wire.send(b"clear")
            sip = client.wait("clear", lambda sip: not sip.stop_button)
            self.assertEqual((sip.stall, sip.motors), (0, False))
            wire.send(b"fault mobile WARNING")
            self.assertLess(client.wait("a low battery", lambda sip: sip.volts < 12).volts, 11.5)


class PioneerFleet(trb_fleet.Fleet):
    """Two Pioneers that were switched on at places of their own."""

    def __init__(self, root, programs):
        super().__init__(root, programs, block=146, udp_port=50146, cloud=False, speed=SPEED,
                         robots={name: ("pioneer", "pioneer", ["--name", name, "--pose", ",".join(map(str, PLACES[name]))])
                                 for name in PLACES})

    def send(self, *words):
        """With --take, because a run holds the control for 10 s after its end."""
        return self.trb("send", "pioneer1", "command", *words, "--take", node="pioneer1", check=False)

    def ask(self, name, node="pioneer1"):
        done = self.trb("request", "pioneer1", name, "--json", node=node)
        return json.loads(json.loads(done.stdout)["data"])

    def profile(self, node="pioneer1"):
        routes = self.json("route", "list", node=node)["routes"]
        return next(route for route in routes if route["id"] == "pioneer1")["profile"]

    def wait_robot(self, state, timeout=LONG_S):
        self.wait(f"the robot is {state}", lambda: self.profile()["robot"] == state, timeout)


@unittest.skipUnless(ROBOT.exists(), f"{ROBOT} is not built")
class InAFleet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, PioneerFleet)
        cls.fleet.start()
        cls.fleet.wait("both nodes know each other", lambda: all(cls.fleet.formed(n) for n in PLACES), LONG_S)

    def setUp(self):
        if "pioneer1" not in self.fleet.virtual:
            self.fleet.start_robot("pioneer1")
        self.robot = self.fleet.virtual["pioneer1"]
        self.robot.child.send_signal(signal.SIGCONT)
        self.robot.say("clear")
        self.fleet.wait_robot("ONLINE")
        self.fleet.trb("release", "pioneer1", node="pioneer1")

    def mark(self):
        self.fleet.pump()
        return len(self.robot.lines)

    def wait_at(self, mark, x, y, yaw=None):
        """Waits until the robot reports that it stands there, in the hall."""
        def there():
            self.fleet.pump()
            places = [line.split()[1:] for line in self.robot.lines[mark:] if line.startswith("at ")]
            if not places:
                return False
            at = [float(word) for word in places[-1]]
            turned = 0 if yaw is None else abs(math.remainder(at[2] - yaw, 2 * math.pi))
            return math.hypot(at[0] - x, at[1] - y) <= 0.06 and turned <= math.radians(4)
        self.fleet.wait(f"the robot stands at {x}, {y}; it says {self.robot.lines[-3:]}", there, LONG_S)

    def submit(self, place, robot="pioneer1"):
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps({"name": "go", "tasks": [
            {"id": "go", "robot": robot, "skill": "go_to", "data": {"place": place}}]}))
        return self.fleet.json("scenario", "run", path, node="pioneer1")["run"]

    def view(self, run):
        done = self.fleet.trb("scenario", "watch", run, "--once", "--json", node="pioneer1", check=False)
        return json.loads(done.stdout.splitlines()[-1])

    def wait_task(self, run, *states):
        seen = {}

        def there():
            seen.update(self.view(run))
            return seen.get("tasks") and seen["tasks"][0]["state"] in states
        self.fleet.wait(f"the task is {states}", there, LONG_S)
        return seen

    def wait_unfinished(self, run):
        """What ends its task is told to the scheduler, which has it signed and stored: that the robot stands is known before."""
        self.fleet.wait("the task does not go on", lambda: self.view(run)["tasks"][0]["state"] != "RUNNING", LONG_S)
        self.assertNotEqual(self.view(run)["tasks"][0]["state"], "FINISHED")

    def tap(self):
        tap = trb_fleet.Process([support.PROGRAMS / "trb", "tap", "--all", "--json", "--node", self.fleet.dir("pioneer1")],
                                self.fleet.root / "tap.log")
        self.addCleanup(tap.stop)

        def heard():
            self.fleet.trb("service", "list", node="pioneer1")
            tap.pump(0.05)
            return tap.lines
        self.fleet.wait("the tap listens", heard, LONG_S)
        return tap

    def test_a_command_of_another_node_drives_it_and_a_request_tells_where_it_is(self):
        mark = self.mark()
        done = self.fleet.trb("send", "pioneer1", "command", "go_to", "[600, -200, 0]", "--take", node="pioneer2")
        self.assertIn("started", done.stdout)
        self.wait_at(mark, 1.6, 2.8, 0)
        x, y, heading = self.fleet.ask("position", node="pioneer2")
        self.assertTrue(math.hypot(x - 600, y + 200) <= 55 and abs(heading) <= 4, (x, y, heading))
        self.assertGreater(self.fleet.ask("state_of_charge"), 90)
        self.assertIs(self.fleet.ask("motors"), True)

    def test_each_robot_goes_to_a_place_of_the_hall_from_where_it_was_switched_on(self):
        mark = self.mark()
        run = self.submit("table1")
        self.wait_task(run, "FINISHED")
        self.wait_at(mark, 2, 1, 0)
        self.robot = self.fleet.virtual["pioneer2"]
        run = self.submit("conveyor_entry", "pioneer2")
        self.wait_task(run, "FINISHED")
        self.wait_at(0, 3, 2, math.pi / 2)

    def test_a_stop_in_the_middle_of_a_way(self):
        mark = self.mark()
        run = self.submit("loading_area")
        self.robot.wait_line("command 8", LONG_S, mark)
        done = self.fleet.trb("stop", "pioneer1", node="pioneer2")
        self.assertIn("confirmed", done.stdout)
        self.assertEqual(self.fleet.ask("speeds"), [0, 0])
        self.wait_unfinished(run)
        self.assertIn("fenced", self.fleet.send("speed", "100").stderr)
        self.fleet.trb("scenario", "abort", run, node="pioneer1", check=False)

    def test_a_robot_that_hangs_is_told_of_and_does_not_go_on_when_it_is_back(self):
        mark = self.mark()
        run = self.submit("dock")
        self.robot.wait_line("command 8", LONG_S, mark)
        self.robot.child.send_signal(signal.SIGSTOP)
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)
        self.assertIn("said nothing for 3 s", self.fleet.profile()["detail"])
        self.wait_unfinished(run)
        self.assertIn("robot_offline", self.fleet.send("speed", "100").stderr)
        self.robot.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE")
        self.fleet.wait("it stands", lambda: self.fleet.ask("speeds") == [0, 0], 60)
        self.fleet.trb("scenario", "abort", run, node="pioneer1", check=False)

    def test_a_robot_that_is_killed_and_one_in_its_place(self):
        mark = self.mark()
        run = self.submit("dock")
        self.robot.wait_line("command 1", LONG_S, mark)
        self.fleet.virtual.pop("pioneer1").stop(signal.SIGKILL)
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)
        self.wait_unfinished(run)
        self.fleet.trb("scenario", "abort", run, node="pioneer1", check=False)
        self.fleet.start_robot("pioneer1")
        self.fleet.wait_robot("ONLINE")
        self.assertEqual(self.fleet.ask("position"), [0, 0, 0])

    def test_two_commands_at_once(self):
        run = self.submit("conveyor_exit")
        self.wait_task(run, "RUNNING")
        words = ("send", "pioneer1", "command", "go_to", "[0, 0, 0]")
        self.assertIn("control_held", self.fleet.trb(*words, node="pioneer2", check=False).stderr)
        self.assertIn("busy", self.fleet.trb(*words, "--take", node="pioneer2", check=False).stderr)
        self.wait_task(run, "FINISHED")

    def test_wrong_numbers_and_words_are_answered_with_what_to_do(self):
        for words, what in ((("speed", "fast"), "'fast' is no number"), (("speed", "40000"), "not from -32767 to 32767"),
                            (("go_to", "[1, 2]"), "needs item 2"), (("speed", '1"\n2'), "is no number"),
                            (("dance", ""), "commands.json has no words for 'dance'")):
            with self.subTest(words):
                done = self.fleet.send(*words)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(what, done.stderr)

    def test_the_robots_faults_are_told_to_every_node(self):
        tap = self.tap()
        for severity, text in (("URGENT", "both wheels stalled; front bumper 1"), ("FATAL", "the STOP button is pressed")):
            with self.subTest(severity):
                mark = len(tap.lines)
                self.robot.say(f"fault mobile {severity} a chair")
                line = tap.wait_line('"robot_fault"', 60, mark)[0]
                message = json.loads(line)
                fault = message["body"]
                self.assertEqual((message["target"], fault["capability"], fault["severity"]), ("*", "mobile", severity))
                self.assertIn(text, fault["text"])
        done = self.fleet.send("go_to", "[0, 0, 0]")
        self.assertIn("the motors are off", done.stderr)
        self.assertIn("trb release pioneer1", done.stderr)

    def test_a_node_that_is_shut_down_closes_the_robot(self):
        mark = self.mark()
        os.kill(self.fleet.pid("pioneer1", "mode-adapter"), signal.SIGTERM)
        self.robot.wait_line("command 2", 60, mark)
        # The table goes on with the last word of the process that has ended.
        self.robot.wait_line("synced", 60, mark)
        self.fleet.wait("the robot answers", lambda: self.fleet.trb(
            "request", "pioneer1", "motors", node="pioneer1", check=False).returncode == 0, LONG_S)


if __name__ == "__main__":
    support.main()
