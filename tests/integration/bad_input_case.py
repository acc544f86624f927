"""Wrong input, as a user gives it: the exit status is not 0, the message names file, key and a cure, with --json it is
JSON with the same content, and nothing was started. What its tests share.
"""
import json
import os
import pathlib
import subprocess
import unittest

import support

NO_JSON = '{\n  "a": 1\n  "b": 2\n}'
# What a command says that came of the faults; one that only looks says nothing more.
THEREFORE = {"up": ", nothing was started", "run": ", nothing was started", "reload": ", nothing was reloaded"}


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
        command = arguments[1] if arguments[0] == "scenario" else arguments[0]
        self.assertRegex(text, rf"(?m)^trb: \d+ faults?{THEREFORE.get(command, '')}$")
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
