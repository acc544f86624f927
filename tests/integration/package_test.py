"""What is installed: nodes and a virtual robot run from there, and the example of common/service/README.md is built
against the package outside the tree, started by `trb up`, hears a robot's fault and answers for it, by a bus of sockets
and by one over TCP with CURVE. Addresses 127.0.108.x and 127.0.109.x.
"""
import json
import os
import pathlib
import re
import subprocess
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

BUILD = support.PROGRAMS.parent
FLAGS = os.environ.get("TRB_PACKAGE_FLAGS", "")  # what a sanitized build's libraries have to be linked with
COMPONENTS = ("sdk", "node", "ros", "cloud", "virtual-robots")
NAME = "fault-tally"
ROBOT = "ridgeback"
README = support.REPO / "common" / "service" / "README.md"


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}{done.stderr}")


def block(language):
    """The README's only block of that language: what a reader copies is what is built here."""
    found, = re.findall(rf"^```{language}\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)
    return found


class OwnServiceFleet(trb_fleet.Fleet):
    """A cloud whose bus is sockets and a robot's node whose bus is TCP, each with the example as a service of its own."""

    program = None

    def node_json(self, node):
        more = {"bus": f"tcp://{self.address(node)}:46500"} if node == ROBOT else {"services": ["router", "scheduler"]}
        return {**super().node_json(node), **more, "own_services": {NAME: str(self.program)}}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = support.temporary_folder(cls)
        cls.package = cls.root / "somewhere" / "else"
        cls.install()
        OwnServiceFleet.program = cls.build_example()
        cls.fleet = support.make_fleet(cls, OwnServiceFleet, programs=cls.package / "bin", block=108, udp_port=50108,
                                       robots={ROBOT: trb_fleet.ROBOTS[ROBOT]})
        cls.fleet.start()  # waits until every service of node.json is up
        cls.fleet.wait_formed()

    @classmethod
    def install(cls):
        """The place where it was first installed is empty then."""
        first = cls.root / "first"
        for component in COMPONENTS:
            run("cmake", "--install", BUILD, "--component", component, "--prefix", first)
        cls.package.parent.mkdir()
        first.rename(cls.package)

    @classmethod
    def build_example(cls):
        source, build = cls.root / NAME, cls.root / "build"
        source.mkdir()
        (source / "main.cpp").write_text(block("cpp"))
        (source / "CMakeLists.txt").write_text(block("cmake"))
        run("cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={cls.package}",
            f"-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Wshadow -Werror {FLAGS}")
        run("cmake", "--build", build)
        return build / NAME

    def tally(self, of, asked_at):
        return json.loads(self.fleet.json("request", of, "fault_tally", node=asked_at)["data"])

    # ---- the package

    def test_nothing_in_it_names_a_place_where_it_was_built(self):
        # The archives name sources by their paths in this repository.
        files = [path for path in self.package.rglob("*") if path.is_file()]
        self.assertIn("talkrobotsConfig.cmake", [path.name for path in files])
        for path in files:
            for place in (support.REPO, self.root / "first"):
                self.assertFalse(str(place).encode() in path.read_bytes(), f"{path} names {place}")

    def test_its_compiler_is_told_where_its_headers_are_and_nothing_else_of_this_build(self):
        exported, = self.package.rglob("talkrobotsTargets.cmake")
        text = exported.read_text()
        for word in ("COMPILE_OPTIONS", "LINK_OPTIONS", "COMPILE_DEFINITIONS", "fsanitize", "fuse-ld", "nlohmann"):
            self.assertNotIn(word, text)
        self.assertIn("cxx_std_20", text)

    def test_its_headers_show_no_socket_no_json_library_no_logger_and_include_only_what_is_installed(self):
        top, = self.package.rglob("include/talkrobots")
        for path in top.rglob("*.hpp"):
            for line in re.findall(r'^#include [<"](.*?)[>"]$', path.read_text(), re.MULTILINE):
                self.assertNotRegex(line, "zmq|nlohmann|spdlog|msgpack|sodium", path)
                if "/" in line and not line.startswith("sys/"):
                    self.assertTrue((top / line).is_file(), f"{path} includes {line}")

    def test_another_minor_version_is_not_taken(self):
        source = self.root / "later"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(block("cmake").replace("talkrobots 0.1", "talkrobots 0.2"))
        (source / "main.cpp").touch()
        with self.assertRaisesRegex(RuntimeError, "compatible with requested\\s+version"):
            run("cmake", "-S", source, "-B", self.root / "later-build", f"-DCMAKE_PREFIX_PATH={self.package}")

    # ---- the programs

    def test_all_that_runs_is_installed_and_nothing_that_tests(self):
        installed = {path.name for path in (self.package / "bin").iterdir()}
        self.assertEqual(installed, {path.name for path in support.PROGRAMS.iterdir() if path.name.split("-")[0] == "trb" and not path.name.startswith("trb-bench-")})
        for row in self.fleet.services(CLOUD).values():
            program = pathlib.Path(f"/proc/{row['pid']}/exe").resolve()
            self.assertIn(program.parent, (self.package / "bin", OwnServiceFleet.program.parent))

    def test_the_examples_of_a_node_s_files_are_installed_too(self):
        examples = self.package / "share" / "talkrobots" / "config"
        self.assertTrue((examples / "robots" / "README.md").is_file())
        self.assertTrue((examples / "scenarios" / "find-and-fetch.json").is_file())

    # ---- the service on its node

    def test_both_nodes_have_it_and_one_of_them_proves_itself_with_a_key(self):
        for node in (CLOUD, ROBOT):
            self.assertEqual(self.fleet.services(node)[NAME]["state"], "up")
        self.assertTrue((self.fleet.dir(CLOUD) / "bus" / f"{NAME}.ipc").is_socket())
        self.assertFalse((self.fleet.dir(ROBOT) / "bus").exists())
        self.assertTrue((self.fleet.dir(ROBOT) / "keys" / "bus" / f"{NAME}.key").is_file())

    def test_it_hears_a_robot_and_answers_any_node(self):
        before = self.tally(CLOUD, ROBOT).get(ROBOT, {}).get("faults", {}).get("mobile", 0)
        self.fleet.trb("robot", "fault", ROBOT, "mobile", "--text", "wheel is off", node=CLOUD)
        for of, asked_at in ((CLOUD, ROBOT), (ROBOT, CLOUD), (CLOUD, CLOUD)):
            with self.subTest(of=of, asked_at=asked_at):
                self.fleet.wait("the fault is counted", lambda: self.tally(of, asked_at).get(ROBOT, {}).get(
                    "faults", {}).get("mobile") == before + 1, 60)
        self.assertIn("wheel is off", (self.fleet.dir(CLOUD) / "log" / f"{NAME}.log").read_text())

    def test_a_word_that_it_does_not_know_in_that_way_is_refused_with_a_cure(self):
        done = self.fleet.trb("send", CLOUD, "command", "fault_tally", "--json", node=CLOUD, check=False)
        self.assertEqual((done.returncode, json.loads(done.stdout)["error"]["code"]), (1, "bad_value"))

    def test_the_node_starts_it_again_and_ends_it_with_itself(self):
        def pid():
            row = self.fleet.services(CLOUD)[NAME]
            return row["pid"] if row["state"] == "up" else None
        first = pid()
        os.kill(first, 9)
        self.fleet.wait("it is up again", lambda: pid() not in (None, first), 60)
        last = pid()
        self.assertEqual(pathlib.Path(f"/proc/{last}/exe").resolve(), self.fleet.program)
        self.fleet.nodes[CLOUD].stop()
        self.assertFalse(pathlib.Path(f"/proc/{last}").exists())
        self.fleet.start_node(CLOUD)
        self.fleet.nodes[CLOUD].wait_line("ready", 60)
        self.fleet.wait_formed()


if __name__ == "__main__":
    support.main()
