"""A Universal Robot: real router, scheduler and mode-adapter against trb-virtual-ur. Addresses 127.0.152.x to 127.0.155.x.

Its wire alone: ur_wire_test.py.
"""
import json
import re
import signal
import threading
import unittest

import support
import trb_fleet

HOME = [0, -1.57, 0, -1.57, 0, 0]
FAR = [6.2, -1.57, 0, -1.57, 0, 0]  # some 6 s away from HOME
UNHARMED = [("a quote", 'say "hi"'), ("a newline", "two\nlines"), ("both", '"\n")\nhalt\n(')]


class UrFleet(trb_fleet.Fleet):
    """One arm, its node, a cloud that gets its reports, and a virtual controller with fault injection."""

    def __init__(self, root, programs, block=152):
        super().__init__(root, programs, block=block, udp_port=50000 + block, robots={"ur3": ("ur", "ur3", [])})

    def make_node(self, node):
        super().make_node(node)
        if node == trb_fleet.CLOUD:
            return
        # Words for what a maker would not ship: a typing error, and a text of the user's.
        path = self.dir(node) / "commands.json"
        path.write_text(path.read_text().replace(
            '"move": "movej({data})"', '"move": "movej({data})", "typo": "moovej({data})", "line": "movel(p{data})", "say": "textmsg({data})", '
            '"say_two": "textmsg({0})\\nset_digital_out({1}, True)"'))
        path = self.dir(node) / "robots" / "ur3.json"
        path.write_text(path.read_text().replace('"skills": {', '''"skills": {
            "hasty": {"capability": "reach", "parameters": {"joints": {"type": "numbers", "count": 6, "unit": "rad"}},
                      "command": {"subtype": "move", "data": "{joints}"}, "end": {"kind": "acknowledgement"}, "timeout_s": 1},
            "once": {"capability": "reach", "parameters": {"joints": {"type": "numbers", "count": 6, "unit": "rad"}},
                     "command": {"subtype": "move", "data": "{joints}"}, "end": {"kind": "acknowledgement"}},''', 1))

    @property
    def robot(self):
        return self.virtual["ur3"]

    def ur(self, *words, check=True):
        return self.trb(*words, node="ur3", check=check)

    def send(self, subtype, data="", check=False):
        """A person's command that takes the arm over from any run."""
        return self.ur("send", "ur3", "command", subtype, data, "--take", check=check)

    def profile(self):
        routes = self.json("route", "list", node="ur3")["routes"]
        return next(route for route in routes if route["id"] == "ur3")["profile"]

    def wait_robot(self, state, timeout=60):
        return self.wait(f"the robot is {state}", lambda: self.profile()["robot"] == state, timeout)

    def mode(self):
        done = self.ur("request", "ur3", "robot_mode", check=False)
        return done.stdout.strip().rpartition(" ")[2]


class Case(unittest.TestCase):
    FLEET = UrFleet

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, cls.FLEET)
        cls.fleet.start()
        cls.fleet.wait_formed(60)
        cls.tap = support.Tap(cls.fleet, "ur3")
        cls.addClassCleanup(cls.tap.child.stop)

    def setUp(self):
        if "ur3" not in self.fleet.virtual:
            self.fleet.start_robot("ur3")
        self.fleet.robot.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE")
        self.fleet.ur("robot", "fault", "ur3", "--clear")
        for subtype in ("power_on", "run_mode"):
            self.fleet.send(subtype)
        self.fleet.wait("the arm can move", lambda: self.fleet.mode() == "7", 60)
        self.start = len(self.lines())
        self.tap.child.drain()
        self.tap.start = len(self.tap.child.lines)

    def lines(self):
        self.fleet.robot.pump(0)
        return self.fleet.robot.lines

    def said(self):
        """What the controller has printed since the test began."""
        return self.lines()[self.start:]

    def wait_line(self, text, timeout=60):
        line, _ = self.fleet.robot.wait_line(text, timeout, self.start)
        return line

    def refusal(self, subtype, data=""):
        done = self.fleet.send(subtype, data)
        self.assertEqual(done.returncode, 1, done.stdout)
        return done.stderr

    def moves(self, joints=HOME):
        done = self.fleet.send("move", json.dumps(joints))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("started", done.stdout)

    def run_skill(self, skill, **data):
        """Submits a run of one task; returns its id."""
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps({"name": "one", "tasks": [{"id": "t", "robot": "ur3", "skill": skill, "data": data}]}))
        return self.fleet.json("scenario", "run", path, node="ur3")["run"]

    def task(self, run):
        view = self.fleet.json("scenario", "watch", run, "--once", node="ur3", check=False)
        return next(iter(view.get("tasks", [])), {"outcome": "none"})

    def wait_end(self, run, timeout=60):
        self.fleet.wait("the task has an outcome", lambda: self.task(run)["outcome"] != "none", timeout)
        return self.task(run)

    def assert_finished(self, run):
        task = self.wait_end(run)
        self.assertEqual(task["outcome"], "finished", task)

    def programs(self):
        return [line for line in self.said() if re.fullmatch(r"program trb_\d+_\d+ started", line)]

    def abort(self, run):
        self.fleet.ur("scenario", "abort", run, check=False)


class Scripts(Case):
    def test_a_bad_script_is_refused_with_line_and_column_and_the_next_one_runs(self):
        error = self.refusal("typo", json.dumps(HOME))
        self.assertIn("robot_error", error)
        self.assertRegex(error, r"line \d+, column \d+: compile_error_name_not_found:moovej:")
        self.moves()

    def test_a_wrong_joint_count_is_refused_in_the_controllers_words(self):
        self.assertIn("compile_error_wrong_joint_count", self.refusal("move", "[1, 2]"))
        self.assertEqual(self.programs(), [])
        self.moves()

    def test_a_pose_out_of_reach_is_not_sent_and_what_the_controller_knows_is_told(self):
        self.assertIn("10 m away from the arm's shoulder", self.refusal("line", "[10, 0, 0.15, 0, 0, 0]"))
        self.assertEqual(self.programs(), [])
        done = self.fleet.ur("request", "ur3", "reach")
        self.assertIn("0.6071", done.stdout)  # by the calibration that the controller sends
        self.assertIn("true", self.fleet.ur("request", "ur3", "power").stdout)
        self.assertRegex(self.fleet.ur("request", "ur3", "tool").stdout, r"\[-?\d+\.\d{4}(,-?\d+\.\d{4}){5}\]")

    def test_a_quote_or_a_newline_in_any_text_field_never_reaches_the_script(self):
        for name, text in UNHARMED:
            for subtype, data in (("say", json.dumps(text)), ("say_two", json.dumps([text, 1])), ("move", text),
                                  ("move", json.dumps(text)), ("move", json.dumps([0, 0, 0, 0, 0, text])), ("pick", text)):
                with self.subTest(name, subtype=subtype, data=data):
                    self.assertRegex(self.refusal(subtype, data), "not_escapable|bad_value")
        self.assertEqual(self.said(), [])
        self.assertEqual(self.fleet.send("say", '"hello; world"').returncode, 0)
        self.wait_line("text hello; world")

    def test_a_quote_or_a_newline_in_a_skills_parameter_fails_its_task(self):
        for name, text in UNHARMED:
            with self.subTest(name):
                path = self.fleet.root / "scenario.json"
                task = {"id": "t", "robot": "ur3", "skill": "pick", "data": {"side": text}}
                path.write_text(json.dumps({"name": "one", "tasks": [task]}))
                done = self.fleet.ur("scenario", "run", path, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn("side", done.stderr)
        self.assertEqual(self.programs(), [])

    def test_two_commands_at_once_are_taken_one_after_the_other_and_each_once(self):
        answers = []
        senders = [threading.Thread(target=lambda joints=joints: answers.append(self.fleet.send("move", json.dumps(joints))))
                   for joints in (FAR, HOME)]
        for sender in senders:
            sender.start()
        for sender in senders:
            sender.join()
        self.assertEqual([done.returncode for done in answers], [0, 0], [done.stderr for done in answers])
        self.assertEqual(len(self.programs()), 2)
        self.assertNotIn("script_error", str(self.said()))

    def test_a_command_beside_a_skill_is_refused_and_the_skill_goes_on(self):
        run = self.run_skill("move_joints", joints=[1.5, -1.57, 0, -1.57, 0, 0])
        self.wait_line("started")
        done = self.fleet.ur("send", "ur3", "command", "move", json.dumps(HOME), check=False)
        self.assertIn("control_held", done.stderr)
        self.assertIn("busy", self.refusal("move", json.dumps(HOME)))
        self.assert_finished(run)
        self.assertEqual(len(self.programs()), 1)


class Stops(Case):
    def test_a_protective_stop_in_the_middle_of_a_move(self):
        run = self.run_skill("once", joints=FAR)
        self.wait_line("started")
        text = 'it hit a "table"\nhard'
        self.fleet.ur("robot", "fault", "ur3", "grab", "--text", text)
        self.wait_line("safety protective_stop")
        task = self.wait_end(run)
        self.assertEqual(task["outcome"], "failed", task)
        self.assertIn("protective stop: C999A0 " + text, task["reason"])
        for capability in ("grab", "reach"):
            fault = self.tap.wait("robot_fault", "the fault", lambda body, wanted=capability: body["capability"] == wanted)
            self.assertEqual((fault["severity"], fault["text"]), ("CRITICAL", "protective stop: C999A0 " + text))
        error = self.refusal("move", json.dumps(HOME))
        self.assertIn("trb send ur3 command unlock", error)
        self.assertEqual(len(self.programs()), 1)  # nothing was repeated
        self.abort(run)
        # The controller refuses it for 5 s of its own time.
        self.fleet.wait("it is unlocked", lambda: self.fleet.send("unlock", check=True) and "safety normal" in self.said(), 60)
        self.fleet.wait("it moves", lambda: self.fleet.send("move", json.dumps(HOME)).returncode == 0, 60)

    def test_an_emergency_stop_is_fatal_and_a_warning_stops_nothing(self):
        self.fleet.ur("robot", "fault", "ur3", "reach", "--severity", "WARNING", "--text", "joint 3 is warm")
        self.tap.wait("robot_fault", "the warning", lambda body: (body["severity"], body["text"]) == ("WARNING", "C999A0 joint 3 is warm"))
        self.moves()
        self.fleet.ur("robot", "fault", "ur3", "reach", "--severity", "FATAL")
        self.tap.wait("robot_fault", "the emergency stop", lambda body: body["severity"] == "FATAL" and "emergency stop" in body["text"])
        self.assertIn("release the emergency stop", self.refusal("move", json.dumps(HOME)))

    def test_the_arm_is_powered_off_and_on_by_commands_and_the_fleet_is_told(self):
        def mode(wanted):
            return lambda body: {"name": "robot_mode", "value": wanted} in body["values"]

        self.assertEqual(self.fleet.send("power_off").returncode, 0)
        off = self.tap.wait("robot_state", "power off", mode("3"))
        self.assertEqual([value["name"] for value in off["values"]], ["robot_mode", "safety", "program_running", "joints", "power", "tool"])
        self.tap.wait("robot_fault", "the fault of the description", lambda body: body["text"] == "the arm is powered off: robot_mode is 3")
        error = self.refusal("move", json.dumps(HOME))
        self.assertIn("powered off", error)
        self.assertIn("trb send ur3 command power_on", error)
        self.assertEqual(self.programs(), [])
        self.fleet.send("power_on", check=True)
        self.tap.wait("robot_state", "idle", mode("5"))
        self.assertIn("trb send ur3 command run_mode", self.refusal("move", json.dumps(HOME)))
        self.fleet.send("run_mode", check=True)
        # The newest state: it was running before, too.
        self.fleet.wait("running", lambda: mode("7")(self.tap.bodies("robot_state")[-1]), 60)
        self.moves()

    def test_a_robot_that_has_not_ended_in_time_is_stopped_and_its_late_word_harms_nobody(self):
        run = self.run_skill("hasty", joints=FAR)
        task = self.wait_end(run)
        self.assertEqual(task["outcome"], "failed", task)
        self.assertIn("timed out after 1 s", task["reason"])
        self.wait_line("stopped")
        self.abort(run)
        after = self.run_skill("move_joints", joints=HOME)
        self.assert_finished(after)
        self.assertEqual(len(self.programs()), 2)


class Vanished(Case):
    def end_of(self, run):
        task = self.wait_end(run)
        self.assertEqual(task["outcome"], "interrupted", task)
        # Either of the controller's two connections may end first.
        self.assertRegex(task["reason"], "connection( to the robot's controller)? was lost")

    def test_a_controller_that_is_killed_in_the_middle_of_a_program(self):
        run = self.run_skill("once", joints=FAR)
        self.wait_line("started")
        self.fleet.virtual.pop("ur3").stop(signal.SIGKILL)
        self.fleet.wait_robot("CONNECTION_BROKEN")
        self.end_of(run)
        self.assertIn("robot_offline", self.refusal("move", json.dumps(HOME)))
        self.abort(run)
        self.fleet.start_robot("ur3")
        self.start = 0
        self.fleet.wait_robot("ONLINE")
        self.fleet.wait("it moves", lambda: self.fleet.send("move", json.dumps(HOME)).returncode == 0, 60)
        self.assertEqual(len(self.programs()), 1)  # the one just sent: nothing was repeated

    def test_a_controller_that_hangs_in_the_middle_of_a_program(self):
        run = self.run_skill("once", joints=FAR)
        self.wait_line("started")
        self.fleet.robot.child.send_signal(signal.SIGSTOP)
        self.fleet.wait_robot("CONNECTION_BROKEN")
        self.assertIn("no state for 3 s", self.fleet.profile()["detail"])
        self.end_of(run)
        self.abort(run)
        self.fleet.robot.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE")
        self.fleet.wait("it moves", lambda: self.fleet.send("move", json.dumps(HOME)).returncode == 0, 60)
        self.assertEqual(len(self.programs()), 2)

    def test_of_a_skill_that_times_out_while_the_controller_hangs_nobody_knows_and_the_arm_is_halted_once_it_is_back(self):
        run = self.run_skill("hasty", joints=FAR)
        self.wait_line("started")
        self.fleet.robot.child.send_signal(signal.SIGSTOP)
        task = self.wait_end(run)
        self.assertEqual(task["outcome"], "interrupted", task)
        self.assertIn("timed out after 1 s, and nobody knows whether the robot was halted", task["reason"])
        self.abort(run)
        self.fleet.robot.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE")
        self.wait_line("stopped")
        self.assert_finished(self.run_skill("move_joints", joints=HOME))
        self.assertEqual(len(self.programs()), 2)


class FaultsByWord(Case):
    def test_what_cannot_be_done_is_refused_with_the_way_out(self):
        done = self.fleet.ur("robot", "fault", "ur3", "fly", check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("has no capability 'fly'", done.stderr)
        self.assertIn("grab, reach", done.stderr)
        for wrong in (["robot", "fault", "ur3"], ["robot", "fault", "ur3", "grab", "--clear"],
                      ["robot", "fault", "ur3", "grab", "--severity", "BAD"]):
            self.assertEqual(self.fleet.ur(*wrong, check=False).returncode, 2, wrong)

    def test_a_real_robot_is_not_made_to_fail(self):
        real = support.make_fleet(self, RealFleet)
        real.start()
        done = real.ur("robot", "fault", "ur3", "grab", check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("not_permitted", done.stderr)
        self.assertIn("fault_injection", done.stderr)


class RealFleet(UrFleet):
    """Its arm is not configured as a virtual one."""

    def __init__(self, root, programs):
        super().__init__(root, programs, block=154)

    def node_json(self, node):
        made = super().node_json(node)
        made.get("robot", {}).pop("fault_injection", None)
        return made

if __name__ == "__main__":
    support.main()
