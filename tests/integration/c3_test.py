"""KUKA over C3: the virtual robot against a client written from the protocol alone, and a node against the virtual robot.

Addresses 127.0.148.x and 127.0.149.x.
"""
import json
import re
import struct
import tempfile
import unittest
import arm_fleet
import support
from arm_fleet import CLOUD

ADDRESS = "127.0.149.100"


class Client:
    """Reads and writes variables: u16 tag, u16 length, u8 type, texts with a u16 length; a footer of u16 and u8."""

    def __init__(self, port):
        self.socket = arm_fleet.dial(ADDRESS, port)
        self.tag = 40000

    def ask(self, kind, *texts):
        self.tag += 1
        body = bytes([kind]) + b"".join(struct.pack(">H", len(t)) + t.encode() for t in texts)
        self.socket.sendall(struct.pack(">HH", self.tag, len(body)) + body)
        return self.answer()

    def answer(self):
        tag, length = struct.unpack(">HH", self.take(4))
        body = self.take(length)
        error, ok = struct.unpack(">HB", body[-3:])
        value = body[3:-3].decode() if len(body) > 4 else None
        return tag, body[0], value, error, ok

    def take(self, count):
        data = b""
        while len(data) < count:
            piece = self.socket.recv(count - len(data))
            if not piece:
                raise EOFError
            data += piece
        return data

    def read(self, name):
        tag, kind, value, error, ok = self.ask(0, name)
        assert (tag, kind) == (self.tag, 0)
        return value if ok else None

    def write(self, name, value):
        tag, kind, _, _, ok = self.ask(1, name, value)
        assert (tag, kind) == (self.tag, 1)
        return bool(ok)


class Alone(unittest.TestCase):
    """No node: a C3 client of its own."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="trb-c3-")
        self.addCleanup(self.folder.cleanup)
        self.robot, (self.port,) = arm_fleet.start_program(self, "trb-virtual-kuka", "--address", ADDRESS,
                                                           "--port", "auto", "--speed", "20")
        self.client = Client(self.port)
        self.addCleanup(self.client.socket.close)

    def test_golden_packets(self):
        self.client.socket.sendall(bytes.fromhex("0001 000a 00 0007") + b"$OV_PRO")
        self.assertEqual(self.client.take(13), bytes.fromhex("0001 0009 00 0003") + b"100" + bytes.fromhex("0001 01"))
        self.client.socket.sendall(bytes.fromhex("0002 000e 01 0007") + b"$OV_PRO" + bytes.fromhex("0002") + b"50")
        self.assertEqual(self.client.take(12), bytes.fromhex("0002 0008 01 0002") + b"50" + bytes.fromhex("0001 01"))

    def test_an_unknown_variable_and_a_wrong_value_are_answered_with_the_error(self):
        self.assertEqual(self.client.ask(0, "NOBODY")[2:], ("", 0, 0))
        self.assertEqual(self.client.ask(1, "TRB_STOP", "maybe")[2:], ("", 0, 0))
        self.assertEqual(self.client.ask(1, "TRB_DATA[]", '"' + "x" * 129 + '"')[2:], ("", 0, 0))
        self.assertEqual(self.client.ask(1, "TRB_DATA[]", '"a"b"')[2:], ("", 0, 0))
        self.assertEqual(self.client.ask(12)[1:], (12, None, 7, 0))

    def test_a_request_in_pieces_and_two_in_one(self):
        packet = bytes.fromhex("0007 0007 00 0004") + b"PING"
        for i in range(len(packet)):
            self.client.socket.sendall(packet[i:i + 1])
        self.assertEqual(self.client.answer()[:3], (7, 0, "PONG"))
        self.client.socket.sendall(packet + packet)
        self.assertEqual(self.client.answer()[2], "PONG")
        self.assertEqual(self.client.answer()[2], "PONG")

    def test_lengths_that_contradict_each_other_end_the_connection(self):
        self.client.socket.sendall(bytes.fromhex("0007 0003 00 0004"))
        self.assertEqual(self.client.answer()[3:], (9, 0))
        with self.assertRaises(EOFError):
            self.client.take(1)

    def test_several_clients_see_one_robot(self):
        other = Client(self.port)
        self.addCleanup(other.socket.close)
        self.assertTrue(self.client.write("$OV_PRO", "33"))
        self.assertEqual(other.read("$ov_pro"), "33")

    def test_each_variable_begins_as_trb_dat_has_it(self):
        text = (support.REPO / "config/robots/kuka/trb.dat").read_text().split("; Of the program alone.")[0]
        declared = re.findall(r"^DECL GLOBAL (INT|BOOL|E6AXIS|E6POS) (\w+)=(\{.*\}|\w+)", text, re.MULTILINE)
        self.assertGreater(len(declared), 10)
        for kind, name, value in declared:
            told = self.client.read(name)
            if kind in ("INT", "BOOL"):
                self.assertEqual(told, value, name)
            else:
                number = re.compile(r"(\w+) (-?[\d.]+)")
                self.assertEqual({part: float(is_) for part, is_ in number.findall(told)},
                                 {part: float(is_) for part, is_ in number.findall(value)}, name)

    def test_the_position_moves_and_the_end_is_told(self):
        client = self.client
        before = client.read("$POS_ACT")
        self.assertRegex(before, r"^\{E6POS: X [-0-9.]+, Y .*, S 2, T 35, E1 0.0000,")
        client.write("TRB_AXIS", "{E6AXIS: A1 90, A2 -90, A3 90, A4 0, A5 0, A6 0}")
        client.write("TRB_TYPE[]", '"command"')
        client.write("TRB_SUBTYPE[]", '"move"')
        client.write("TRB_NUMBER", "5")
        client.write("TRB_COMMAND", "TRUE")
        self.robot.wait_line("done 5 move", 60)
        self.assertEqual(client.read("TRB_DONE"), "TRUE")
        self.assertEqual(client.read("TRB_DONE_NUMBER"), "5")
        self.assertNotEqual(client.read("$POS_ACT"), before)

    def test_a_fault_stops_the_program(self):
        self.robot.say("fault grab CRITICAL air lost")
        self.robot.wait_line("fault grab", 60)
        self.assertEqual(self.client.read("$STOPMESS"), "TRUE")
        self.assertEqual(self.client.read("TRB_ERROR[]"), '"grab CRITICAL air lost"')
        self.robot.say("fault reach FATAL")
        self.robot.wait_line("fault reach", 60)
        self.assertEqual(self.client.read("$ALARM_STOP"), "FALSE")
        self.robot.say("clear")
        self.robot.wait_line("cleared", 60)
        self.assertEqual(self.client.read("$STOPMESS"), "FALSE")


class Node(arm_fleet.ArmTest, unittest.TestCase):
    FRAMEWORK = "kuka"
    BLOCK = 148
    BEGUN = "start grasp_and_put_down"
    LOST, SILENT = "was lost", "no answer for 2 s"

    def test_a_command_moves_the_axes(self):
        self.assertEqual(self.send("move", "[10, -80, 80, 0, 5, 0]"), "started")
        self.said("start move 10.00 -80.00 80.00 0.00 5.00 0.00")
        self.said("done")

        def there():
            return json.loads(self.request("joints")["data"]) == [10, -80, 80, 0, 5, 0]

        self.fleet.wait("the axes are there", there, 60)
        self.assertEqual(len(json.loads(self.request("position")["data"])), 6)

    def test_an_unknown_word_goes_field_by_field_with_a_quote_and_a_newline(self):
        data = 'say "hi"\nor \\q' + "x" * 200
        self.assertEqual(self.send("wave", data), "started")
        self.said(f"message command wave {CLOUD} {len(data)} " + 'say "hi"\\nor \\\\q' + "x" * 200)

    def test_information_moves_nothing(self):
        for name in ("go_home", "greeting"):
            self.fleet.trb("send", self.arm, "information", name, node=CLOUD)
        self.said("message information greeting")
        self.assertEqual(self.send("wave", "1"), "started")
        self.said("message command wave")
        self.assertFalse([line for line in self.fleet.robot.lines[self.start:] if "go_home" in line])

    def test_a_request_of_the_programs_own(self):
        self.assertEqual(self.request("gripper")["data"], "open")
        self.assertIn("unknown request", self.request("weather")["error"]["what"])

    def test_text_never_becomes_krl(self):
        for data in ('["a\\"b",0,0,0,0,0]', '["two\\nlines",0,0,0,0,0]', "1}\nTRB_STOP = TRUE"):
            self.assertIn(self.refusal("move", data)["code"], ("not_escapable", "bad_value"), data)

    def test_wrong_joints_are_told(self):
        self.assertIn("takes 6 items, and the data has 2", self.refusal("move", "[1, 2]")["what"])
        self.assertIn("A2 60.0 is not in -190.0..45.0", self.refusal("move", "[0, 60, 0, 0, 0, 0]")["what"])
        outcome, reason = self.end_of(self.run_skill("move_joints", {"joints": [0, 1.5, 0, 0, 0, 0]}))
        self.assertEqual(outcome, "failed")
        self.assertIn("A2 85.9", reason)

    def test_a_skill_by_scenario(self):
        outcome, reason = self.end_of(self.run_skill("pick", {"side": "left"}))
        self.assertEqual((outcome, reason), ("finished", ""))
        self.said("gripper closed")

    def test_a_place_of_the_hall_in_the_robots_frame_and_units(self):
        self.assertEqual(self.end_of(self.run_skill("move_to", {"place": "right"}))[0], "finished")
        self.said("start move_to 500.00 -400.00 0.00 0.00 0.00 180.00")

    def test_two_commands_at_once(self):
        run = self.begin_motion()
        self.assertEqual(self.refusal("wave", "1")["code"], "busy")
        self.assertEqual(self.end_of(run)[0], "finished")
        self.assertEqual(self.send("move", "[60, -90, 90, 0, 0, 0]"), "started")
        self.assertEqual(self.send("go_home"), "started")  # once the first is over

    def test_a_stop_in_the_middle(self):
        run = self.begin_motion()
        self.assertEqual(self.ask("stop", self.arm)["robots"][0]["state"], "confirmed")
        self.said("stopped")
        self.assertEqual(self.refusal("wave", "1")["code"], "fenced")
        self.assertEqual(self.end_of(run)[0], "interrupted")
        self.fleet.trb("release", self.arm, node=CLOUD)
        self.said("released")
        self.assertEqual(self.send("go_home"), "started")

    def test_a_fault_in_the_middle_of_a_move(self):
        tap = self.start_tap(self.arm)
        run = self.begin_motion()
        self.fleet.robot.say("fault grab CRITICAL gripper lost air")
        self.said("fault grab")
        fault = json.loads(tap.wait_line('"robot_fault"', 60)[0])
        self.assertIn("gripper lost air", json.dumps(fault))
        outcome, reason = self.end_of(run)
        self.assertEqual(outcome, "failed")
        self.assertIn("gripper lost air", reason)
        self.assertIn("panel", self.refusal("go_home")["cure"])
        # After the person's restart the failed motion does not go on.
        self.fleet.robot.say("clear")
        self.said("failed")
        self.said("released")

    def test_an_end_after_the_time_out_is_late(self):
        run = self.begin_motion(timeout_s=1)
        outcome, reason = self.end_of(run)
        self.assertEqual(outcome, "failed")
        self.assertIn("timed out after 1 s", reason)
        self.said("failed")  # it was ordered to end the motion
        self.said("released")
        self.assertEqual(self.send("go_home"), "started")

    def test_a_program_that_does_not_run(self):
        self.fleet.robot.say("program cancel")
        self.said("program cancelled")
        self.assertIn("trb.src", self.refusal("wave", "1")["cure"])
        self.fleet.robot.say("program select")
        self.said("program selected")
        self.assertEqual(self.send("wave", "2"), "started")

    def test_the_robots_own_message_is_sent_on(self):
        tap = self.start_tap(self.arm)
        text = "long " * 60
        self.fleet.robot.say(f'say information greeting {CLOUD} "hello" {text}')
        message = json.loads(tap.wait_line('"subtype":"greeting","source":"kuka"', 60)[0])
        self.assertEqual((message["source"], message["data"]), (self.arm, f'"hello" {text}'))


if __name__ == "__main__":
    support.main()
