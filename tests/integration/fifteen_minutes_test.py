"""config/robots/README.md, "Your robot in 15 minutes": its commands are run as written, except for the addresses.

Addresses 127.0.157.x.
"""
import os
import re
import signal
import socket
import subprocess
import threading
import unittest

import shell_blocks
import support
import trb_fleet

README = support.REPO / "config" / "robots" / "README.md"


def commands_of(heading):
    """The shell blocks below a heading, as one script."""
    section = README.read_text().split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    return "".join(block.text for block in shell_blocks.blocks_of(README, section))


class FifteenMinutes(unittest.TestCase):
    def setUp(self):
        self.root = support.temporary_folder(self)
        self.env = dict(os.environ, TRB=str(support.REPO), TRB_PASSPHRASE="a long passphrase",
                        PATH=f"{support.PROGRAMS}:/usr/bin:/bin")

    def shell(self, script):
        """Runs what a person types; programs in the background end with the test."""
        with open(self.root / "said", "a") as said:
            child = subprocess.Popen(["/bin/bash", "-e", "-c", script], cwd=self.root, env=self.env, stdout=said,
                                     stdin=subprocess.DEVNULL, stderr=said, start_new_session=True)
        self.addCleanup(self.end_group, child.pid)
        self.assertEqual(child.wait(timeout=60), 0, (self.root / "said").read_text())

    def end_group(self, group):
        try:
            os.killpg(group, signal.SIGTERM)
        except ProcessLookupError:
            pass

    def follow(self, heading, host):
        """Runs a section; returns the output after the node was up."""
        # A robot on this machine that binds no address is seen as 127.0.0.1, whomever it dials.
        script = re.sub(r'(?<!"host": ")127\.0\.0\.1', f"127.0.157.{host}1", commands_of(heading))
        script = script.replace("127.0.0.2", f"127.0.157.{host}2")
        up = "trb up nodes/mine --detach\n"
        before, after = script.split(up)
        self.addCleanup(subprocess.run, [support.PROGRAMS / "trb", "down", self.root / "nodes" / "mine"], capture_output=True)
        self.shell(before + up)
        self.wait_robot()
        start = (self.root / "said").stat().st_size
        self.shell(after)
        return (self.root / "said").read_text()[start:]

    def wait_robot(self):
        def online():
            done = subprocess.run([support.PROGRAMS / "trb", "robot", "list", "--node", self.root / "nodes" / "mine"],
                                  capture_output=True, text=True, timeout=20)
            return re.search(r"^mine +ONLINE +ONLINE", done.stdout, re.MULTILINE)
        fleet = trb_fleet.Fleet(self.root / "none", support.PROGRAMS, robots={}, cloud=False)
        fleet.wait("the robot is connected", online, 60)

    def test_a_robot_that_speaks_a_known_transport(self):
        listener = socket.create_server(("127.0.157.12", 30100))
        self.addCleanup(listener.close)
        heard = []

        def robot():
            connection, _ = listener.accept()
            with connection, connection.makefile() as lines:
                heard.extend(line.strip() for line in lines)
        thread = threading.Thread(target=robot, daemon=True)
        thread.start()
        self.assertIn("handed_over", self.follow("A robot that speaks a known transport", 1))
        self.doCleanups()
        thread.join(10)
        self.assertEqual(heard, ["GO 1 0.5"])

    def test_a_robot_that_you_program(self):
        said = self.follow("A robot that you program", 2)
        self.assertIn("handed_over", said)
        self.assertIn("0 0 0", said)
        self.assertIn(" 0 wrong,", (self.root / "said").read_text())


if __name__ == "__main__":
    support.main()
