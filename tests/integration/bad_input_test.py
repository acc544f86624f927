"""Wrong input, as a user gives it: the exit status is not 0, the message names file, key and a cure, with --json it is
JSON with the same content, and nothing was started.
"""
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import unittest

import support

BLOCK = 50
UDP_PORT = 50050
NO_JSON = '{\n  "a": 1\n  "b": 2\n}'


def run(*arguments, **env):
    """Runs one command; returns the finished process. A node is known only by --node."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("TRB_")}
    return subprocess.run([str(support.PROGRAMS / "trb"), *map(str, arguments)], capture_output=True, text=True, timeout=30,
                          env=dict(environment, **env), stdin=subprocess.DEVNULL, cwd="/")


def processes_of(folder):
    """The command lines of the living processes that name the folder."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = path.read_bytes().decode(errors="replace").split("\0")
        except OSError:
            continue
        if str(folder) in words:
            found.append(words)
    return found


class Case(unittest.TestCase):
    def temporary(self):
        return support.temporary_folder(self)

    def error_of(self, *arguments, code, what, cure, status=1, **env):
        """Refused with that code; `what` and `cure` are parts of the texts, in text and JSON output."""
        done = run(*arguments, **env)
        text = f"{' '.join(map(str, arguments))}: {done.stdout}{done.stderr}"
        self.assertEqual(done.returncode, status, text)
        done = run(*arguments, "--json", **env)
        self.assertEqual(done.returncode, status, text)
        error = json.loads(done.stdout)["error"]
        self.assertEqual(error["code"], code, text)
        self.assertIn(what, error["what"])
        self.assertTrue(error["cure"], text)
        self.assertIn(cure, error["cure"])
        for part in (error["code"], error["what"], error["cure"]):
            self.assertIn(part, text)

    def faults_of(self, *arguments, **env):
        """Refused with faults, each with a file and a cure; the text output has the same."""
        done = run(*arguments, **env)
        self.assertEqual(done.returncode, 1, f"{arguments}: {done.stdout}{done.stderr}")
        self.assertEqual(done.stdout, "")
        text = done.stderr
        done = run(*arguments, "--json", **env)
        self.assertEqual(done.returncode, 1)
        faults = json.loads(done.stdout)["faults"]
        for fault in faults:
            self.assertTrue(fault["file"] and fault["what"] and fault["cure"], fault)
            self.assertIs(type(fault.pop("may_wait")), bool)
            for part in fault.values():
                self.assertIn(part, text)
        self.assertRegex(text, r"trb: \d+ faults?, nothing was started")
        return faults

    def assert_fault(self, faults, file, key, what, cure):
        match = [f for f in faults if f["file"].endswith(file) and f["key"] == key and what in f["what"] and cure in f["cure"]]
        self.assertTrue(match, f"no fault {(file, key, what, cure)} in {json.dumps(faults, indent=1)}")

    def assert_nothing_started(self, folder):
        self.assertEqual(processes_of(folder), [])
        self.assertFalse((folder / "bus").exists())
        self.assertFalse((folder / "log").exists())


def written(name, text):
    return lambda folder: (folder / name).write_text(text)


def removed(name):
    return lambda folder: (folder / name).unlink()


def changed(name, *path_and_value):
    """One value of a JSON file; None removes it."""
    *path, last, value = path_and_value

    def change(folder):
        document = json.loads((folder / name).read_text())
        place = document
        for key in path:
            place = place[key]
        if value is None:
            del place[last]
        else:
            place[last] = value
        (folder / name).write_text(json.dumps(document))
    return change


def all_of(*changes):
    return lambda folder: [change(folder) for change in changes]


SEED = {"address": "10.0.0.1:45000", "key": "0" * 64}

# What a user does to a good node's folder (of the node "ur3"): the fault's file, key, a part of its text and of its cure.
FAULTS = {
    "no node.json": (removed("node.json"), "node.json", "", "no such file", "write it"),
    "no network.json": (removed("network.json"), "network.json", "", "no such file", "config/network.json"),
    "no profile.json": (removed("profile.json"), "profile.json", "", "no such file", "config/profile.json"),
    "no commands.json": (removed("commands.json"), "commands.json", "", "no such file", "config/commands.json"),
    "no places.json": (removed("places.json"), "places.json", "", "no such file", "config/places.json"),
    "no description": (removed("robots/ur3.json"), "robots/ur3.json", "", "no such file", "config/robots"),
    "no link key": (removed("keys/link.key"), "keys", "", "link.key: no such file", "trb fleet request"),
    "no identity key": (removed("keys/identity.key"), "keys", "", "identity.key: no such file", "trb fleet request"),
    "no certificate": (removed("keys/certificate.json"), "keys", "", "certificate.json: no such file", "trb fleet sign"),
    **{f"a malformed {name}": (written(name, NO_JSON), name, "", "line 3, column 5", "")
       for name in ("node.json", "network.json", "profile.json", "commands.json", "places.json", "robots/ur3.json")},
    "a malformed link key": (written("keys/link.key", "zz\n"), "keys", "", "link.key: not a key of 32 bytes", "trb fleet request"),
    "a malformed certificate": (written("keys/certificate.json", NO_JSON), "keys", "", "certificate.json: no JSON at line 3, column 5", ""),
    "a certificate without its parts": (written("keys/certificate.json", "{}"), "keys", "", "certificate: missing", "trb fleet sign"),
    "a changed certificate": (changed("keys/certificate.json", "certificate", "signature", "00" * 64), "keys", "",
                              "was not signed by this fleet's authority", "sign the node's request again"),
    "an unknown mode": (changed("profile.json", "ur", "serial"), "profile.json", "ur", "'serial'", "interpreter, direct, ros"),
    "an unknown framework": (changed("node.json", "framework", "urr"), "node.json", "framework", "'urr' is not in profile.json", "'ur'"),
    "no such address": (changed("network.json", "HOST_INT", "203.0.113.9"), "network.json", "HOST_INT", "no interface or address '203.0.113.9'", "lo (127.0.0.1)"),
    "the name of Windows": (changed("network.json", "HOST_INT", "Wi-Fi"), "network.json", "HOST_INT", "Windows", "ip address"),
    "a port as text": (changed("network.json", "TCP_PORT", "40000"), "network.json", "TCP_PORT", "is a text", ""),
    "a port out of range": (changed("network.json", "UDP_PORT", 70000), "network.json", "UDP_PORT", "out of range", "65535"),
    "an unknown key": (changed("node.json", "becon", True), "node.json", "becon", "no key", "'beacon'"),
    "a number as id": (changed("node.json", "id", 7), "node.json", "id", "whole number", "text"),
    "an id that is none": (changed("node.json", "id", "UR 3"), "node.json", "id", "is no id", ""),
    "a list as robot": (changed("node.json", "robot", []), "node.json", "robot", "list", ""),
    "a seed twice": (changed("node.json", "seeds", [SEED, SEED]), "node.json", "seeds[1].address", "occurs twice", "keep one"),
    "a service twice": (changed("node.json", "services", ["router", "router"]), "node.json", "services[1]", "occurs twice", ""),
    "an unknown service": (changed("node.json", "services", ["router", "schedular"]), "node.json", "services", "'schedular'", "'scheduler'"),
    "a key twice": (written("places.json", '{"places": {}, "places": {}}'), "places.json", "", "places", ""),
    "no words for stop": (changed("commands.json", "ur", "commands", "stop", None), "commands.json", "ur.commands.stop", "how it is stopped", "stop program"),
    "a place without x": (changed("places.json", "places", "dock", "x", None), "places.json", "places.dock.x", "is missing", ""),
    "a skill without an end": (changed("robots/ur3.json", "skills", "pick", "end", None), "robots/ur3.json", "skills.pick.end", "has no end", ""),
    "a readable key": (lambda folder: (folder / "keys/link.key").chmod(0o644), "keys", "", "others may read this secret key", "chmod 600"),
    "another id than the certificate's": (changed("node.json", "id", "ur4"), "keys/certificate.json", "id", "is for 'ur3', node.json says 'ur4'", "trb fleet sign"),
    "another role than the certificate's": (
        all_of(changed("node.json", "role", "cloud"), changed("node.json", "services", ["router"]),
               *(changed("node.json", key, None) for key in ("framework", "description", "robot"))),
        "keys/certificate.json", "role", "is 'robot', node.json says 'cloud'", "trb fleet sign"),
}


class Files(Case):
    @classmethod
    def setUpClass(cls):
        robots = {name: support.trb_fleet.ROBOTS[name] for name in ("ur3", "ridgeback")}
        cls.fleet = support.make_fleet(cls, block=BLOCK, udp_port=UDP_PORT, robots=robots, cloud=False)

    def copy(self, node="ur3"):
        folder = self.temporary() / node
        shutil.copytree(self.fleet.dir(node), folder)
        return folder

    def check_and_up(self, folder, *fault):
        for command in ("check", "up"):
            self.assert_fault(self.faults_of(command, folder), *fault)
        self.assert_nothing_started(folder)

    def test_the_folder_is_good_before_it_is_spoilt(self):
        done = run("check", self.copy(), "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)), (0, {"faults": []}))

    def test_every_fault_of_a_folder(self):
        for what, (spoil, *fault) in FAULTS.items():
            with self.subTest(what):
                folder = self.copy()
                spoil(folder)
                self.check_and_up(folder, *fault)

    def test_no_folder(self):
        for command in ("check", "up", "reload"):
            self.assert_fault(self.faults_of(command, "/nowhere/at/all"), "/nowhere/at/all", "", "is no folder", "node.json")

    def test_a_port_in_use(self):
        with socket.create_server((self.fleet.address("ur3"), 45000)):
            self.check_and_up(self.copy(), "network.json", "TCP_PORT_EXT", "is in use by another program", "ss -ltnp")

    def test_the_certificate_of_another_node(self):
        folder = self.copy()
        shutil.copy(self.fleet.dir("ridgeback") / "keys/certificate.json", folder / "keys/certificate.json")
        self.check_and_up(folder, "keys", "", "made for other keys than those beside it", "trb fleet sign")

    def test_a_certificate_that_has_ended(self):
        folder = self.copy()
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), folder / "keys/request.json", "--days", "0.000001")
        self.fleet.wait("the certificate ends", lambda: run("check", folder).returncode != 0, 60)
        self.check_and_up(folder, "keys/certificate.json", "not_after", "ended 20", "run trb fleet renew")

    def test_several_faults_are_told_at_once(self):
        folder = self.copy()
        for spoil in ("an unknown mode", "no such address", "a place without x"):
            FAULTS[spoil][0](folder)
        self.assertEqual(sorted(fault["file"] for fault in self.faults_of("check", folder)),
                         ["network.json", "places.json", "profile.json"])

    # ---- the authority

    def sign(self, *requests, secret=None, authority=None, **expected):
        secret = self.fleet.passphrase() if secret is None else secret
        self.error_of("fleet", "sign", authority or self.fleet.authority_dir(), *requests, TRB_PASSPHRASE=secret, **expected)

    def test_fleet_sign(self):
        folder = self.copy()
        request = folder / "keys/request.json"
        before = (folder / "keys/certificate.json").read_bytes()
        self.sign(request, secret="a wrong passphrase", code="not_permitted", what="the passphrase is wrong", cure="try again")
        self.sign(request, authority=folder, code="missing", what="fleet.json: no such file", cure="trb fleet init")
        self.sign(folder / "none.json", code="missing", what="none.json: no such file", cure="trb fleet request")
        self.sign(request, "--days", "0", code="bad_value", what="--days: '0'", cure="--days 5")
        self.sign(request, "--days", "100000", code="bad_value", what="--days: '100000' is over 36500", cure="at most 36500")
        shutil.copy(request, folder / "keys/other.json")
        self.sign(request, folder / "keys/other.json", code="conflict", what="both certificates would be", cure="a folder of its own")
        changed("keys/request.json", "signature", "00" * 64)(folder)
        self.sign(request, code="bad_signature", what="request of 'ur3'", cure="trb fleet request")
        request.write_text(NO_JSON)
        self.sign(request, code="malformed", what="line 3, column 5", cure="trb fleet request")
        self.assertEqual((folder / "keys/certificate.json").read_bytes(), before)

    def test_fleet_init(self):
        folder = self.temporary() / "authority"
        self.error_of("fleet", "init", folder, TRB_PASSPHRASE="short", code="bad_value", what="passphrase: under 12 characters",
                      cure="longer")
        self.error_of("fleet", "init", folder, code="missing", what="no passphrase", cure="TRB_PASSPHRASE")
        self.error_of("fleet", "init", folder, "--name", "Hall 3", TRB_PASSPHRASE="long enough for it", code="bad_value",
                      what="name", cure="letters")
        self.error_of("fleet", "init", folder, "--passphrase-file", folder / "none", code="missing", what="none: no such file",
                      cure="passphrase")
        self.assertFalse(folder.exists())
        folder.mkdir()
        (folder / "authority.key").write_text("00")
        self.error_of("fleet", "init", folder, TRB_PASSPHRASE="long enough for it", code="conflict", what="fleet.json is not",
                      cure=f"rm {folder}/authority.key")
        self.error_of("fleet", "init", self.fleet.authority_dir(), TRB_PASSPHRASE="long enough for it", code="conflict",
                      what="holds a fleet authority already", cure="another folder")

    def test_fleet_request_and_show(self):
        empty = self.temporary()
        self.error_of("fleet", "request", empty, code="missing", what="node.json: no such file", cure="write node.json first")
        for text, what in (("{}", "id"), (NO_JSON, "line 3, column 5"), ('{"id": 7}', "id: needs text"),
                           ('{"id": "a", "role": "boss"}', "role: 'boss'"), ('{"id": "A B"}', "'A B'")):
            (empty / "node.json").write_text(text)
            done = run("fleet", "request", empty, "--json")
            error = json.loads(done.stdout)["error"]
            self.assertEqual(done.returncode, 1)
            self.assertIn(what, error["what"])
            self.assertIn("node.json", error["what"] + error["cure"])
            self.assertTrue(error["cure"], error)
        self.assertFalse((empty / "keys").exists())
        self.error_of("fleet", "show", empty, code="missing", what="no fleet.json", cure="trb fleet")
        self.error_of("fleet", "show", "/nowhere", code="missing", what="/nowhere", cure="trb fleet")


# ---- words of the command line

WORDS = {
    ("frob",): (2, "'frob'", "trb help"),
    ("route",): (2, "'route'", "trb route list"),
    ("route", "lst"): (2, "'route lst'", "trb route list"),
    ("check",): (2, "too few words", "trb check NODE_DIR"),
    ("check", "a", "b"): (2, "'b' is one word too many", "trb check NODE_DIR"),
    ("check", "a", "--jsn"): (2, "unknown option '--jsn'", "--json"),
    ("fleet", "sign", "a"): (2, "too few words", "trb fleet sign FLEET_DIR REQUEST"),
    ("route", "list", "--node"): (2, "--node: needs a value", "--node DIR"),
    ("route", "list"): (1, "which node?", "--node"),
    ("route", "list", "--node", "/nowhere"): (1, "/nowhere: no node.json there", "name a node's folder"),
    ("send", "ur3", "comand", "move"): (1, "TYPE: 'comand'", "command, request or information"),
    ("send", "ur3", "command", "mo ve"): (1, "SUBTYPE: 'mo ve'", "letters"),
    ("send", "ur3", "command", "stop", "now"): (1, "stop", ""),
    ("send", "ur3", "command", "stop", '{"resaon": "x"}'): (1, "resaon", "reason"),
    ("send", "ur3", "command", "move", "--timeout", "soon"): (1, "--timeout: 'soon' is no positive number", "--timeout 5"),
    ("tap", "--count", "-1"): (1, "--count: '-1' is no positive number", "--count 5"),
    ("stop",): (1, "which robot?", "--all"),
    ("stop", "--all=false"): (2, "--all=false: --all takes no value", "leave it out"),
    ("fleet", "renew", "a", "ur3", "--relay=no"): (2, "--relay=no: --relay takes no value", "leave it out"),
    ("service", "counters", "Router", "--node", "/"): (1, "SERVICE: 'Router' is no id", "lower-case letter"),
    ("logs", "/nowhere"): (1, "no log", "folder"),
}


class Words(Case):
    def test_wrong_words(self):
        for words, expected in WORDS.items():
            with self.subTest(words):
                status, what, cure = expected
                done = run(*words)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(what, done.stderr)
                self.assertIn(cure, done.stderr)
                done = run(*words, *(() if words[-1] == "--node" else ("--json",)))
                self.assertEqual(done.returncode, status)
                if words[-1] != "--node":
                    error = json.loads(done.stdout)["error"]
                    self.assertTrue(error["code"] and error["what"] and error["cure"], error)

    def test_output_that_is_not_written_is_no_success(self):
        for words in (("manual",), ("help",), ("fleet", "show", "--help")):
            with open("/dev/full", "w") as full:
                done = subprocess.run([support.PROGRAMS / "trb", *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=30)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("not all of the output was written: No space left", done.stderr)

    def test_a_folder_that_one_is_in_is_not_replaced(self):
        folder = self.temporary()
        done = subprocess.run([support.PROGRAMS / "trb", "node", "new", ".", "--cloud", "c1", "--network", "lo"], cwd=folder,
                              capture_output=True, text=True, timeout=30)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(". is the folder that you are in", done.stderr)
        self.assertEqual(list(folder.iterdir()), [])

    def test_an_unknown_topic_names_the_known_ones(self):
        done = run("help", "robots")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("no topic 'robots'", done.stderr)
        self.assertIn("Topics: errors fleet", done.stderr)

    def test_help_for_a_group_of_commands_lists_them(self):
        for asked in (["route", "--help"], ["help", "route"]):
            done = run(*asked)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertRegex(done.stdout, r"(?s)  trb route list.*\n`trb route COMMAND --help`")
        self.assertEqual(run("rout", "--help").returncode, 2)

    def test_every_command_has_help_with_an_example(self):
        overview = run("help")
        self.assertEqual(overview.returncode, 0)
        commands = [re.match(r"  trb ((?:[a-z]+ ?)+)", line) for line in overview.stdout.splitlines()]
        commands = [match.group(1).split() for match in commands if match]
        self.assertGreater(len(commands), 20)
        for words in commands:
            with self.subTest(words):
                for asked in (words + ["--help"], ["help"] + words):
                    done = run(*asked)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertRegex(done.stdout, rf"(?s)^trb {' '.join(words)}.*\nExamples:\n  trb ")
        for topic in ("errors", "fleet", "modes", "node", "scenario", "stop"):
            self.assertEqual(run("help", topic).returncode, 0)


# ---- a living fleet: a robot of lines, and a cloud

def task(**more):
    return dict({"id": "a", "robot": "ridgeback", "skill": "go_to", "data": {"place": "dock"}}, **more)


# A scenario's tasks: key, part of the text and of the cure.
SCENARIOS = {
    "a cycle": ([task(after=["b"]), task(id="b", after=["a"])], None, "a -> b -> a", ""),
    "an id twice": ([task(), task()], "tasks[1].id", "'a'", ""),
    "an unknown predecessor": ([task(after=["c"])], None, "'c'", ""),
    "no tasks": ([], "tasks", "", ""),
    "a task without a skill": ([{"id": "a", "robot": "ridgeback"}], "tasks[0].skill", "is missing", ""),
    "a number as robot": ([task(robot=3)], "tasks[0].robot", "whole number", "text"),
    "an unknown key": ([task(skil="x")], "tasks[0].skil", "no key", "skill"),
    "an unknown robot": ([task(robot="ridgebak")], "tasks[0].robot", "'ridgebak' is no robot of the fleet", "did you mean 'ridgeback'"),
    "an unknown skill": ([task(skill="goto")], "tasks[0].skill", "has no skill 'goto'", "did you mean 'go_to'"),
    "an unknown place": ([task(data={"place": "dok"})], "tasks[0].data.place", "'dok' is no place", "did you mean 'dock'"),
    "a number as place": ([task(data={"place": 3})], "tasks[0].data.place", "whole number", "name of a place"),
    "a missing parameter": ([task(data={})], "tasks[0].data.place", "is missing", "place"),
    "an unknown parameter": ([task(data={"place": "dock", "spead": 1})], "tasks[0].data.spead", "no such parameter", ""),
}
NEEDS_THE_FLEET = {what for what, row in SCENARIOS.items() if row[1] and ("data" in row[1] or row[3].startswith("did you mean"))}


class Living(Case):
    @classmethod
    def setUpClass(cls):
        robots = {"ridgeback": support.trb_fleet.ROBOTS["ridgeback"]}
        cls.fleet = support.make_fleet(cls, block=BLOCK + 2, udp_port=UDP_PORT + 2, robots=robots)
        cls.fleet.start()
        cls.fleet.wait_formed()
        cls.cloud = cls.fleet.dir("cloud")
        cls.robot = cls.fleet.dir("ridgeback")

    def scenario(self, tasks):
        path = self.temporary() / "s.json"
        path.write_text(json.dumps({"name": "n", "tasks": tasks}))
        return path

    def test_scenarios(self):
        for what, (tasks, key, text, cure) in SCENARIOS.items():
            with self.subTest(what):
                path = self.scenario(tasks)
                for command in ("check", "run"):
                    faults = self.faults_of("scenario", command, path, "--node", self.cloud)
                    self.assert_fault(faults, "s.json", faults[0]["key"] if key is None else key, text, cure)
                if what not in NEEDS_THE_FLEET:
                    self.faults_of("scenario", "check", path)
        for path, text in (("/nowhere.json", "no such file"), (self.temporary(), "")):
            for command in ("check", "run"):
                self.assert_fault(self.faults_of("scenario", command, path, "--node", self.cloud), str(path), "", text, "scenario")
        malformed = self.temporary() / "m.json"
        malformed.write_text(NO_JSON)
        self.assert_fault(self.faults_of("scenario", "run", malformed, "--node", self.cloud), "m.json", "", "line 3, column 5", "")
        self.assertEqual(self.fleet.json("scenario", "list", node="cloud")["runs"], [])

    def test_what_the_fleet_refuses(self):
        node = ("--node", self.cloud)
        self.error_of("scenario", "run", self.scenario([task()]), "--expires-h", "9000", *node, code="bad_value",
                      what="--expires-h: '9000' is over 8784", cure="at most 8784")
        self.error_of("send", "ridgebak", "command", "greeting", *node, code="unknown_target", what="'ridgebak'",
                      cure="trb route list")
        self.error_of("send", "cloud", "command", "greeting", *node, code="no_service", what="greeting", cure="trb service list")
        self.error_of("send", "ridgeback", "command", "execute", *node, code="not_permitted", what="execute", cure="")
        self.error_of("scenario", "watch", "ffff", *node, code="unknown_run", what="ffff", cure="trb run list")
        self.error_of("scenario", "abort", "ffff", *node, code="unknown_run", what="ffff", cure="trb run list")
        self.error_of("service", "counters", "mode-adapter", *node, code="no_service", what="mode-adapter",
                      cure="trb service list")
        done = run("stop", "ridgebak", "--json", *node)
        self.assertEqual((done.returncode, json.loads(done.stdout)["robots"][0]["state"]), (1, "unreachable"))

    def test_a_node_that_is_not_up(self):
        folder = self.temporary() / "cloud"
        shutil.copytree(self.cloud, folder, ignore=shutil.ignore_patterns("bus", "state", "log"))
        self.error_of("reload", folder, code="missing", what="is not up", cure="trb up")
        self.error_of("route", "list", "--node", folder, code="timeout", what="does not answer", cure="trb up")
        self.assert_nothing_started(folder)

    def test_up_twice(self):
        before = self.fleet.services("ridgeback")
        self.error_of("up", self.robot, code="conflict", what="is up already (pid ", cure="reload")
        self.assertEqual({n: s["pid"] for n, s in self.fleet.services("ridgeback").items()},
                         {n: s["pid"] for n, s in before.items()})

    def test_a_broken_file_keeps_the_node_running_and_a_good_one_is_taken(self):
        path = self.robot / "robots" / "ridgeback.json"
        good = path.read_text()
        self.addCleanup(path.write_text, good)
        before = self.fleet.services("ridgeback")["mode-adapter"]
        changed("robots/ridgeback.json", "skills", "fetch", "end", None)(self.robot)
        self.assert_fault(self.faults_of("reload", self.robot), "robots/ridgeback.json", "skills.fetch.end", "has no end", "")
        self.assertEqual(self.fleet.services("ridgeback")["mode-adapter"]["instance"], before["instance"])
        path.write_text(good)
        changed("robots/ridgeback.json", "model", "Ridgeback Mark 2")(self.robot)
        self.assertEqual(run("reload", self.robot).returncode, 0)
        self.fleet.wait("the other nodes see the new description", lambda: self.model() == "Ridgeback Mark 2", 60)
        self.assertNotEqual(self.fleet.services("ridgeback")["mode-adapter"]["instance"], before["instance"])
        self.fleet.wait_formed()

    def model(self):
        rows = self.fleet.json("route", "list", node="cloud")["routes"]
        return next((row["profile"]["model"] for row in rows if row["id"] == "ridgeback"), "")


if __name__ == "__main__":
    support.main()
