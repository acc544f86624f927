"""A Universal Robot's wire: trb-virtual-ur alone, whose bytes are read by raw sockets, from the facts in the maker's documents.
Address 127.0.155.9."""
import pathlib
import socket
import struct
import subprocess
import unittest

import support
import trb_fleet


class Wire(unittest.TestCase):
    """The controller's own bytes, by raw sockets."""

    def setUp(self):
        log = pathlib.Path("/dev/null")
        self.robot = trb_fleet.Process([support.PROGRAMS / "trb-virtual-ur", "--address", "127.0.155.9", "--port-base",
                                        "auto", "--speed", "5"], log, stdin=subprocess.PIPE)
        self.addCleanup(self.robot.stop)
        ready, _ = self.robot.wait_line("ready", 60)
        self.primary, self.secondary, self.dashboard = map(int, ready.split()[1:4])

    def dial(self, port):
        link = socket.create_connection(("127.0.155.9", port), 60)
        self.addCleanup(link.close)
        return link.makefile("rwb", buffering=0)

    @staticmethod
    def exactly(link, size):
        data = b""
        while len(data) < size:
            more = link.read(size - len(data))
            if not more:
                raise EOFError
            data += more
        return data

    def packet(self, link):
        size, kind = struct.unpack(">iB", self.exactly(link, 5))
        return kind, self.exactly(link, size - 5)

    def message(self, link, kind):
        """The next message of a kind: its payload after time, source and kind."""
        while True:
            type_, body = self.packet(link)
            if type_ == 20 and body[9] == kind:
                return body[10:]

    def state(self, link):
        """The next state: {sub-package type: its whole bytes}"""
        while True:
            type_, body = self.packet(link)
            if type_ != 16:
                continue
            parts = {}
            while body:
                size, part = struct.unpack(">IB", body[:5])
                parts[part], body = body[:size], body[size:]
            return parts

    def test_the_version_comes_first_and_then_the_state_ten_times_a_second(self):
        for port in (self.primary, self.secondary):
            link = self.dial(port)
            type_, body = self.packet(link)
            self.assertEqual((type_, body[9]), (20, 3))
            parts = self.state(link)
            self.assertEqual(len(parts[0]), 47)
            self.assertEqual(len(parts[1]), 5 + 6 * 41)

    def test_golden_state_of_an_idle_arm(self):
        parts = self.state(self.dial(self.secondary))
        mode = parts[0]
        self.assertEqual(mode[:5], bytes.fromhex("0000002f00"))
        # connected, enabled, power on; no stop, no program; running, control mode 0
        self.assertEqual(mode[13:22], bytes.fromhex("010101000000000700"))
        joints = [struct.unpack(">3d4fB", parts[1][5 + i * 41:5 + (i + 1) * 41]) for i in range(6)]
        self.assertEqual([round(joint[0], 4) for joint in joints], [0, -1.5708, 0, -1.5708, 0, 0])
        self.assertEqual([joint[7] for joint in joints], [253] * 6)

    def test_the_bits_of_the_stops_and_of_a_program(self):
        link = self.dial(self.secondary)
        for line, bits in (("fault grab", "010101000100000700"), ("clear", "010101000000000700"),
                           ("fault grab FATAL", "010100010000000300")):
            self.robot.say(line)
            wanted = bytes.fromhex(bits)
            for _ in range(20):
                seen = self.state(link)[0][13:22]
                if seen == wanted:
                    break
            self.assertEqual(seen.hex(), wanted.hex(), line)

    def test_a_program_is_told_by_key_messages_and_a_bad_one_by_its_exception(self):
        primary, secondary = self.dial(self.primary), self.dial(self.secondary)
        secondary.write(b"def trb_1():\n  sleep(0.5)\n  textmsg(\"trb_1 done\")\nend\n")
        self.assertEqual(self.message(primary, 7), bytes(8) + b"\x13PROGRAM_XXX_STARTEDtrb_1")
        self.assertEqual(self.message(primary, 0), b"trb_1 done")
        self.assertEqual(self.message(primary, 7), bytes(8) + b"\x13PROGRAM_XXX_STOPPEDtrb_1")
        secondary.write(b"def trb_2():\n  moovej([0,0,0,0,0,0])\nend\n")
        exception = self.message(primary, 10)
        self.assertEqual(struct.unpack(">ii", exception[:8])[0], 2)
        self.assertEqual(exception[8:], b"compile_error_name_not_found:moovej:")

    def test_a_fault_is_an_error_message_and_then_a_stop(self):
        primary = self.dial(self.primary)
        self.state(primary)
        self.robot.say("fault grab CRITICAL it hit\\na \"table\"")
        error = self.message(primary, 6)
        self.assertEqual(struct.unpack(">iii", error[:12]), (999, 0, 3))
        self.assertEqual(error[20:], b'it hit\na "table"')

    def test_the_dashboard_greets_and_answers_each_line(self):
        link = self.dial(self.dashboard)
        lines = iter(link.readline, b"")
        self.assertEqual(next(lines), b"Connected: Universal Robots Dashboard Server\n")
        for line, answer in ((b"running", b"Program running: false"), (b"programState", b"STOPPED <unnamed>"),
                             (b"robotmode", b"Robotmode: RUNNING"), (b"power off", b"Powering off"),
                             (b"robotmode", b"Robotmode: POWER_OFF"), (b"nonsense", b"could not understand: 'nonsense'"),
                             (b"quit", b"Disconnected")):
            link.write(line + b"\n")
            self.assertEqual(next(lines), answer + b"\n")
        self.assertEqual(list(lines), [])

if __name__ == "__main__":
    support.main()
