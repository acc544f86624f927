"""ABB over RAPID: the virtual robot against a client written from the protocol alone, and a node against the virtual robot.

Addresses 127.0.150.x and 127.0.151.x.
"""
import json
import tempfile
import unittest
import arm_fleet
import support

ADDRESS = "127.0.151.100"


class Client:
    """Sends "CODE PARAMETER ... #" and reads "CODE OK VALUE ...#"."""

    def __init__(self, port):
        self.socket = arm_fleet.dial(ADDRESS, port)
        self.rest = b""

    def send(self, text):
        self.socket.sendall(text.encode())

    def answer(self):
        while b"#" not in self.rest:
            piece = self.socket.recv(4096)
            if not piece:
                raise EOFError
            self.rest += piece
        line, self.rest = self.rest.split(b"#", 1)
        return line.decode()

    def ask(self, text):
        self.send(text)
        return self.answer()


class Alone(unittest.TestCase):
    """No node: a client of its own for each task."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="trb-rapid-")
        self.addCleanup(self.folder.cleanup)
        self.robot, self.ports = arm_fleet.start_program(self, "trb-virtual-abb", "--address", ADDRESS, "--port", "auto")
        self.program, self.service = (Client(port) for port in self.ports)
        self.addCleanup(self.program.socket.close)
        self.addCleanup(self.service.socket.close)

    def test_a_move_blocks_its_answer_and_the_service_task_does_not(self):
        self.assertEqual(self.program.ask("4 #"), "4 1 0.00 0.00 0.00 0.00 30.00 0.00")
        self.program.send("2 30 0 0 0 30 0 #")
        self.robot.wait_line("start 2", 60)
        self.assertEqual(self.service.ask("90 #"), "90 1 0 1 1 0")
        self.assertEqual(self.program.answer(), "2 1")
        self.assertEqual(self.service.ask("4 #"), "4 1 30.00 0.00 0.00 0.00 30.00 0.00")

    def test_a_request_in_pieces_and_two_in_one(self):
        for c in "0 #":
            self.program.send(c)
        self.assertEqual(self.program.answer(), "0 1")
        self.program.send("20 1 #20 0 #")
        self.assertEqual((self.program.answer(), self.program.answer()), ("20 1", "20 1"))

    def test_a_string_of_more_than_80_characters_is_no_request(self):
        self.assertTrue(self.program.ask("40 " + "x" * 100 + " #").startswith("40 0 no%20end%20of%20the%20request"))
        self.assertTrue(self.program.answer().startswith("0 0 "))

    def test_a_stop_ends_the_move(self):
        self.program.send("2 160 0 0 0 30 0 #")
        self.robot.wait_line("start 2", 60)
        self.assertEqual(self.service.ask("91 #"), "91 1")
        self.assertEqual(self.program.answer(), "2 0 stopped")
        self.assertEqual(self.program.ask("2 0 0 0 0 30 0 #"), "2 0 stopped")
        self.assertEqual(self.service.ask("92 #"), "92 1")

    def test_a_fault_ends_the_move_and_switches_the_motors_off(self):
        self.program.send("2 160 0 0 0 30 0 #")
        self.robot.wait_line("start 2", 60)
        self.robot.say("fault grab CRITICAL collision")
        self.assertEqual(self.program.answer(), "2 0 collision")
        self.assertEqual(self.service.ask("90 #"), "90 1 0 0 0 50204 grab%20CRITICAL%20collision")
        self.assertEqual(self.program.ask("2 0 0 0 0 30 0 #"), "2 0 motors%20off")

    def test_one_client_at_a_time(self):
        other = Client(self.ports[0])
        self.addCleanup(other.socket.close)
        other.send("0 #")
        self.assertEqual(self.program.ask("0 #"), "0 1")
        self.program.socket.close()
        self.assertEqual(other.answer(), "0 1")


class Node(arm_fleet.ArmTest, unittest.TestCase):
    FRAMEWORK = "abb"
    BLOCK = 150
    BEGUN = "start 2"
    LOST, SILENT = "RAPID server was lost", "service task for 2 s"

    def test_a_command_moves_the_joints(self):
        self.assertEqual(self.send("move", "[10, 5, 5, 0, 35, 0]"), "started")
        self.said("done 2")

        def there():
            return json.loads(self.request("joints")["data"]) == [10, 5, 5, 0, 35, 0]

        self.fleet.wait("the joints are there", there, 60)
        self.assertEqual(len(json.loads(self.request("position")["data"])), 3)
        self.assertEqual(self.request("motors")["data"], "1")

    def test_a_quote_and_a_newline_in_a_text(self):
        self.assertEqual(self.send("show", json.dumps('say "hi"#\n91 #')), "started")
        self.said('text say "hi"#\\n91 #')

    def test_a_text_that_is_too_long_names_the_limit(self):
        error = self.refusal("show", json.dumps("x" * 100))
        self.assertEqual(error["code"], "too_large")
        self.assertIn("a RAPID string holds 80", error["what"])

    def test_an_unknown_word_is_refused_with_a_cure(self):
        error = self.refusal("wave", "1")
        self.assertEqual(error["code"], "no_field_channel")
        self.assertIn("commands.json", error["cure"])

    def test_wrong_joints_are_told(self):
        self.assertIn("takes 6 items, and the data has 2", self.refusal("move", "[1, 2]")["what"])
        self.assertIn("J2 160.0 is not in -110.0..110.0", self.refusal("move", "[0, 160, 0, 0, 0, 0]")["what"])
        outcome, reason = self.end_of(self.run_skill("move_joints", {"joints": [0, 0, 1.5, 0, 0, 0]}))
        self.assertEqual(outcome, "failed")
        self.assertIn("J3 85.9", reason)

    def test_a_skill_by_scenario(self):
        self.assertEqual(self.end_of(self.run_skill("pick", {"side": "left"})), ("finished", ""))
        self.said("gripper closed")

    def test_a_place_of_the_hall_in_the_robots_frame_and_units(self):
        self.assertEqual(self.end_of(self.run_skill("move_to", {"place": "right"}))[0], "finished")
        self.said("request 10 500 -400 0 0 #")

    def test_two_commands_at_once(self):
        run = self.begin_motion()
        self.assertEqual(self.refusal("go_home")["code"], "busy")
        self.assertEqual(self.end_of(run)[0], "finished")
        self.assertEqual(self.send("move", "[60, 0, 0, 0, 30, 0]"), "started")
        self.assertEqual(self.send("go_home"), "started")  # once the first is over

    def test_a_stop_in_the_middle(self):
        run = self.begin_motion()
        self.assertEqual(self.ask("stop", self.arm)["robots"][0]["state"], "confirmed")
        self.said("failed 2 stopped")
        self.assertEqual(self.refusal("go_home")["code"], "fenced")
        self.assertEqual(self.end_of(run)[0], "interrupted")
        self.fleet.trb("release", self.arm, node=arm_fleet.CLOUD)
        self.said("released")
        self.assertEqual(self.send("go_home"), "started")

    def test_a_fault_in_the_middle_of_a_move(self):
        tap = self.start_tap(self.arm)
        run = self.begin_motion()
        self.fleet.robot.say("fault grab CRITICAL gripper lost air")
        self.assertIn("gripper lost air", tap.wait_line('"robot_fault"', 60)[0])
        outcome, reason = self.end_of(run)
        self.assertEqual(outcome, "failed")
        self.assertIn("gripper lost air", reason)
        self.fleet.wait("the motors are off", lambda: self.request("motors")["data"] == "0", 60)
        self.assertIn("panel", self.refusal("go_home")["cure"])

    def test_an_answer_after_the_time_out_is_late(self):
        run = self.begin_motion(timeout_s=1)
        outcome, reason = self.end_of(run)
        self.assertEqual(outcome, "failed")
        self.assertIn("timed out after 1 s", reason)
        self.said("stopped")
        self.said("released")
        self.assertEqual(self.send("go_home"), "started")


if __name__ == "__main__":
    support.main()
