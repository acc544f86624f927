"""The node as systemd's service: its units, judged by systemd-analyze, and what `trb up` says to systemd (sd_notify(3)).

Addresses 127.0.126.x. No systemd runs here: the test is its ear.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import time
import unittest

import support
import skips  # by the path of support
import trb_fleet

UNITS = support.REPO / "deploy" / "systemd"
BLOCK = 126
WATCHDOG_S = 1.0
# Of systemd-analyze security: 0 is locked up, 10 is free; the issue allows 3.0.
MOST_EXPOSED = 3.0


class OneNode(trb_fleet.Fleet):
    def __init__(self, root):
        super().__init__(root, support.PROGRAMS, block=BLOCK, udp_port=50126, robots={})

    def node_json(self, node):
        return {"id": node, "role": "cloud", "services": ["router", "scheduler"]}


class Units(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if shutil.which("systemd-analyze") is None:
            skips.leave("there is no systemd-analyze: apt-get install systemd")
        cls.folder = support.temporary_folder(cls)
        # The programs are where the package puts them.
        for unit in UNITS.glob("*.service"):
            (cls.folder / unit.name).write_text(re.sub(r"/usr/bin/(?=trb)", f"{support.PROGRAMS}/", unit.read_text()))

    def test_systemd_reads_every_word(self):
        for unit in sorted(self.folder.glob("*.service")):
            with self.subTest(unit.name):
                done = subprocess.run(["systemd-analyze", "verify", "--man=no", unit], capture_output=True, text=True, timeout=60,
                                      env={**os.environ, "SYSTEMD_UNIT_PATH": f"{self.folder}:"})
                own = [line for line in done.stderr.splitlines() if "talkrobots" in line]
                self.assertEqual(own, [])
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_they_are_locked_up(self):
        for unit in sorted(self.folder.glob("*.service")):
            with self.subTest(unit.name):
                done = subprocess.run(["systemd-analyze", "security", "--offline=true", "--no-pager", unit],
                                      capture_output=True, text=True, timeout=60)
                exposed = float(re.search(r"Overall exposure level for \S+: ([\d.]+)", done.stdout)[1])
                print(f"{unit.name}: exposure {exposed}")
                self.assertLessEqual(exposed, MOST_EXPOSED, done.stdout)

    def test_its_user_is_one_that_systemd_can_make(self):
        root = self.folder / "root"
        (root / "etc").mkdir(parents=True)
        done = subprocess.run(["systemd-sysusers", f"--root={root}", UNITS / "talkrobots.sysusers"], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("trbots:", (root / "etc" / "passwd").read_text())


class Notify(unittest.TestCase):
    """`trb up` with the environment that systemd gives it."""

    def setUp(self):
        folder = support.temporary_folder(self)
        self.fleet = OneNode(folder / "fleet")
        self.fleet.make()
        self.ear = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.ear.close)
        self.ear.bind(str(folder / "notify"))
        self.ear.settimeout(30)
        environment = {**os.environ, "NOTIFY_SOCKET": str(folder / "notify"), "WATCHDOG_USEC": str(int(WATCHDOG_S * 1e6))}
        self.log = open(folder / "up.log", "wb")
        self.addCleanup(self.log.close)
        command = [support.PROGRAMS / "trb", "up", self.fleet.dir("cloud"), "--without", "sensor-bus", "--die-with-parent"]
        self.up = subprocess.Popen(command, env=environment, stdout=self.log, stderr=self.log,
                                   preexec_fn=trb_fleet.end_with_parent)
        self.addCleanup(self.up.wait)
        self.addCleanup(self.up.kill)

    def hear_until(self, word):
        """Every word up to that one, each with when it came."""
        heard = []
        while not heard or heard[-1][1] != word:
            word_heard = self.ear.recv(4096).decode().strip()
            heard.append((time.monotonic(), word_heard))
        return heard

    def test_it_is_ready_alive_and_ends(self):
        self.hear_until("READY=1")
        rows = json.loads(self.fleet.trb("service", "list", "--json", node="cloud").stdout)["services"]
        self.assertEqual({row["service"]: row["state"] for row in rows}, {"router": "up", "scheduler": "up"})
        first, second, third = (self.hear_until("WATCHDOG=1")[-1][0] for _ in range(3))
        # A machine that others use may be late, but not by as much as systemd would end it for.
        self.assertLess(second - first, WATCHDOG_S)
        self.assertLess(third - second, WATCHDOG_S)
        self.up.send_signal(signal.SIGTERM)
        self.hear_until("STOPPING=1")
        self.assertEqual(self.up.wait(15), 0)

    def test_its_services_do_not_speak_to_systemd(self):
        self.hear_until("READY=1")
        for service in ("router", "scheduler"):
            environment = pathlib.Path(f"/proc/{self.fleet.pid_of_child(self.up.pid, service)}/environ").read_bytes()
            self.assertNotIn(b"NOTIFY_SOCKET", environment)
            self.assertNotIn(b"WATCHDOG_USEC", environment)

    def test_it_hangs_and_says_nothing(self):
        """Then systemd ends it: the watchdog's words stop with the process."""
        self.hear_until("READY=1")
        self.hear_until("WATCHDOG=1")
        self.up.send_signal(signal.SIGSTOP)
        self.addCleanup(self.up.send_signal, signal.SIGCONT)
        self.ear.settimeout(WATCHDOG_S)
        heard = 0
        with self.assertRaises(TimeoutError):
            while True:
                self.ear.recv(4096)
                heard += 1
        self.assertLessEqual(heard, 1, "one may have been under way")


if __name__ == "__main__":
    support.main()
