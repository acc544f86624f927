"""`trb robot conform` against the robots' functions that are shipped, the virtual robot, and wrong ones; `trb robot check`.

Addresses 127.0.156.x.
"""
import json
import pathlib
import shutil
import subprocess
import unittest

import support
import trb_fleet
import wrong_robot

CONFIG = support.REPO / "config"
EXAMPLE = CONFIG / "robots" / "field-example.json"
CODES = {"done": 1, "failed": 2, "wave": 3, "echo": 4, "conform_unknown": 5}
NUMERIC = {"encoding": "numeric", "codes": {"subtypes": CODES, "ids": {"cloud": 7}}}
NODE = "127.0.156.1"
# A wrong robot shows by what it does not send: how long to wait for that.
SHORT = ["--timeout", "0.6", "--wait", "1"]


class Conform(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = support.temporary_folder(cls)

    def description(self, **channel):
        """The shipped example with another field channel."""
        text = json.loads(EXAMPLE.read_text())
        text["field_channel"].update(channel)
        path = self.root / f"{self.id().rsplit('.', 1)[1]}-{len(list(self.root.iterdir()))}.json"
        path.write_text(json.dumps(text))
        return path

    def start(self, *command):
        """A robot that dials until there is a node."""
        robot = trb_fleet.Process(command, self.root / f"{len(list(self.root.iterdir()))}.log")
        self.addCleanup(robot.stop)
        return robot

    def conform(self, description, port, *options):
        """Plays against the robot that dials that port; case -> its row, and the exit code."""
        done = subprocess.run([support.PROGRAMS / "trb", "robot", "conform", description, "--listen", f"{NODE}:{port}",
                               "--json", *options], capture_output=True, text=True, timeout=120)
        self.assertTrue(done.stdout, done.stderr)
        return {row["case"]: row for row in json.loads(done.stdout)["cases"]}, done.returncode

    def assert_conforms(self, description, port, not_tried, *options):
        rows, code = self.conform(description, port, *options)
        wrong = [row for row in rows.values() if row["verdict"] == "WRONG"]
        self.assertEqual((wrong, code), ([], 0))
        self.assertEqual({name for name, row in rows.items() if row["verdict"] != "ok"}, set(not_tried))

    # ---- good robots

    def test_the_functions_in_python_pass_every_case(self):
        client = CONFIG / "robots" / "python" / "field_client.py"
        self.start("/usr/bin/python3", client, NODE, "40001")
        self.assert_conforms(EXAMPLE, 40001, {"no-acknowledge", "numbers", "chunks"}, "--run", "wave")
        self.start("/usr/bin/python3", client, NODE, "40002", "40")
        self.assert_conforms(self.description(chunk_bytes=40), 40002, {"no-acknowledge", "numbers"}, "--run", "wave")

    def test_the_functions_in_c_pass_every_case(self):
        program = support.PROGRAMS / "field-client-example"
        self.start(program, NODE, "40003")
        self.assert_conforms(EXAMPLE, 40003, {"no-acknowledge", "numbers", "chunks"}, "--run", "wave")
        self.start(program, NODE, "40004", "40")
        self.assert_conforms(self.description(chunk_bytes=40), 40004, {"no-acknowledge", "numbers"}, "--run", "wave")

    def virtual(self, port, *options):
        self.start(support.PROGRAMS / "trb-virtual-lines-robot", "--node", f"{NODE}:{port}", "--name", "node", "--skill",
                   "wave=0.2", "--die-with-parent", *options)

    def test_the_virtual_robot_passes_every_case_in_each_framing(self):
        text = {"no-acknowledge", "numbers"}
        self.virtual(40005, "--framing", "length", "--chunk-bytes", "50")
        self.assert_conforms(self.description(framing="length", chunk_bytes=50), 40005, text, "--run", "wave")
        self.virtual(40006, "--no-ack")
        self.assert_conforms(self.description(acknowledge=False), 40006, {"acknowledge", "numbers", "chunks"}, "--run",
                             "wave")

    def test_the_virtual_robot_passes_where_only_a_pause_ends_a_field(self):
        # A few cases with long pauses: on a busy machine a pause is missed, which is that channel's weakness.
        self.virtual(40007, "--framing", "delay", "--delay-s", "0.2", "--no-ack")
        description = self.description(framing="delay", delay_s=0.2, acknowledge=False)
        for case in ("empty", "utf8", "stop"):
            for _ in range(3):
                rows, code = self.conform(description, 40007, "--only", case)
                if code == 0:
                    break
            self.assertEqual((rows[case]["verdict"], code), ("ok", 0), rows)

    def test_the_virtual_robot_passes_every_case_in_numbers(self):
        codes = [word for name, code in CODES.items() for word in ("--code", f"subtype:{name}={code}")]
        self.virtual(40008, "--encoding", "numeric", "--chunk-bytes", "80", "--code", "id:cloud=7", *codes)
        self.assert_conforms(self.description(chunk_bytes=80, **NUMERIC), 40008,
                             {"no-acknowledge", "escapes", "quotes", "utf8", "like-an-order"}, "--run", "wave")

    # ---- wrong robots

    CHANNELS = {"no-acknowledge": {"acknowledge": False}, "back-to-back": {"acknowledge": False},
                "chunks": {"chunk_bytes": 40}, "numbers": NUMERIC}

    def test_each_mistake_is_found_by_its_case(self):
        found = set()
        for port, (name, (case, _, _)) in enumerate(wrong_robot.FAULTS.items(), 40100):
            with self.subTest(name):
                description = self.description(ack_timeout_s=0.4, **self.CHANNELS.get(case, {}))
                program = pathlib.Path(wrong_robot.__file__)
                robot = self.start("/usr/bin/python3", program, NODE, str(port), name)
                wait = [] if case == "connect" else ["--wait", "20"]
                rows, code = self.conform(description, port, "--only", case, "--run", "wave", *SHORT, *wait)
                robot.stop()
                row = rows[case]
                self.assertEqual((row["verdict"], code), ("WRONG", 1), row)
                self.assertTrue(row["expected"] and row["came"] and row["section"], row)
                found.add(case)
        cases = json.loads(self.trb("conform", "--list", "--json").stdout)["cases"]
        self.assertEqual(found, {row["case"] for row in cases}, "a case that no wrong robot is found by proves nothing")

    def test_sections_are_those_of_the_document(self):
        document = (support.REPO / "proto" / "FIELD_CHANNEL.md").read_text()
        for row in json.loads(self.trb("conform", "--list", "--json").stdout)["cases"]:
            self.assertTrue(any(line.startswith(f"## {row['section']}") for line in document.splitlines()), row)

    # ---- the command line

    def trb(self, *words):
        return subprocess.run([support.PROGRAMS / "trb", "robot", *map(str, words)], capture_output=True, text=True,
                              timeout=60)

    def test_a_node_says_where_its_robot_dials(self):
        fleet = support.make_fleet(self, block=156, robots={"mine": ("lines", "ridgeback", [])}, cloud=False)
        self.start(support.PROGRAMS / "trb-virtual-lines-robot", "--node", f"{fleet.address('mine')}:40000", "--from",
                   fleet.robot_address("mine"), "--name", "mine", "--die-with-parent")
        done = self.trb("conform", fleet.dir("mine"), "--only", "answer", "--wait", "20")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f"listening on {fleet.address('mine')}:40000", done.stdout)
        self.assertIn("1 ok, 0 wrong, 0 not tried", done.stdout)

    def test_what_is_wrong_is_told_with_what_came_and_where_to_read(self):
        description = self.description()
        self.start("/usr/bin/python3", pathlib.Path(wrong_robot.__file__), NODE, "40099", "CountsCharacters")
        done = self.trb("conform", description, "--listen", f"{NODE}:40099", "--only", "utf8", "--wait", "20")
        self.assertEqual(done.returncode, 1)
        self.assertIn("WRONG      utf8", done.stdout)
        self.assertIn("the size field said", done.stdout)
        self.assertIn('see       proto/FIELD_CHANNEL.md, "Framing"', done.stdout)

    def test_wrong_use_is_told(self):
        for words, reason in ((["conform"], "too few words"), (["conform", EXAMPLE, "--only", "all"], "no case 'all'"),
                              (["conform", EXAMPLE, "--run", "fly"], "no skill 'fly'"),
                              (["conform", EXAMPLE, "--listen", "here"], "no ADDRESS:PORT"),
                              (["conform", EXAMPLE, "--listen", "192.0.2.1:1"], "use --listen with an address of this machine"),
                              (["conform", self.root / "none.json"], "no such file")):
            with self.subTest(words):
                done = self.trb(*words)
                self.assertEqual(done.returncode, 1)
                self.assertIn(reason, done.stderr)

    # ---- trb robot check

    def test_check_tells_what_a_good_robot_can_do(self):
        done = self.trb("check", EXAMPLE)
        self.assertEqual(done.returncode, 0, done.stderr)
        for text in ("no faults", "Example Field client", "lines (interpreter, lines)", "wave", "the robot says so"):
            self.assertIn(text, done.stdout)
        report = json.loads(self.trb("check", CONFIG / "robots" / "ur3.json", "--json").stdout)
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["spoken_to"], [{"framework": "ur", "mode": "direct", "transport": "tcp-text"}])
        self.assertIn("go_home", [skill["name"] for skill in report["skills"]])

    def test_check_tells_every_fault_with_file_key_and_cure(self):
        folder = self.root / "bad"
        shutil.copytree(CONFIG, folder)
        path = folder / "robots" / "ur3.json"
        path.write_text(path.read_text().replace('"capability": "grab"', '"capability": "grap"').replace("{side}", "{sid}"))
        report = json.loads(self.trb("check", path, "--json").stdout)
        keys = {fault["key"] for fault in report["faults"]}
        self.assertEqual(keys, {f"skills.{skill}.{key}" for skill in ("grasp_and_put_down", "pick")
                                for key in ("capability", "command.data")})
        self.assertTrue(all(fault["file"] == str(path) and fault["cure"] for fault in report["faults"]))
        done = self.trb("check", path)
        self.assertEqual(done.returncode, 1)
        self.assertIn("did you mean 'grab'?", done.stderr)


if __name__ == "__main__":
    support.main()
