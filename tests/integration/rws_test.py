"""The direct mode over HTTP against a robot with sessions: a node and a virtual ABB by its web services (RWS 1.0), which are
also tested with Python's own client. Addresses 127.0.230.x, 127.0.231.x."""
import http.cookiejar
import json
import pathlib
import subprocess
import unittest
import urllib.error
import urllib.request

import support
import trb_fleet

VIRTUAL = support.PROGRAMS / "trb-virtual-abb-rws"
USER, PASSWORD = "Default User", "a-secret-of-this-test"
NONCE_USES = 3  # so that every command, and every stop, meets an outdated one
SYMBOL = "/rw/rapid/symbol/data/RAPID/T_ROB1/user/"
MASTER = "POST /rw/mastership/rapid?action="
RWS = {
    "transport": "http-json", "port": 80, "poll_s": 0.1, "timeout_s": 2, "body": "form", "cookies": True, "sign_out": "GET /logout",
    "values": {
        "joints": "GET /rw/motionsystem/mechunits/ROB_1/jointtarget?json=1 "
                  + " ".join(f"/_embedded/_state/0/rax_{i} number" for i in range(1, 7)),
        "busy": f"GET {SYMBOL}trb_go?json=1 /_embedded/_state/0/value TRUE=1 FALSE=0",
        "running": "GET /rw/rapid/execution?json=1 /_embedded/_state/0/ctrlexecstate running=1 stopped=0"},
    "commands": {
        "move": f"{MASTER}request\nPOST {SYMBOL}trb_target?action=set value=[{{0}},{{1}},{{2}},{{3}},{{4}},{{5}}]\n"
                f"POST {SYMBOL}trb_go?action=set value=TRUE\nalways {MASTER}release",
        "write": f"{MASTER}request\nPOST {SYMBOL}{{0}}?action=set value={{1}}\nalways {MASTER}release",
        "stop": "POST /rw/rapid/execution?action=stop stopmode=stop",
        "release": f"{MASTER}request\nPOST /rw/rapid/execution?action=resetpp\n"
                   f"POST /rw/rapid/execution?action=start regain=continue&execmode=continue\nalways {MASTER}release"},
    "requests": {"joints": "joints", "busy": "busy", "running": "running"}}
ARM = {
    "maker": "ABB", "model": "IRB 120", "capabilities": ["move"], "frame": {"length_unit": "mm", "angle_unit": "deg"},
    "skills": {"move": {"capability": "move", "parameters": {"joints": {"type": "numbers", "count": 6}},
                        "command": {"data": "{joints}"}, "end": {"kind": "state", "state": "busy", "equals": 0}}}}


class Client:
    """Python's own Digest and cookies."""

    def __init__(self, address, port, password=PASSWORD):
        self.base = f"http://{address}:{port}"
        known = urllib.request.HTTPPasswordMgrWithDefaultRealm()
        known.add_password(None, self.base, USER, password)
        jar = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
        self.opener = urllib.request.build_opener(urllib.request.HTTPDigestAuthHandler(known), jar)

    def ask(self, method, path, body=None):
        request = urllib.request.Request(self.base + path, None if body is None else body.encode(), method=method)
        try:
            with self.opener.open(request, timeout=60) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.read()


class RwsFleet(trb_fleet.Fleet):
    """One node with the controller on a port of its own: 80 is the superuser's."""

    def __init__(self, root, programs, block=230):
        super().__init__(root, programs, block=block, udp_port=50000 + block, robots={"abb": ("abb-rws", "arm", [])}, cloud=False)

    def description(self, node):
        path = self.root / "arm.json"
        path.write_text(json.dumps(ARM))
        return path

    def make_node(self, node):
        super().make_node(node)
        (self.dir(node) / "profile.json").write_text(json.dumps({"abb-rws": "direct"}))
        (self.dir(node) / "commands.json").write_text(json.dumps({"abb-rws": RWS}))
        self.sign_in(PASSWORD)

    def sign_in(self, password):
        path = self.dir("abb") / "keys" / "robot.auth"
        path.touch(0o600)
        path.write_text(f"digest {USER}:{password}\n")

    def start_virtual(self, port, nonce_uses):
        self.virtual["abb"] = trb_fleet.Process(
            [VIRTUAL, "--address", self.robot_address("abb"), "--port", str(port), "--speed", "5", "--password", PASSWORD,
             "--nonce-uses", str(nonce_uses), "--sessions", "5", "--die-with-parent"], self.root / "rws.log", stdin=subprocess.PIPE)
        return int(self.virtual["abb"].wait_line("ready", 60)[0].split()[1])

    def start_robot(self, node, *more):
        self.port = self.start_virtual("auto", NONCE_USES)
        path = self.dir(node) / "commands.json"
        path.write_text(path.read_text().replace('"port": 80,', f'"port": {self.port},'))

    def client(self, **more):
        return Client(self.robot_address("abb"), self.port, **more)

    def profile(self):
        return next(r for r in self.json("route", "list", node="abb")["routes"] if r["id"] == "abb")["profile"]

    def ask(self, name):
        data = self.json("request", "abb", name, node="abb")["data"]
        try:
            return json.loads(data) if isinstance(data, str) else data
        except ValueError:
            return data


class Rws(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, RwsFleet)
        cls.fleet.start()
        cls.fleet.wait("the robot is ONLINE", lambda: cls.fleet.profile()["robot"] == "ONLINE", 60)

    def say(self, line, wanted):
        robot = self.fleet.virtual["abb"]
        robot.drain()
        before = len(robot.lines)
        robot.say(line)
        return robot.wait_line(wanted, 60, before)[0]

    def test_a_many_polls_are_one_session_whose_numbers_are_read_from_texts(self):
        self.fleet.wait("its joints are told", lambda: self.fleet.ask("joints") == [0, 0, 0, 0, 30, 0], 60)
        for _ in range(20):
            self.assertEqual(self.fleet.ask("running"), "running")
        self.assertEqual(self.say("sessions", "sessions"), "sessions 1")

    def test_b_a_skill_moves_the_arm_and_gives_the_mastership_back(self):
        path = self.fleet.root / "scenario.json"
        path.write_text(json.dumps({"name": "m", "tasks": [
            {"id": "go", "robot": "abb", "skill": "move", "data": {"joints": [20, 0, 0, 0, 30, 0]}}]}))
        run = self.fleet.json("scenario", "run", path, node="abb")["run"]

        def state():
            done = self.fleet.trb("scenario", "watch", run, "--once", "--json", node="abb", check=False)
            view = json.loads(done.stdout.splitlines()[-1])
            return view["tasks"][0]["state"] if view.get("tasks") else ""
        self.fleet.wait("the task has ended", lambda: state() in ("FINISHED", "FAILED"), 60)
        self.assertEqual(state(), "FINISHED")
        self.fleet.wait("it is there", lambda: self.fleet.ask("joints") == [20, 0, 0, 0, 30, 0], 60)
        client = self.fleet.client()
        self.assertEqual(client.ask("POST", "/rw/mastership/rapid?action=request", "")[0], 204)
        self.assertEqual(client.ask("POST", "/rw/mastership/rapid?action=release", "")[0], 204)
        self.assertEqual(client.ask("GET", "/logout")[0], 200)

    def test_c_a_stop_is_confirmed_though_its_nonce_is_outdated_and_a_release_goes_on(self):
        for turn in range(NONCE_USES + 1):  # at each place of a nonce's life
            self.fleet.trb("send", "abb", "command", "move", json.dumps([90 + turn, 0, 0, 0, 30, 0]), "--take", node="abb")
            self.assertIn("confirmed", self.fleet.trb("stop", "abb", node="abb").stdout)
            self.fleet.wait("it stands", lambda: self.fleet.ask("running") == "stopped", 60)
            self.fleet.trb("release", "abb", node="abb")
            self.fleet.wait("its program runs", lambda: self.fleet.ask("running") == "running", 60)
        self.assertEqual(self.say("sessions", "sessions"), "sessions 1")

    def test_d_what_the_controller_refuses_is_told_with_its_words_and_the_mastership_given_back(self):
        done = self.fleet.trb("send", "abb", "command", "write", '["no_such", "TRUE"]', "--take", node="abb", check=False)
        self.assertIn("no such symbol", done.stdout + done.stderr)
        client = self.fleet.client()

        def is_free():
            return client.ask("POST", "/rw/mastership/rapid?action=request", "")[0] == 204
        self.fleet.wait("the mastership is free", is_free, 60)
        done = self.fleet.trb("send", "abb", "command", "write", '["trb_go", "FALSE"]', "--take", node="abb", check=False)
        self.assertIn("another client has the mastership", done.stdout + done.stderr)
        self.assertEqual(client.ask("GET", "/logout")[0], 200)
        for name in ("..", "a/b"):
            done = self.fleet.trb("send", "abb", "command", "write", json.dumps([name, "TRUE"]), "--take", node="abb", check=False)
            self.assertIn("would lead to another path", done.stdout + done.stderr)

    def test_e_the_controller_is_as_the_maker_says_to_another_client(self):
        client = self.fleet.client()
        status, body = client.ask("GET", "/rw/panel/ctrlstate?json=1")
        self.assertEqual((status, json.loads(body)["_embedded"]["_state"][0]["ctrlstate"]), (200, "motoron"))
        self.assertEqual(self.fleet.client(password="guess").ask("GET", "/rw/panel/ctrlstate?json=1")[0], 401)
        self.assertEqual(client.ask("GET", "/logout")[0], 200)

    def test_f_a_wrong_password_is_told_and_stands_in_no_log(self):
        self.fleet.sign_in("not-this-one")
        self.fleet.trb("reload", self.fleet.dir("abb"))

        def doctor():
            done = self.fleet.trb("doctor", "abb", node="abb", check=False)
            return done.stdout + done.stderr
        self.fleet.wait("the doctor names the cure", lambda: "digest USER:PASSWORD (if the robot asks for Digest)" in doctor(), 60)
        self.assertNotEqual(self.fleet.profile()["robot"], "ONLINE")
        self.fleet.sign_in(PASSWORD)
        self.fleet.trb("reload", self.fleet.dir("abb"))
        self.fleet.wait("the robot is back", lambda: self.fleet.profile()["robot"] == "ONLINE", 60)
        for path in pathlib.Path(self.fleet.root).rglob("*"):
            if path.is_file() and path.name != "robot.auth":
                text = path.read_bytes()
                self.assertNotIn(PASSWORD.encode(), text, path)
                self.assertNotIn(b"not-this-one", text, path)

    def test_g_a_controller_that_starts_anew_is_found_again_and_a_node_that_ends_signs_out(self):
        self.fleet.virtual["abb"].stop()
        self.fleet.wait("the robot is gone", lambda: self.fleet.profile()["robot"] != "ONLINE", 60)
        self.fleet.start_virtual(self.fleet.port, 100000)  # a sign-out is sent once: its nonce is good
        self.fleet.wait("the robot is back", lambda: self.fleet.profile()["robot"] == "ONLINE", 60)
        self.assertEqual(self.say("sessions", "sessions"), "sessions 1")
        self.fleet.nodes["abb"].stop()
        self.fleet.virtual["abb"].wait_line("logout", 60)
        self.assertEqual(self.say("sessions", "sessions"), "sessions 0")


if __name__ == "__main__":
    support.main()
