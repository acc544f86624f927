"""Wrong words on the command line, and help for who asks."""
import json
import re
import subprocess

import support
from bad_input_case import Case, run

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
    ("stop", "--all", "arm"): (1, "which node?", "--node"),
    ("release", "--all", "arm"): (1, "--all: robots are named, too", "name robots, or give --all"),
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


if __name__ == "__main__":
    support.main()
