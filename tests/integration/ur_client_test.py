"""The virtual Universal Robot as its maker's own clients find it. Address 127.0.155.10."""
import math
import pathlib
import struct
import subprocess
import tempfile
import time
import unittest

import support
import trb_fleet
from ur_client import Dashboard, Primary, Rtde, joints_of, robot_mode_of

ADDRESS = "127.0.155.10"
SPEED = 10
HOME = "movej([0, -1.57, 0, -1.57, 0, 0])"


class Controller(unittest.TestCase):
    SPEED = SPEED

    def setUp(self):
        self.robot = trb_fleet.Process(
            [support.PROGRAMS / "trb-virtual-ur", "--address", ADDRESS, "--port-base", "auto", "--speed", str(self.SPEED),
             *self.options()], pathlib.Path("/dev/null"), stdin=subprocess.PIPE)
        self.addCleanup(self.robot.stop)
        ready, _ = self.robot.wait_line("ready", 60)
        self.ports = list(map(int, ready.split()[1:]))

    def options(self):
        return []

    def kept(self, client):
        self.addCleanup(client.close)
        return client

    def primary(self):
        return self.kept(Primary(ADDRESS, self.ports[0]))

    def secondary(self):
        return self.kept(Primary(ADDRESS, self.ports[1]))

    def dashboard(self):
        return self.kept(Dashboard(ADDRESS, self.ports[2]))

    def rtde(self, version=2):
        client = self.kept(Rtde(ADDRESS, self.ports[3]))
        self.assertTrue(client.speak(version))
        return client

    def wait_answer(self, dashboard, line, wanted):
        deadline = time.monotonic() + 60
        while (answer := dashboard.ask(line)) != wanted:
            self.assertLess(time.monotonic(), deadline, f"{line}: {answer}")
        return answer


class Power(Controller):
    def test_brake_release_from_power_off_switches_the_power_on_by_itself(self):
        dashboard = self.dashboard()
        for way in (lambda: dashboard.ask("brake release"), lambda: self.primary().send("set robotmode run")):
            dashboard.ask("power off")
            self.wait_answer(dashboard, "robotmode", "Robotmode: POWER_OFF")
            way()
            self.wait_answer(dashboard, "robotmode", "Robotmode: RUNNING")

    def test_an_emergency_stop_takes_the_power_and_refuses_it(self):
        dashboard, primary = self.dashboard(), self.primary()
        self.robot.say("estop")
        self.wait_answer(dashboard, "safetystatus", "Safetystatus: ROBOT_EMERGENCY_STOP")
        self.assertEqual(dashboard.ask("robotmode"), "Robotmode: POWER_OFF")
        for line in ("power on", "brake release"):
            self.assertEqual(dashboard.ask(line), "Failed to execute: " + line)
        primary.send("power on\nset robotmode run")
        parts = primary.until(lambda parts: robot_mode_of(parts)[1])
        self.assertEqual(robot_mode_of(parts), (0, 1, 0, 0, 0, 3))
        self.assertEqual(dashboard.ask("robotmode"), "Robotmode: POWER_OFF")
        self.robot.say("clear")
        self.wait_answer(dashboard, "safetystatus", "Safetystatus: NORMAL")
        self.assertEqual(dashboard.ask("robotmode"), "Robotmode: POWER_OFF")
        self.assertEqual(dashboard.ask("power on"), "Powering on")
        self.assertEqual(dashboard.ask("robotmode"), "Robotmode: IDLE")


class Protection(Controller):
    SPEED = 1  # its 5 s are ours: what it refuses in them is asked in time

    def test_a_protective_stop_is_unlocked_after_5_s_and_not_before(self):
        dashboard, primary = self.dashboard(), self.primary()
        for _ in range(3):  # a stalled machine uses them up
            began = time.monotonic()
            self.robot.say("protective_stop")
            self.wait_answer(dashboard, "safetystatus", "Safetystatus: PROTECTIVE_STOP")
            self.assertEqual(dashboard.ask("close safety popup"), "closing safety popup")
            refused = dashboard.ask("unlock protective stop")
            primary.send("set unlock protective stop")
            status = dashboard.ask("safetystatus")
            if time.monotonic() - began < 4:
                break
            self.robot.say("clear")
            self.wait_answer(dashboard, "safetystatus", "Safetystatus: NORMAL")
        self.assertEqual(refused, "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective "
                                  "stop before unlocking")
        self.assertEqual(status, "Safetystatus: PROTECTIVE_STOP")
        self.wait_answer(dashboard, "unlock protective stop", "Protective stop releasing")
        self.assertEqual(dashboard.ask("safetystatus"), "Safetystatus: NORMAL")


class Talk(Controller):
    def options(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        (pathlib.Path(folder.name) / "wait.urp").write_text("def wait():\n  sleep(1000)\nend\n")
        return ["--programs", folder.name]

    def test_the_dashboard_answers_in_the_makers_words(self):
        dashboard = self.dashboard()
        self.assertEqual(dashboard.greeting, "Connected: Universal Robots Dashboard Server")
        self.assertRegex(dashboard.ask("PolyscopeVersion"), r"^URSoftware \d+\.\d+\.\d+\.\d+ \(.*\)$")
        for line, answer in (("popup hello", "showing popup"), ("close popup", "closing popup"), ("is in remote control", "true"),
                             ("get robot model", "UR3"), ("addToLog it began", "Added log message"),
                             ("get loaded program", "No program loaded"), ("play", "Failed to execute: play"),
                             ("load none.urp", "File not found: none.urp"), ("load wait.urp", "Loading program: wait.urp"),
                             ("get loaded program", "Loaded program: /programs/wait.urp"), ("play", "Starting program"),
                             ("programState", "PLAYING wait.urp"), ("pause", "Pausing program"), ("programState", "PAUSED wait.urp"),
                             ("play", "Starting program"), ("running", "Program running: true"), ("stop", "Stopped"),
                             ("programState", "STOPPED wait.urp"), ("quit", "Disconnected")):
            self.assertEqual(dashboard.ask(line), answer, line)
        self.assertRegex(self.dashboard().ask("get serial number"), r"^\d{11}$")


class Reach(Controller):
    def test_the_target_of_the_joints_follows_the_trajectory(self):
        secondary = self.secondary()
        secondary.send("movej([3.0, -1.57, 0, -1.57, 0, 0], t=10)")
        parts = secondary.until(lambda parts: robot_mode_of(parts)[3])
        actual, target, _ = joints_of(parts)
        self.assertLess(target[0], 2.5)
        self.assertAlmostEqual(target[0], actual[0], delta=0.01)

    def test_a_pose_out_of_reach_fails_at_once(self):
        primary = self.primary()
        primary.send("def far():\n  movej(p[10,0,0,0,0,0])\nend")
        source, _, body = primary.message(10)
        self.assertEqual(body[:8], (2).to_bytes(4, "big") + (3).to_bytes(4, "big"))
        self.assertIn(b"movej is unable to find an inverse kinematics solution", body)
        primary.send("movel(p[10,0,0,0,0,0])")
        _, _, body = primary.message(6)
        self.assertEqual(int.from_bytes(body[:4], "big"), 154)
        parts = primary.until(lambda parts: not robot_mode_of(parts)[3])
        self.assertAlmostEqual(joints_of(parts)[0][0], 0, delta=0.01)


class Packets(Controller):
    SIZES = {0: 47, 1: 251, 2: 37, 3: 75, 4: 101, 5: 225, 6: 445, 7: 61, 8: 9, 9: 53, 10: 43, 11: 26, 12: 8}

    def test_a_state_has_thirteen_parts_of_the_documents_sizes_on_both_ports(self):
        for client in (self.primary(), self.secondary()):
            self.assertEqual({part: len(body) + 5 for part, body in client.state().items()}, self.SIZES)

    def test_a_client_reads_the_calibration_the_configuration_and_the_tools_pose(self):
        parts = self.primary().state()
        calibration = struct.unpack(">6I24dI", parts[5])
        theta, a, d, alpha = (calibration[6 + i * 6:12 + i * 6] for i in range(4))
        self.assertEqual((theta, a[1:3]), ((0,) * 6, (-0.24365, -0.21325)))
        self.assertAlmostEqual(alpha[0], math.pi / 2)
        configuration = struct.unpack(">12d12d4dd24d4i", parts[6])
        self.assertAlmostEqual(configuration[1], 2 * math.pi)
        self.assertEqual(configuration[24:28], (1.05, 1.4, 0.25, 1.2))
        self.assertEqual((configuration[29:35], configuration[35:41]), (a, d))
        self.assertEqual(configuration[55], 3)  # a UR3
        pose = struct.unpack(">12d", parts[4])
        self.assertAlmostEqual(pose[1], -0.19425, delta=0.001)  # straight up, as the maker shows it
        self.assertAlmostEqual(pose[2], 0.69415, delta=0.001)

    def test_inputs_outputs_the_tool_and_the_safety_mode_are_told(self):
        primary = self.primary()
        self.robot.say("input 3 on")
        primary.send("def io():\n  set_standard_digital_out(5, True)\n  set_tcp(p[0,0,0.2,0,0,0])\nend")
        parts = primary.until(lambda parts: struct.unpack(">2I", parts[3][:8]) == (8, 32))
        primary.until(lambda parts: struct.unpack(">12d", parts[4])[8] == 0.2)
        self.assertEqual(parts[3][60], 1)
        self.robot.say("protective_stop")
        primary.until(lambda parts: parts[3][60] == 3)

    def test_a_key_message_comes_from_the_controllers_interface(self):
        primary = self.primary()
        primary.send("def one():\n  sleep(0.1)\nend")
        source, _, body = primary.message(7)
        self.assertEqual((source, body[9:]), (0xfe, b"PROGRAM_XXX_STARTEDone"))


class Scripts(Controller):
    def texts(self, script):
        """What a program prints until it ends: texts, and the exception if there is one."""
        primary = self.primary()
        primary.state()
        primary.send(script)
        said = []
        while True:
            _, kind, body = primary.message(0, 7, 10)
            if kind == 10:
                said.append((*struct.unpack(">2i", body[:8]), body[8:].decode()))
            if kind == 0:
                said.append(body.decode())
            if b"compile_error" in body or (kind == 7 and b"STOPPED" in body):
                return said

    def test_loops_branches_functions_and_the_robots_state(self):
        said = self.texts("def all():\n  movej([0.5, -1.57, 0, -1.57, 0, 0], t=0.5)\n  q = get_actual_joint_positions()\n"
                          "  def twice(x):\n    return 2 * x\n  end\n  i = 0\n  while i < 3:\n    i = i + 1\n    sync()\n  end\n"
                          "  if i == 3 and q[0] > 0.4:\n    textmsg(twice(q[0]))\n  elif True:\n    textmsg(\"elif\")\n  else:\n"
                          "    textmsg(\"else\")\n  end\n  textmsg(norm(get_target_tcp_pose()[2] - get_actual_tcp_pose()[2]))\nend")
        self.assertEqual(said, ["1.000000", "0.000000"])

    def test_speeds_in_a_loop_move_the_arm_until_a_place(self):
        said = self.texts("def go():\n  while get_actual_joint_positions()[0] < 0.5:\n    speedj([1, 0, 0, 0, 0, 0], 5, 0.01)\n"
                          "  end\n  stopj(5)\n  textmsg(is_steady())\n  textmsg(get_actual_joint_positions()[0] > 0.49)\nend")
        self.assertEqual(said, ["True", "True"])

    def test_a_program_stops_itself_and_waits_for_an_input(self):
        primary, dashboard = self.primary(), self.dashboard()
        primary.send("def wait():\n  while not get_standard_digital_in(0):\n    sync()\n  end\n  protective_stop()\nend")
        self.wait_answer(dashboard, "running", "Program running: true")
        self.robot.say("input 0 on")
        self.wait_answer(dashboard, "safetystatus", "Safetystatus: PROTECTIVE_STOP")
        self.assertEqual(dashboard.ask("running"), "Program running: false")

    def test_errors_have_their_place_before_and_while_it_runs(self):
        self.assertEqual(self.texts("def a():\n  thread t():\n    sync()\n  end\nend"), [(2, 3, "compile_error_not_imitated:thread:")])
        self.assertEqual(self.texts("def a():\n  x = 0\n  x = 1 / x\nend"), [(3, 9, "runtime_error_division_by_zero:")])
        self.assertEqual(self.texts("def a():\n  while True:\n    x = 1\n  end\nend")[0][2], "runtime_error_infinite_loop:")


class Exchange(Controller):
    STATE = ["timestamp", "actual_q", "target_q", "actual_qd", "target_qd", "actual_TCP_pose", "robot_mode", "safety_status",
             "safety_mode", "runtime_state", "actual_digital_input_bits", "actual_digital_output_bits", "speed_scaling",
             "target_speed_fraction"]

    def test_the_handshake_the_types_and_the_rate(self):
        client = self.rtde()
        self.assertFalse(client.speak(7))
        self.assertEqual(client.controller()[:2], (5, 12))
        number, types = client.set_outputs(self.STATE, 50)
        self.assertEqual(number, 1)
        self.assertEqual(types, ["DOUBLE", *["VECTOR6D"] * 5, "INT32", "INT32", "INT32", "UINT32", "UINT64", "UINT64", "DOUBLE",
                                 "DOUBLE"])
        self.assertTrue(client.start())
        stamps = [client.data()["timestamp"] for _ in range(26)]
        # 50 a second of real time, in the robot's own time ten times as far apart; a loaded machine only makes it slower.
        self.assertGreaterEqual(stamps[-1] - stamps[0], 25 / 50 * SPEED * 0.9)
        self.assertTrue(client.pause())
        self.assertEqual(client.set_outputs(["actual_q", "no_such_thing"]), (0, ["VECTOR6D", "NOT_FOUND"]))
        self.assertFalse(client.start())

    def test_version_1_has_neither_rate_nor_recipe(self):
        client = self.rtde(1)
        self.assertEqual(client.set_outputs(["robot_mode", "actual_q"])[1], ["INT32", "VECTOR6D"])
        self.assertTrue(client.start())
        self.assertEqual(client.data()["robot_mode"], 7)

    def test_a_motion_a_stop_and_the_inputs_are_seen(self):
        client, primary = self.rtde(), self.primary()
        client.set_outputs(self.STATE, 100)
        client.start()
        primary.send("def go():\n  set_standard_digital_out(2, True)\n  movej([3.0, -1.57, 0, -1.57, 0, 0], t=20)\nend")
        moving = client.until(lambda data: data["actual_qd"][0] > 0 and data["runtime_state"] == 2)
        self.assertEqual((moving["robot_mode"], moving["safety_status"], moving["safety_mode"]), (7, 1, 1))
        self.assertEqual(moving["actual_digital_output_bits"], 4)
        self.assertLess(moving["target_q"][0], 3.0)
        self.assertEqual(moving["target_q"], moving["actual_q"])
        self.robot.say("input 1 on")
        client.until(lambda data: data["actual_digital_input_bits"] == 2)
        self.robot.say("protective_stop")
        stopped = client.until(lambda data: data["safety_status"] == 3)
        self.assertEqual((stopped["runtime_state"], stopped["actual_qd"]), (1, (0,) * 6))
        self.robot.say("estop")
        self.assertEqual(client.until(lambda data: data["safety_status"] == 7)["robot_mode"], 3)

    def test_inputs_move_the_slider_and_the_outputs_and_belong_to_one_client(self):
        client, other = self.rtde(), self.rtde()
        client.set_outputs(self.STATE, 100)
        slider, types = client.set_inputs(["speed_slider_mask", "speed_slider_fraction"])
        self.assertEqual(types, ["UINT32", "DOUBLE"])
        pins, _ = client.set_inputs(["standard_digital_output_mask", "standard_digital_output"])
        self.assertEqual(other.set_inputs(["speed_slider_mask", "none"]), (0, ["IN_USE", "NOT_FOUND"]))
        client.start()
        client.write(slider, 1, 0.25)
        client.write(pins, 0b1010, 0b1110)
        seen = client.until(lambda data: data["target_speed_fraction"] == 0.25 and data["actual_digital_output_bits"])
        self.assertEqual(seen["actual_digital_output_bits"], 0b1010)
        self.primary().send("movej([1.0, -1.57, 0, -1.57, 0, 0], v=1.0)")
        self.assertAlmostEqual(client.until(lambda data: data["actual_qd"][0] > 0)["actual_qd"][0], 0.25, delta=0.01)
        client.close()
        deadline = time.monotonic() + 10
        while other.set_inputs(["speed_slider_mask"])[0] == 0:
            self.assertLess(time.monotonic(), deadline)

    def test_a_text_a_wrong_package_and_a_lost_border(self):
        client = self.rtde()
        client.send("M", b"\x05hello\x02me\x03")
        self.robot.wait_line("rtde_text hello", 60)
        client.send("U", b"\x09")
        self.assertIn(b"no input recipe 9", client.answer("M"))
        client.link.sendall(b"\0\1v")
        self.assertEqual(client.stream.read(), b"")


if __name__ == "__main__":
    support.main()
