"""A Pioneer that is reached field by field: the program in C on it (config/robots/c/pioneer.c) between its node and the virtual
Pioneer, by the channel's cases and in a fleet. Addresses 127.0.206.x and 127.0.207.x."""
import json
import os
import signal
import socket
import subprocess
import unittest

import support
import trb_fleet

SPEED = 8.0
PROGRAM = support.PROGRAMS / "trb-field-pioneer"
DESCRIPTION = support.REPO / "config/robots/pioneer-fields.json"


class Channel(unittest.TestCase):
    def test_its_program_passes_every_case_of_the_field_channel(self):
        root = support.temporary_folder(self)
        address, node = "127.0.207.9", "127.0.206.9"
        for command in ([support.PROGRAMS / "trb-virtual-pioneer", "--address", address, "--die-with-parent"],
                        [PROGRAM, node, "40000", address, "8101", address]):
            self.addCleanup(trb_fleet.Process(command, root / "robot.log").stop)
        done = subprocess.run([support.PROGRAMS / "trb", "robot", "conform", DESCRIPTION, "--listen", f"{node}:40000",
                               "--large", "4000", "--json"], capture_output=True, text=True, timeout=120)
        rows = json.loads(done.stdout)["cases"]
        self.assertEqual([row for row in rows if row["verdict"] == "WRONG"], [])
        self.assertEqual({row["case"] for row in rows if row["verdict"] != "ok"},
                         {"no-acknowledge", "numbers", "chunks", "done", "stop-ends-skill", "stopped-refuses"})


    def test_a_session_that_ended_between_its_sync_and_its_open_is_dislodged(self):
        root = support.temporary_folder(self)
        address = "127.0.207.8"
        robot = trb_fleet.Process([support.PROGRAMS / "trb-virtual-pioneer", "--address", address, "--die-with-parent"], root / "robot.log")
        self.addCleanup(robot.stop)
        robot.wait_line("8101", 60)
        with socket.create_connection((address, 8101), timeout=60) as gone:
            for number in range(3):
                gone.sendall(bytes([0xfa, 0xfb, 3, number, 0, number]))
                self.assertTrue(gone.recv(256))
        robot.wait_line("disconnected", 60)
        program = trb_fleet.Process([PROGRAM, "127.0.206.8", "40000", address, "8101", address], root / "program.log")
        self.addCleanup(program.stop)
        robot.wait_line("command 1", 60)  # OPEN


class InAFleet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=206, robots={"pioneer2": trb_fleet.DEMO_ROBOTS["pioneer2"]}, speed=SPEED)
        cls.fleet.start()
        cls.fleet.wait_formed(60)

    def setUp(self):
        self.robot = self.fleet.virtual["pioneer2"]
        self.fleet.pump()  # what the last test has left is no word of this one
        self.start = len(self.robot.lines)

    def trb(self, *words, check=True):
        return self.fleet.trb(*words, node="cloud", check=check)

    def send(self, *words):
        return self.trb("send", "pioneer2", "command", *words, "--take")

    def position(self):
        return [float(word) for word in self.fleet.json("request", "pioneer2", "position", node="cloud")["data"].split()]

    def stands_near(self, x, y):
        """True if the robot, when it stopped last, was within 6 cm of there (m, in the hall)."""
        at = [line.split()[1:] for line in self.robot.lines[self.start:] if line.startswith("at ")]
        return bool(at) and abs(float(at[-1][0]) - x) < 0.06 and abs(float(at[-1][1]) - y) < 0.06

    def go(self, place):
        path = self.fleet.root / "go.json"
        path.write_text(json.dumps({"name": "go", "tasks": [
            {"id": "go", "robot": "pioneer2", "skill": "go_to", "data": {"place": place}}]}))
        return self.fleet.json("scenario", "run", path, node="cloud")["run"]

    def go_far(self):
        """To the farther one of two places, until it drives."""
        x, y, _ = self.position()
        run = self.go("dock" if abs(x - 3000) + abs(y + 2000) < 1500 else "ur3_front")
        self.robot.wait_line("command 8 ", 60, self.start)
        return run

    def state(self, run):
        return self.fleet.json("scenario", "watch", run, "--once", node="cloud", check=False)["tasks"][0]

    def wait_state(self, run, wanted):
        self.fleet.wait(f"the task is {wanted}", lambda: self.state(run)["state"] == wanted, 60)
        return self.state(run)

    def test_it_is_reached_in_the_interpreter_mode_and_goes_where_the_hall_s_places_are(self):
        x, y, _ = self.position()
        if abs(x - 3000) + abs(y + 2000) < 500:  # it stands there already: a robot that need not move tells no place
            self.wait_state(self.go("dock"), "FINISHED")
        task = self.wait_state(self.go("ur3_front"), "FINISHED")
        self.assertEqual((task["mode"], task["transport"]), ("interpreter", "lines"))
        # The robot's own word may be read after the task's result.
        self.fleet.wait("it stands there", lambda: self.stands_near(5, 1), 60)
        x, y, _ = self.position()  # its own, mm, from where it was switched on: 2, 3
        self.assertAlmostEqual(x, 3000, delta=60)
        self.assertAlmostEqual(y, -2000, delta=60)
        self.fleet.json("request", "pioneer2", "battery", node="cloud")

    def test_words_by_hand_call_functions_that_drive_it_and_a_way_behind_its_origin_is_behind(self):
        heading = self.position()[2]
        self.send("turn", "90")
        self.robot.wait_line("command 13 90", 60, self.start)
        self.fleet.wait("it has turned", lambda: abs((self.position()[2] - heading + 180) % 360 - 270) < 2, 60)
        before = self.position()
        self.send("move", "-300")
        self.robot.wait_line("command 8 -300", 60, self.start)
        self.fleet.wait("it has moved", lambda: sum(abs(a - b) for a, b in zip(before, self.position())) > 250, 60)
        self.assertTrue(all(abs(number) < 16_000 for number in self.position()))

    def test_a_stop_on_the_way_stands_and_is_confirmed(self):
        run = self.go_far()
        self.assertIn("confirmed", self.trb("stop", "pioneer2").stdout)
        self.robot.wait_line("command 55", 60, self.start)
        self.assertIn("confirmed", self.trb("release", "pioneer2").stdout)
        self.trb("scenario", "abort", run, check=False)

    def test_a_fault_is_told_by_the_program_and_its_end_too(self):
        run = self.go_far()
        self.trb("robot", "fault", "pioneer2", "mobile", "--text", "a box")
        self.fleet.wait("the task has failed", lambda: self.state(run)["state"] == "FAILED", 60)
        # The table comes another way than the task's result.
        self.fleet.wait("the table has it", lambda: "mobile out of use, CRITICAL" in self.trb("robot", "list").stdout, 60)
        listed = self.trb("robot", "list").stdout
        self.assertIn("the motors are off", listed)
        self.trb("robot", "fault", "pioneer2", "--clear")
        self.trb("release", "pioneer2")
        self.fleet.wait("it is over", lambda: "out of use," not in self.trb("robot", "list").stdout, 60)
        self.trb("scenario", "abort", run, check=False)

    def test_who_has_lost_its_robot_is_offline_until_it_is_back(self):
        self.robot.stop(signal.SIGKILL)
        self.fleet.wait("it is gone", lambda: not self.fleet.formed(), 60)
        self.fleet.start_robot("pioneer2")
        self.fleet.wait("it is back", self.fleet.formed, 60)
        self.assertLess(abs(self.position()[0]), 1)

    def test_who_has_lost_its_node_stands(self):
        run = self.go_far()
        os.kill(self.fleet.pid("pioneer2", "mode-adapter"), signal.SIGKILL)
        self.robot.wait_line("command 55", 60, self.start)
        self.fleet.wait("it is served again", self.fleet.formed, 60)
        self.trb("scenario", "abort", run, check=False)


if __name__ == "__main__":
    support.main()
