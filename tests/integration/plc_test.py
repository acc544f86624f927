"""The direct mode over Modbus TCP: the virtual PLC against raw sockets, a node against the virtual PLC, and a node
against a device that goes wrong. Addresses 127.0.142.x and 127.0.143.x."""
import json
import os
import signal
import socket
import subprocess
import threading
import time
import unittest

import modbus_peer
import support
import trb_fleet
from modbus_peer import COIL, DISCRETE, HOLDING, INPUT

VIRTUAL_PLC = support.PROGRAMS / "trb-virtual-plc"
RUN = {"name": "belt", "tasks": [{"id": "run", "robot": "conveyor", "skill": "run"}]}


class Plc:
    """A virtual PLC on a free port."""

    def __init__(self, case, *arguments, address="127.0.143.9"):
        self.address = address
        self.process = trb_fleet.Process([VIRTUAL_PLC, "--address", address, "--port", "auto", "--die-with-parent", *arguments],
                                         os.devnull, stdin=subprocess.PIPE)
        case.addCleanup(self.process.stop)
        self.port = int(self.process.wait_line("ready", 10)[0].split()[1])

    def client(self):
        return modbus_peer.Client(self.address, self.port)


class VirtualPlc(unittest.TestCase):
    """By packets written from the Modbus application protocol."""

    def test_golden_packets(self):
        plc = Plc(self)
        with plc.client() as client:
            for request, answer in (
                ("00 01 00 00 00 06 01 03 00 00 00 01", "00 01 00 00 00 05 01 03 02 01 f4"),
                ("00 02 00 00 00 06 01 01 00 00 00 02", "00 02 00 00 00 04 01 01 01 00"),
                ("00 03 00 00 00 06 01 02 00 00 00 04", "00 03 00 00 00 04 01 02 01 00"),
                ("00 04 00 00 00 06 01 04 00 05 00 01", "00 04 00 00 00 05 01 04 02 09 00"),
                ("00 05 00 00 00 06 01 06 00 00 00 fa", "00 05 00 00 00 06 01 06 00 00 00 fa"),
                ("00 06 00 00 00 09 01 10 00 00 00 01 02 01 2c", "00 06 00 00 00 06 01 10 00 00 00 01"),
                ("00 07 00 00 00 06 01 05 00 00 ff 00", "00 07 00 00 00 06 01 05 00 00 ff 00"),
                ("00 08 00 00 00 06 ff 01 00 00 00 01", "00 08 00 00 00 04 ff 01 01 01"),
                ("00 09 00 00 00 08 01 0f 00 00 00 01 01 00", "00 09 00 00 00 06 01 0f 00 00 00 01"),
                ("ff ff 00 00 00 06 01 03 00 01 00 01", "ff ff 00 00 00 03 01 83 02"),
                ("00 0b 00 00 00 06 01 06 00 00 ff ff", "00 0b 00 00 00 03 01 86 03"),
                ("00 0c 00 00 00 02 01 11", "00 0c 00 00 00 03 01 91 01"),
            ):
                with self.subTest(request):
                    self.assertEqual(client.ask(request), answer)

    def test_the_belt_carries_the_box_to_the_exit_and_stops_there(self):
        plc = Plc(self, "--speed", "20")
        plc.process.say("box")
        plc.process.wait_line("box entry", 5)
        with plc.client() as client:
            self.assertEqual(client.pdu("02 00 00 00 02"), "02 01 02")
            client.pdu("05 00 00 ff 00")
            self.assertEqual(client.pdu("04 00 00 00 01"), "04 02 00 01")
            plc.process.wait_line("belt off exit", 5)
            self.assertEqual(client.pdu("02 00 00 00 02"), "02 01 01")
            self.assertEqual(client.pdu("04 00 00 00 02"), "04 04 00 02 07 d0")
            self.assertEqual(client.pdu("01 00 00 00 01"), "01 01 00")

    def test_faults_come_by_word_and_by_datagram_and_stop_the_belt(self):
        plc = Plc(self, "--control", "127.0.143.9:auto")
        port = int(plc.process.wait_line("control", 5)[0].split()[1])
        with plc.client() as client, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
            client.pdu("05 00 00 ff 00")
            control.sendto(b"fault convey", (plc.address, port))
            plc.process.wait_line("belt off motor_overload", 5)
            self.assertEqual(client.pdu("02 00 02 00 02"), "02 01 01")
            self.assertEqual(client.pdu("04 00 00 00 04"), "04 08 00 03 00 00 00 00 00 01")
            self.assertEqual(client.pdu("05 00 00 ff 00"), "85 04")
            client.pdu("05 00 01 ff 00")
            self.assertEqual(client.pdu("05 00 00 ff 00"), "05 00 00 ff 00")
            plc.process.say("fault convey FATAL somebody pressed it")
            plc.process.wait_line("belt off emergency_stop", 5)
            self.assertEqual(client.pdu("02 00 02 00 02"), "02 01 02")
            plc.process.say("clear")
            plc.process.wait_line("clear", 5)

    def test_a_slow_client_and_one_that_talks_nonsense_disturb_nobody(self):
        plc = Plc(self)
        with plc.client() as half, plc.client() as client, plc.client() as nonsense:
            half.peer.sendall(bytes.fromhex("00 01 00 00 00 06 01"))
            nonsense.peer.sendall(b"GET / HTTP/1.1\r\n\r\n")
            self.assertEqual(nonsense.peer.recv(100), b"")
            plc.process.wait_line("client_dropped no_modbus", 5)
            self.assertEqual(client.pdu("03 00 00 00 01"), "03 02 01 f4")
            self.assertEqual(half.ask("03 00 00 00 01"), "00 01 00 00 00 05 01 03 02 01 f4")

    def test_a_client_that_does_not_read_is_dropped_and_the_others_are_served(self):
        plc = Plc(self)
        with plc.client() as greedy, plc.client() as client:
            greedy.peer.setblocking(False)
            request = modbus_peer.adu(1, bytes.fromhex("04 00 00 00 0a")) * 100

            def dropped():
                try:
                    while True:
                        greedy.peer.send(request)
                except BlockingIOError:
                    pass
                except OSError:
                    return True
                plc.process.pump(0)
                return "client_dropped does_not_read" in plc.process.lines

            wait("it is dropped", dropped, 20)
            self.assertEqual(client.pdu("03 00 00 00 01"), "03 02 01 f4")


def wait(what, condition, timeout):
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {timeout} s")
        threading.Event().wait(0.01)


class PlcFleet(trb_fleet.Fleet):
    """One node with a conveyor, whose PLC is on a port of its own: 502 is the superuser's."""

    def __init__(self, root, programs, port=None, framework="plc", block=142):
        super().__init__(root, programs, block=block, robots={"conveyor": (framework, "conveyor", [])}, cloud=False)
        self.port = port
        self.speed = 4.0

    def make_node(self, node):
        super().make_node(node)
        if self.port:
            self.set_port(self.port)

    def set_port(self, port):
        path = self.dir("conveyor") / "commands.json"
        path.write_text(path.read_text().replace('"port": 502', f'"port": {port}'))

    def start_robot(self, node, *more):
        if self.port and node not in self.virtual:
            return  # the test's own device
        self.start_plc("auto")
        self.set_port(self.plc_port)

    def start_plc(self, port):
        command = [self.programs / "trb-virtual-plc", "--address", self.robot_address("conveyor"), "--port", str(port),
                   "--bring-boxes", "--speed", str(self.speed), "--die-with-parent"]
        self.virtual["conveyor"] = trb_fleet.Process(command, self.root / "plc.log", stdin=subprocess.PIPE)
        self.plc_port = int(self.virtual["conveyor"].wait_line("ready", 10)[0].split()[1])

    def profile(self):
        routes = self.json("route", "list", node="conveyor")["routes"]
        return next(route for route in routes if route["id"] == "conveyor")["profile"]

    def wait_robot(self, state, timeout=15):
        return self.wait(f"the robot is {state}", lambda: self.profile()["robot"] == state, timeout)

    def send(self, subtype, *data):
        return self.trb("send", "conveyor", "command", subtype, *data, node="conveyor", check=False)

    def ask(self, name):
        done = self.trb("request", "conveyor", name, node="conveyor", check=False)
        return done.stdout.strip().splitlines()[-1] if done.returncode == 0 else done.stderr

    def counters(self):
        rows = self.json("service", "counters", "mode-adapter", node="conveyor")["values"]
        return {row["name"]: int(row["value"]) for row in rows}

    def submit(self, scenario=RUN):
        path = self.root / "scenario.json"
        path.write_text(json.dumps(scenario))
        return self.json("scenario", "run", path, node="conveyor")["run"]

    def task(self, run):
        done = self.trb("scenario", "watch", run, "--once", "--json", node="conveyor", check=False)
        view = json.loads(done.stdout.splitlines()[-1])
        return view["tasks"][0] if view.get("tasks") else {"state": ""}

    def wait_task(self, run, *states, timeout=30):
        self.wait(f"the task is {states}", lambda: self.task(run)["state"] in states, timeout)
        return self.task(run)

    def wait_idle(self, timeout=15):
        """Waits until the last command's lease is over and any node may command the robot."""
        self.wait("nobody holds the robot", lambda: not self.profile().get("control"), timeout)


class Conveyor(unittest.TestCase):
    """A node and the virtual PLC."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, PlcFleet)
        cls.fleet.start()

    def setUp(self):
        self.fleet.wait_robot("ONLINE")
        self.plc = self.fleet.virtual["conveyor"]
        self.addCleanup(self.tidy)

    def tidy(self):
        self.fleet.trb("stop", "conveyor", node="conveyor", check=False)
        self.fleet.trb("release", "conveyor", node="conveyor", check=False)
        self.fleet.virtual["conveyor"].say("clear")

    def here(self):
        self.plc.pump(0)
        return len(self.plc.lines)

    def raw(self):
        return modbus_peer.Client(self.fleet.robot_address("conveyor"), self.fleet.plc_port)

    def test_a_command_writes_the_registers_that_commands_json_names(self):
        done = self.fleet.send("set_speed", "0.25", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        with self.raw() as client:
            self.assertEqual(client.pdu("03 00 00 00 01"), "03 02 00 fa")

    def test_a_request_is_answered_with_what_the_plc_tells(self):
        self.assertIn("230.4", self.fleet.ask("mains_voltage"))
        self.assertIn("24.5", self.fleet.ask("motor_temperature"))
        self.assertIn("0", self.fleet.ask("motor_current"))

    def test_a_skill_ends_when_the_box_is_at_the_exit(self):
        start = self.here()
        task = self.fleet.wait_task(self.fleet.submit(), "FINISHED", "FAILED")
        self.assertEqual(task["state"], "FINISHED", task)
        self.plc.wait_line("belt off exit", 5, start)
        self.assertIn("true", self.fleet.ask("box_at_exit"))

    def test_a_value_that_the_plc_refuses_is_told_with_its_register(self):
        done = self.fleet.send("set_speed", "5", "--take")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("speed (holding 0): the device answered 'illegal data value' (exception 3)", done.stderr)
        self.assertIn("manual", done.stderr)

    def test_text_is_refused_before_anything_is_written(self):
        start = self.here()
        for data in ('"fast"', '"a\\"b\\nrunning = 1"', '0.1\nrunning = 1', '0.1"', "[0.1, 0.2]", "70"):
            with self.subTest(data):
                done = self.fleet.send("set_speed", data, "--take")
                self.assertNotEqual(done.returncode, 0)
                self.assertIn("bad_value", done.stderr)
        self.assertEqual(self.plc.lines[start:], [])

    def test_two_commands_at_once_are_both_done(self):
        command = [str(support.PROGRAMS / "trb"), "send", "conveyor", "command", "set_speed", "--node",
                   str(self.fleet.dir("conveyor")), "--take"]
        children = [subprocess.Popen(command[:5] + [data] + command[5:], stderr=subprocess.PIPE, stdout=subprocess.PIPE)
                    for data in ("0.11", "0.22", "0.33")]
        for child in children:
            _, errors = child.communicate(timeout=20)
            self.assertEqual(child.returncode, 0, errors)
        with self.raw() as client:
            self.assertIn(client.pdu("03 00 00 00 01"), ("03 02 00 6e", "03 02 00 dc", "03 02 01 4a"))

    def test_a_stop_in_the_middle_of_a_skill_stops_the_belt(self):
        start = self.here()
        run = self.fleet.submit({"name": "belt", "tasks": [{"id": "run", "robot": "conveyor", "skill": "run",
                                                            "data": {"speed": 0.1}}]})
        self.plc.wait_line("belt on", 15, start)
        done = self.fleet.trb("stop", "conveyor", node="conveyor")
        self.assertIn("confirmed", done.stdout)
        self.plc.wait_line("belt off command", 5, start)
        self.assertIn("fenced", self.fleet.send("set_speed", "0.2", "--take").stderr)
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)

    def test_an_overload_in_the_middle_of_a_skill_ends_it(self):
        start = self.here()
        run = self.wait_running(start)
        self.plc.say("overload")
        self.plc.wait_line("belt off motor_overload", 5, start)
        self.fleet.wait("the task has failed", lambda: self.fleet.task(run)["state"] in ("RETRIABLE", "FAILED"), 10)
        self.assertIn("belt_state", json.dumps(self.fleet.task(run)))
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)

    def test_an_overload_is_told_by_the_next_command(self):
        start = self.here()
        self.plc.say("overload")
        self.plc.wait_line("fault motor_overload", 5, start)
        done = self.fleet.send("run", "0.5", "--take")
        self.assertIn("running (coil 0): the device answered 'server device failure' (exception 4)", done.stderr)
        self.assertIn("the 1 writes before it were done", done.stderr)
        done = self.fleet.send("reset", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.plc.wait_line("clear", 5, start)

    def wait_running(self, start):
        run = self.fleet.submit({"name": "belt", "tasks": [{"id": "run", "robot": "conveyor", "skill": "run",
                                                            "data": {"speed": 0.1}}]})
        self.plc.wait_line("belt on", 15, start)
        return run

    def test_a_plc_that_is_killed_in_the_middle_of_a_skill(self):
        run = self.wait_running(self.here())
        self.plc.stop(signal.SIGKILL)
        self.fleet.wait_robot("CONNECTION_BROKEN", 5)
        self.assertIn("robot_offline", self.fleet.send("set_speed", "0.2", "--take").stderr)
        self.fleet.wait("the run says so", lambda: self.fleet.task(run)["state"] != "RUNNING", 10)
        self.fleet.start_plc(self.fleet.plc_port)
        self.plc = self.fleet.virtual["conveyor"]
        self.fleet.wait_robot("ONLINE", 10)
        done = self.fleet.send("set_speed", "0.2", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.plc.pump(0)
        self.assertFalse([line for line in self.plc.lines if line.startswith("belt on")])  # nothing was repeated
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)

    def test_a_plc_that_hangs_in_the_middle_of_a_skill_is_told_of_within_seconds(self):
        start = self.here()
        run = self.wait_running(start)
        self.plc.child.send_signal(signal.SIGSTOP)
        self.addCleanup(self.plc.child.send_signal, signal.SIGCONT)
        self.fleet.wait_robot("CONNECTION_BROKEN", 5)
        self.assertIn("no answer within 0.5 s", self.fleet.profile()["detail"])
        began = time.monotonic()
        refused = self.fleet.send("set_speed", "0.2", "--take")
        self.assertIn("robot_offline", refused.stderr)
        self.assertLess(time.monotonic() - began, 5)
        self.plc.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE", 15)
        self.assertEqual(sum(line.startswith("belt on") for line in self.plc.lines[start:]), 1)
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)


# A vendor that no file of the repository names: it is described by JSON alone.
LIFT = {
    "transport": "modbus", "port": 502, "unit": 17, "poll_s": 0.05,
    "values": {"goal": "holding 10 float32 low_word_first", "height": "input 20 int32 low_word_first * 0.001 - 1",
               "load": "holding 30 int16 * 0.1 - 40", "arrived": "discrete 7", "brake": "coil 3",
               "secret": "holding 999"},
    "commands": {"lift": "brake = false\ngoal = {0}", "tare": "load = {data}", "open_secret": "secret = 1",
                 "stop": "brake = true"},
    "requests": {"position": "height", "load": "load", "secret": "secret"}}
LIFT_ROBOT = {
    "maker": "Acme", "model": "Lift", "capabilities": ["lift"],
    "skills": {"lift": {"capability": "lift", "parameters": {"height": {"type": "number", "unit": "m"}},
                        "command": {"subtype": "lift", "data": "[{height}]"},
                        "end": {"kind": "state", "state": "arrived", "equals": 1}, "timeout_s": 20}}}


class LiftFleet(PlcFleet):
    def __init__(self, root, programs, port=None):
        super().__init__(root, programs, port, framework="acme")

    def make_node(self, node):
        self.robots = {"conveyor": ("acme", "conveyor", [])}
        super().make_node(node)
        self.edit("profile.json", "acme", "direct")
        self.edit("commands.json", "acme", dict(LIFT, port=self.port))
        (self.dir(node) / "robots" / "conveyor.json").write_text(json.dumps(LIFT_ROBOT))

    def edit(self, name, key, value):
        path = self.dir("conveyor") / name
        path.write_text(path.read_text().rstrip().removesuffix("}") + f', "{key}": {json.dumps(value)}}}\n')


def late(peer, good):
    threading.Event().wait(0.8)
    peer.sendall(good)


def dribbled(peer, good):
    for byte in good:
        threading.Event().wait(0.1)
        peer.sendall(bytes([byte]))


class Vendor(unittest.TestCase):
    """A node and a device of the tests' own, described by JSON alone."""

    @classmethod
    def setUpClass(cls):
        cls.device = modbus_peer.Device("127.0.143.1", {
            (HOLDING, 10): 0, (HOLDING, 11): 0, (INPUT, 20): 2234, (INPUT, 21): 0, (HOLDING, 30): 650, (DISCRETE, 7): 0,
            (COIL, 3): 1})
        cls.addClassCleanup(cls.device.close)
        cls.fleet = support.make_fleet(cls, LiftFleet, port=cls.device.port)
        cls.fleet.start()

    def setUp(self):
        self.fleet.wait_robot("ONLINE")
        self.device.mishap = None
        self.device.memory[DISCRETE, 7] = 0

    def test_it_speaks_and_answers(self):
        self.assertIn("1.234", self.fleet.ask("position"))
        self.assertIn("25", self.fleet.ask("load"))
        done = self.fleet.send("tare", "-40.5", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.device.memory[HOLDING, 30], 0xFFFB)
        self.device.memory[HOLDING, 30] = 650

    def test_its_skill_runs_and_ends(self):
        run = self.fleet.submit({"name": "up", "tasks": [{"id": "up", "robot": "conveyor", "skill": "lift",
                                                          "data": {"height": 0.1}}]})
        self.fleet.wait("the goal is written", lambda: self.device.memory[HOLDING, 11] == 0x3DCC, 15)
        self.assertEqual(self.device.writes[-2:], [(COIL, 3, 0), (HOLDING, 10, 0xCCCD, 0x3DCC)])
        self.device.memory[DISCRETE, 7] = 1
        self.assertEqual(self.fleet.wait_task(run, "FINISHED", "FAILED")["state"], "FINISHED")

    def test_an_illegal_address_is_told_by_name_register_and_cure(self):
        done = self.fleet.send("open_secret", "--take")
        self.assertIn("secret (holding 999): the device answered 'illegal data address' (exception 2)", done.stderr)
        self.assertIn("manual, counted from 0, and correct commands.json", done.stderr)
        self.assertIn("secret (holding 999): the device answered 'illegal data address'", self.fleet.ask("secret"))
        log = (self.fleet.dir("conveyor") / "log" / "mode-adapter.log").read_text()
        self.assertEqual(log.count("WARNING secret (holding 999)"), 1)  # reported once, though it is polled on and on
        self.assertIn("1.234", self.fleet.ask("position"))

    def expect_lost(self, mishap, reason):
        """One write fails: it is reported, not repeated, and the next command works."""
        before = len(self.device.writes)
        connections = self.device.connections
        self.device.mishap = mishap
        done = self.fleet.send("tare", "1", "--take")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(f"the connection was lost while load (holding 30) was written, and nobody knows whether the device "
                      f"took it: {reason}", done.stderr)
        self.assertIn("look at the device before you send it again", done.stderr)
        self.fleet.wait("it is dialled again", lambda: self.device.connections > connections, 10)
        self.fleet.wait_robot("ONLINE")
        self.assertEqual(len(self.device.writes), before + 1)
        done = self.fleet.send("tare", "25", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.device.writes), before + 2)

    def test_an_answer_that_comes_too_late(self):
        self.expect_lost(late, "no answer within 0.5 s")

    def test_an_answer_that_comes_byte_by_byte(self):
        self.expect_lost(dribbled, "no answer within 0.5 s")

    def test_a_device_that_closes_in_the_middle(self):
        self.expect_lost(lambda peer, good: peer.shutdown(socket.SHUT_RDWR), "closed by the device")

    def test_an_answer_to_another_question(self):
        self.expect_lost(lambda peer, good: peer.sendall(bytes([good[0] ^ 0x55]) + good[1:]), "an answer that is none")

    def test_garbage(self):
        self.expect_lost(lambda peer, good: peer.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "an answer that is none")

    def test_half_an_answer(self):
        self.expect_lost(lambda peer, good: peer.sendall(good[:5]), "no answer within 0.5 s")

    def test_a_busy_device_and_one_with_an_exception_of_its_own(self):
        for code, told in ((6, "'server device busy' (exception 6)"), (0x55, "an exception of its own")):
            self.device.mishap = lambda peer, good, code=code: peer.sendall(
                good[:4] + b"\0\3" + good[6:7] + bytes([good[7] | 0x80, code]))
            self.assertIn(told, self.fleet.send("tare", "25", "--take").stderr)
        self.assertEqual(self.fleet.profile()["robot"], "ONLINE")


if __name__ == "__main__":
    support.main()
