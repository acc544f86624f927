"""The direct mode over Modbus TCP: the virtual PLC against raw sockets, and a node against the virtual PLC. Addresses
127.0.142.x and 127.0.143.x."""
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
from plc_fleet import PlcFleet

VIRTUAL_PLC = support.PROGRAMS / "trb-virtual-plc"


class Plc:
    """A virtual PLC on a free port."""

    def __init__(self, case, *arguments, address="127.0.143.9"):
        self.address = address
        self.process = trb_fleet.Process([VIRTUAL_PLC, "--address", address, "--port", "auto", "--die-with-parent", *arguments],
                                         os.devnull, stdin=subprocess.PIPE)
        case.addCleanup(self.process.stop)
        self.port = int(self.process.wait_line("ready", 60)[0].split()[1])

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
                ("ff ff 00 00 00 06 01 03 00 02 00 01", "ff ff 00 00 00 03 01 83 02"),
                ("00 0b 00 00 00 06 01 06 00 00 ff ff", "00 0b 00 00 00 03 01 86 03"),
                ("00 0c 00 00 00 02 01 11", "00 0c 00 00 00 03 01 91 01"),
            ):
                with self.subTest(request):
                    self.assertEqual(client.ask(request), answer)

    def test_the_belt_carries_the_box_to_the_exit_and_stops_there(self):
        plc = Plc(self, "--speed", "20")
        plc.process.say("box")
        plc.process.wait_line("box entry", 60)
        with plc.client() as client:
            self.assertEqual(client.pdu("02 00 00 00 02"), "02 01 02")
            client.pdu("05 00 00 ff 00")
            self.assertEqual(client.pdu("04 00 00 00 01"), "04 02 00 01")
            plc.process.wait_line("belt off exit", 60)
            self.assertEqual(client.pdu("02 00 00 00 02"), "02 01 01")
            self.assertEqual(client.pdu("04 00 00 00 02"), "04 04 00 02 07 d0")
            self.assertEqual(client.pdu("01 00 00 00 01"), "01 01 00")

    def test_faults_come_by_word_and_by_datagram_and_stop_the_belt(self):
        plc = Plc(self, "--control", "127.0.143.9:auto")
        port = int(plc.process.wait_line("control", 60)[0].split()[1])
        with plc.client() as client, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
            client.pdu("05 00 00 ff 00")
            control.sendto(b"fault convey", (plc.address, port))
            plc.process.wait_line("belt off motor_overload", 60)
            self.assertEqual(client.pdu("02 00 02 00 02"), "02 01 01")
            self.assertEqual(client.pdu("04 00 00 00 04"), "04 08 00 03 00 00 00 00 00 01")
            self.assertEqual(client.pdu("05 00 00 ff 00"), "85 04")
            client.pdu("05 00 01 ff 00")
            self.assertEqual(client.pdu("05 00 00 ff 00"), "05 00 00 ff 00")
            plc.process.say("fault convey FATAL somebody pressed it")
            plc.process.wait_line("belt off emergency_stop", 60)
            self.assertEqual(client.pdu("02 00 02 00 02"), "02 01 02")
            plc.process.say("clear")
            plc.process.wait_line("clear", 60)

    def test_a_slow_client_and_one_that_talks_nonsense_disturb_nobody(self):
        plc = Plc(self)
        with plc.client() as half, plc.client() as client, plc.client() as nonsense:
            half.peer.sendall(bytes.fromhex("00 01 00 00 00 06 01"))
            nonsense.peer.sendall(b"GET / HTTP/1.1\r\n\r\n")
            self.assertEqual(nonsense.peer.recv(100), b"")
            plc.process.wait_line("client_dropped no_modbus", 60)
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

            wait("it is dropped", dropped, 60)
            self.assertEqual(client.pdu("03 00 00 00 01"), "03 02 01 f4")


def wait(what, condition, timeout):
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what}: not within {timeout} s")
        threading.Event().wait(0.01)


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
        self.plc.wait_line("belt off exit", 60, start)
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
        self.plc.wait_line("belt on", 60, start)
        done = self.fleet.trb("stop", "conveyor", node="conveyor")
        self.assertIn("confirmed", done.stdout)
        self.plc.wait_line("belt off command", 60, start)
        self.assertIn("fenced", self.fleet.send("set_speed", "0.2", "--take").stderr)
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)

    def test_an_overload_in_the_middle_of_a_skill_ends_it(self):
        start = self.here()
        run = self.wait_running(start)
        self.plc.say("overload")
        self.plc.wait_line("belt off motor_overload", 60, start)
        self.fleet.wait("the task has failed", lambda: self.fleet.task(run)["state"] in ("RETRIABLE", "FAILED"), 60)
        self.assertIn("belt_state", json.dumps(self.fleet.task(run)))
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)

    def test_an_overload_is_told_by_the_next_command(self):
        start = self.here()
        self.plc.say("overload")
        self.plc.wait_line("fault motor_overload", 60, start)
        done = self.fleet.send("run", "0.5", "--take")
        self.assertIn("running (coil 0): the device answered 'server device failure' (exception 4)", done.stderr)
        self.assertIn("the 1 writes before it were done", done.stderr)
        done = self.fleet.send("reset", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.plc.wait_line("clear", 60, start)

    def wait_running(self, start):
        run = self.fleet.submit({"name": "belt", "tasks": [{"id": "run", "robot": "conveyor", "skill": "run",
                                                            "data": {"speed": 0.1}}]})
        self.plc.wait_line("belt on", 60, start)
        return run

    def test_a_plc_that_is_killed_in_the_middle_of_a_skill(self):
        run = self.wait_running(self.here())
        self.plc.stop(signal.SIGKILL)
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)
        self.assertIn("robot_offline", self.fleet.send("set_speed", "0.2", "--take").stderr)
        self.fleet.wait("the run says so", lambda: self.fleet.task(run)["state"] != "RUNNING", 60)
        self.fleet.start_plc(self.fleet.plc_port)
        self.plc = self.fleet.virtual["conveyor"]
        self.fleet.wait_robot("ONLINE", 60)
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
        self.fleet.wait_robot("CONNECTION_BROKEN", 15)
        self.assertIn("no answer within 2 s", self.fleet.profile()["detail"])
        began = time.monotonic()
        refused = self.fleet.send("set_speed", "0.2", "--take")
        self.assertIn("robot_offline", refused.stderr)
        self.assertLess(time.monotonic() - began, 15)
        self.plc.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE", 60)
        self.assertEqual(sum(line.startswith("belt on") for line in self.plc.lines[start:]), 1)
        self.fleet.trb("scenario", "abort", run, node="conveyor", check=False)


if __name__ == "__main__":
    support.main()
