"""A device that speaks Modbus TCP and that no file of the repository names: a node talks to it by JSON alone, and it goes
wrong. Addresses 127.0.204.x and 127.0.205.x."""
import json
import socket
import threading
import unittest

import modbus_peer
import support
from modbus_peer import COIL, DISCRETE, HOLDING, INPUT
from plc_fleet import PlcFleet

LIFT = {
    "transport": "modbus", "port": 502, "unit": 17, "poll_s": 0.05, "timeout_s": 2,
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
        super().__init__(root, programs, port, framework="acme", block=204)

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
    threading.Event().wait(2.5)
    peer.sendall(good)


def dribbled(peer, good):
    for byte in good:
        threading.Event().wait(0.25)
        peer.sendall(bytes([byte]))


class Vendor(unittest.TestCase):
    """A node and a device of the tests' own, described by JSON alone."""

    @classmethod
    def setUpClass(cls):
        cls.device = modbus_peer.Device("127.0.205.1", {
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
        self.fleet.wait("the goal is written", lambda: self.device.memory[HOLDING, 11] == 0x3DCC, 60)
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
        self.fleet.wait("it is dialled again", lambda: self.device.connections > connections, 60)
        self.fleet.wait_robot("ONLINE")
        self.assertEqual(len(self.device.writes), before + 1)
        done = self.fleet.send("tare", "25", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.device.writes), before + 2)

    def test_an_answer_that_comes_too_late(self):
        self.expect_lost(late, "no answer within 2 s")

    def test_an_answer_that_comes_byte_by_byte(self):
        self.expect_lost(dribbled, "no answer within 2 s")

    def test_a_device_that_closes_in_the_middle(self):
        self.expect_lost(lambda peer, good: peer.shutdown(socket.SHUT_RDWR), "closed by the device")

    def test_an_answer_to_another_question(self):
        self.expect_lost(lambda peer, good: peer.sendall(bytes([good[0] ^ 0x55]) + good[1:]), "not a Modbus answer")

    def test_garbage(self):
        self.expect_lost(lambda peer, good: peer.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "not a Modbus answer")

    def test_half_an_answer(self):
        self.expect_lost(lambda peer, good: peer.sendall(good[:5]), "no answer within 2 s")

    def test_a_busy_device_and_one_with_an_exception_of_its_own(self):
        for code, told in ((6, "'server device busy' (exception 6)"), (0x55, "an exception of its own")):
            self.device.mishap = lambda peer, good, code=code: peer.sendall(
                good[:4] + b"\0\3" + good[6:7] + bytes([good[7] | 0x80, code]))
            self.assertIn(told, self.fleet.send("tare", "25", "--take").stderr)
        self.assertEqual(self.fleet.profile()["robot"], "ONLINE")


if __name__ == "__main__":
    support.main()
