"""The direct mode in text over TCP: nodes and robots that are asked and answer in text, each in its own way, among them the
dashboard of a UR. Addresses 127.0.106.x and 127.0.107.x."""
import json
import time
import unittest

import support
import trb_fleet

BLOCK = 106
JOINTS = [0.5, -0.5, 0.5, 0, 0.5, 0]
PROGRAM = "def wait():\n  sleep(300)\nend\n"

WORDS = {
    "gated": {
        "transport": "tcp-dialogue", "port": 29999, "line_end": "crlf", "begin": ["$Login,secret"],
        "good": ["#*"], "bad": ["!*"], "poll_s": 0.2,
        "values": {"state": "$GetStatus -> #GetStatus,{0},* where 0100000001=0 0100000010=1"},
        "commands": {"run": "$Start,{0}", "stop": "$Stop", "release": ""}, "requests": {"state": "state"}},
    "alive": {
        "transport": "tcp-dialogue", "port": 29999, "good": ["OK"], "bad": ["ERROR*"], "poll_s": 60,
        "keep_alive": "PING", "keep_alive_s": 0.3,
        "values": {"state": "STATE -> STATE {0}"},
        "commands": {"go": "GOTO {0} {1} -> ARRIVED* else LOST*", "stop": "STOP", "release": "RESUME"},
        "requests": {"state": "state"}},
    "dash": {
        "transport": "tcp-dialogue", "port": 29999, "greeting": True, "poll_s": 0.2,
        "bad": ["Failed*", "File not found*", "Error*"],
        "values": {"running": "running -> Program running: {0} where true=1 false=0"},
        "commands": {"play": "load {0}\nplay", "stop": "stop", "release": ""}, "requests": {"running": "running"}},
}


def skill(capability, parameters, subtype, data, end):
    return {"capability": capability, "parameters": parameters, "command": {"subtype": subtype, "data": data}, "end": end,
            "timeout_s": 60}


NUMBER = {"type": "number"}
SKILLS = {
    "gated": {"run": skill("reach", {"program": NUMBER}, "run", "[{program}]",
                           {"kind": "state", "state": "state", "equals": 0})},
    "alive": {"go": skill("mobile", {"x": NUMBER, "y": NUMBER}, "go", "[{x}, {y}]", {"kind": "acknowledgement"})},
    "dash": {"play": skill("reach", {"program": {"type": "text"}}, "play", "[{program}]",
                           {"kind": "state", "state": "running", "equals": 0})},
}


class DialogueFleet(trb_fleet.Fleet):
    """A shipped Dobot; the others' files are the test's own."""

    def __init__(self, root, programs):
        robots = {"dobot": ("dobot", "dobot-cr5", []), "gated": ("gated", "dobot-cr5", []),
                  "alive": ("alive", "dobot-cr5", []), "dash": ("dash", "dobot-cr5", [])}
        super().__init__(root, programs, block=BLOCK, udp_port=50000 + BLOCK, robots=robots, cloud=False)

    def make_node(self, node):
        super().make_node(node)
        if node not in WORDS:
            return
        folder = self.dir(node)
        (folder / "profile.json").write_text(json.dumps({node: "direct"}))
        (folder / "commands.json").write_text(json.dumps({node: WORDS[node]}))
        capability = next(iter(SKILLS[node].values()))["capability"]
        (folder / "robots" / "dobot-cr5.json").write_text(json.dumps(
            {"maker": "Test", "model": node, "capabilities": [capability], "skills": SKILLS[node]}))

    def virtual_robot(self, node):
        address = ["--address", self.robot_address(node)]
        if node == "dash":
            programs = self.root / "programs"
            programs.mkdir()
            (programs / "wait.urp").write_text(PROGRAM)
            return [self.programs / "trb-virtual-ur", *address, "--programs", programs]
        profile = {"gated": "crlf-login"}.get(node, node)
        return [self.programs / "trb-virtual-text", *address, "--profile", profile]

    def ask(self, node, name):
        data = self.json("request", node, name, node=node)["data"]
        return json.loads(data) if isinstance(data, str) and not data.isalpha() else data

    def profile(self, node):
        return next(r for r in self.json("route", "list", node=node)["routes"] if r["id"] == node)["profile"]

    def is_online(self, node):
        return self.profile(node)["robot"] == "ONLINE"

    def wait_online(self, node):
        self.wait(f"{node} is ONLINE", lambda: self.is_online(node), 60)

    def submit(self, node, name, data):
        path = self.root / f"{node}.json"
        path.write_text(json.dumps({"name": "m", "tasks": [{"id": "t", "robot": node, "skill": name, "data": data}]}))
        return self.json("scenario", "run", path, node=node)["run"]

    def task(self, node, run):
        done = self.trb("scenario", "watch", run, "--once", "--json", node=node, check=False)
        view = json.loads(done.stdout.splitlines()[-1])
        return view["tasks"][0] if view.get("tasks") else {"state": ""}

    def wait_task(self, node, run, *states):
        self.wait(f"the task is {states}", lambda: self.task(node, run)["state"] in states, 60)
        return self.task(node, run)


class Dialogue(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, DialogueFleet)
        cls.fleet.start()
        for node in cls.fleet.robots:
            cls.fleet.wait_online(node)

    def finish(self, node, name, data):
        run = self.fleet.submit(node, name, data)
        task = self.fleet.wait_task(node, run, "FINISHED", "FAILED")
        self.assertEqual(task["state"], "FINISHED", task)
        return task

    def test_a_a_dobot_enables_moves_and_tells_its_joints(self):
        self.finish("dobot", "enable", {})
        self.finish("dobot", "move_joints", {"joints": JOINTS})
        for told, wanted in zip(self.fleet.ask("dobot", "joints"), JOINTS):
            self.assertAlmostEqual(told, wanted * 180 / 3.14159265, places=3)

    def test_b_what_a_dobot_refuses_fails_with_its_words_and_its_alarm_is_a_fault(self):
        self.fleet.virtual["dobot"].say("fault reach")
        self.fleet.wait("it is out of use", lambda: self.fleet.profile("dobot").get("out_of_use"), 60)
        done = self.fleet.trb("send", "dobot", "command", "enable", "--take", node="dobot", check=False)
        self.assertIn("-2,{},EnableRobot()", done.stdout + done.stderr)
        self.fleet.trb("send", "dobot", "command", "clear_error", "--take", node="dobot")
        self.fleet.wait("it is in use", lambda: not self.fleet.profile("dobot").get("out_of_use"), 60)

    def test_c_a_stop_is_confirmed_by_the_robot_and_ends_its_motion(self):
        self.fleet.trb("send", "dobot", "command", "move", "[300, 0, 0, 0, 0, 0]", "--take", node="dobot")
        self.fleet.wait("it moves", lambda: self.fleet.ask("dobot", "mode") == 7, 60)
        self.assertIn("confirmed", self.fleet.trb("stop", "dobot", node="dobot").stdout)
        self.fleet.wait("it stands", lambda: self.fleet.ask("dobot", "mode") == 5, 60)
        self.fleet.trb("release", "dobot", node="dobot")

    def test_d_a_controller_with_a_login_runs_a_program(self):
        self.assertEqual(self.fleet.virtual["gated"].wait_line("asked", 60)[0], "asked $Login,secret")
        self.finish("gated", "run", {"program": 0})

    def test_e_a_skill_is_over_when_the_robot_says_that_it_has_arrived(self):
        begun = time.monotonic()
        task = self.finish("alive", "go", {"x": 1, "y": 0})
        self.assertGreater(time.monotonic() - begun, 1.9)  # 1 m at 0.5 m/s, which no silence has ended
        self.assertIn("ARRIVED 1.000 0.000", json.dumps(task))

    def test_f_a_robot_that_answers_nothing_is_lost_and_found_again(self):
        robot = self.fleet.virtual["alive"]
        run = self.fleet.submit("alive", "go", {"x": 100, "y": 0})
        self.fleet.wait_task("alive", run, "RUNNING")
        robot.say("mute")
        self.fleet.wait("it is lost", lambda: not self.fleet.is_online("alive"), 60)
        robot.say("speak")
        self.fleet.wait_online("alive")
        self.fleet.trb("scenario", "abort", run, node="alive", check=False)
        self.fleet.wait("it stands", lambda: self.fleet.ask("alive", "state") != "driving", 60)

    def test_f2_a_robot_whose_node_is_gone_halts_by_itself(self):
        run = self.fleet.submit("alive", "go", {"x": -100, "y": 0})
        self.fleet.wait_task("alive", run, "RUNNING")
        robot = self.fleet.virtual["alive"]
        begun = len(robot.lines)
        self.fleet.nodes.pop("alive").stop()
        robot.wait_line("said LOST silence", 60, begun)
        self.fleet.start_node("alive")
        self.fleet.nodes["alive"].wait_line("ready", 60)
        self.fleet.wait_online("alive")
        self.fleet.trb("scenario", "abort", run, node="alive", check=False)

    def test_g_a_line_that_nobody_asked_for_ends_the_connection_and_the_next_one_is_good(self):
        self.fleet.virtual["gated"].say("say #Stop,0")
        text = "nobody had asked for"
        log = self.fleet.dir("gated") / "log" / "mode-adapter.log"
        self.fleet.wait("it is told", lambda: text in log.read_text(), 60)
        self.fleet.wait_online("gated")

    def test_h_the_dashboard_of_a_ur_plays_a_program_and_is_stopped(self):
        run = self.fleet.submit("dash", "play", {"program": "none.urp"})
        self.assertIn("load none.urp was answered with", self.fleet.wait_task("dash", run, "FAILED")["reason"])
        self.fleet.trb("scenario", "abort", run, node="dash", check=False)
        run = self.fleet.submit("dash", "play", {"program": "wait.urp"})
        self.fleet.wait("it plays", lambda: self.fleet.ask("dash", "running") == "true", 60)
        self.assertIn("confirmed", self.fleet.trb("stop", "dash", node="dash").stdout)
        self.fleet.wait("it stands", lambda: self.fleet.ask("dash", "running") == "false", 60)
        self.fleet.trb("release", "dash", node="dash")
        self.fleet.trb("scenario", "abort", run, node="dash", check=False)

    def test_i_a_robot_that_was_off_is_found_again(self):
        self.fleet.virtual.pop("dobot").stop()
        self.fleet.wait("the robot is gone", lambda: not self.fleet.is_online("dobot"), 60)
        self.fleet.start_robot("dobot")
        self.fleet.wait_online("dobot")


class Refused(unittest.TestCase):
    """A login that is wrong: the node says why, and no log has the password."""

    def test_the_robot_is_not_there(self):
        fleet = support.make_fleet(self, RefusedFleet)
        fleet.start()
        log = fleet.dir("gated") / "log" / "mode-adapter.log"
        done = {}

        def refused():
            done["said"] = fleet.trb("send", "gated", "command", "run", "[0]", "--take", node="gated", check=False)
            return 'line 1 of "begin" was answered with' in done["said"].stdout + done["said"].stderr
        fleet.wait("the reason is told", refused, 60)
        self.assertFalse(fleet.is_online("gated"))
        self.assertNotIn("not-the-password", log.read_text())


class RefusedFleet(DialogueFleet):
    def __init__(self, root, programs):
        super().__init__(root, programs)
        self.robots = {"gated": self.robots["gated"]}
        self.node_names = ["gated"]

    def make_node(self, node):
        super().make_node(node)
        words = {**WORDS["gated"], "begin": ["$Login,not-the-password"]}
        (self.dir(node) / "commands.json").write_text(json.dumps({node: words}))


if __name__ == "__main__":
    support.main()
