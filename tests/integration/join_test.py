"""A node joins by a code, with real processes: used, wrong, withdrawn, replayed, in the middle, two at once, killed.

Addresses 127.0.219.x, 127.0.220.x, 127.0.224.x, 127.0.225.x.
"""
import json
import os
import re
import select
import signal
import socket
import subprocess
import threading
import time
import unittest

import support
import trb_fleet

BLOCK = 219
UDP_PORT = 50219
WAIT = 60  # for a starved machine


class Invite:
    """`trb fleet invite --json`, which waits for the node."""

    def __init__(self, case, fleet, name, *more):
        self.process = trb_fleet.Process(
            [support.PROGRAMS / "trb", "fleet", "invite", fleet.authority_dir(), name, "--via", fleet.dir("cloud"), "--json", *more],
            fleet.root / f"invite-{name}.log", env=dict(os.environ, TRB_PASSPHRASE=fleet.passphrase()))
        case.addCleanup(self.process.stop)
        self.code = json.loads(self.process.wait_line('"event":"code"', WAIT)[0])["code"]

    def event(self, name):
        return json.loads(self.process.wait_line(f'"event":"{name}"', WAIT)[0])

    def end(self):
        """Its exit status, and what it said."""
        end = time.monotonic() + WAIT
        while self.process.child.poll() is None and time.monotonic() < end:
            self.process.pump(0.05)
        self.process.pump(0)
        return self.process.child.poll(), self.process.lines


class Between(threading.Thread):
    """A man in the middle: passes bytes on, keeps them, and may change the nth one of an answer."""

    def __init__(self, to, change=None):
        super().__init__(daemon=True)
        self.to, self.change = to, change
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.asked, self.answered = [], []

    def run(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            self.pass_on(client)

    def pass_on(self, client):
        with client, socket.create_connection(self.to) as server:
            asked, answered = bytearray(), bytearray()
            while True:
                ready, _, _ = select.select([client, server], [], [], 10)
                if not ready:
                    break
                try:
                    for end in ready:
                        data = bytearray(end.recv(65536))
                        if not data:
                            raise ConnectionError
                        seen = asked if end is client else answered
                        if self.change and end is server and len(seen) <= self.change < len(seen) + len(data):
                            data[self.change - len(seen)] ^= 1
                        seen += data
                        (server if end is client else client).sendall(data)
                except OSError:
                    break
            self.asked.append(bytes(asked))
            self.answered.append(bytes(answered))

    def close(self):
        self.listener.close()


class Joining(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=BLOCK, udp_port=UDP_PORT, robots={})
        cls.fleet.start()

    def setUp(self):
        self.folder = support.temporary_folder(self)

    def new_node(self, name, folder=None):
        """A robot's empty PC; it is not started here."""
        folder = folder or self.folder / name
        self.fleet.trb("node", "new", folder, "--robot", name, "--like", "ur", "--address", f"127.0.{BLOCK + 1}.9", "--network",
                       f"127.0.{BLOCK}.9", "--interface", f"127.0.{BLOCK}.9")
        return folder

    def join(self, folder, code, *more):
        patience = [] if "--timeout" in more else ["--timeout", str(WAIT)]
        done = self.fleet.trb("node", "join", folder, *code.split(), "--json", *more, *patience, check=False, timeout=4 * WAIT)
        return done.returncode, json.loads(done.stdout)

    def refused(self, folder, code, *more):
        status, said = self.join(folder, code, *more)
        self.assertEqual(status, 1, said)
        self.assertFalse((folder / "keys" / "certificate.json").exists())
        return said["error"]

    def seeds(self, folder):
        return [seed["address"] for seed in json.loads((folder / "keys" / "certificate.json").read_text())["seeds"]]

    def serials(self, name):
        return [row["serial"] for row in self.fleet.json("fleet", "show", self.fleet.authority_dir())["nodes"] if row["id"] == name]

    def test_a_code_works_once_and_leaves_a_folder_that_is_good(self):
        folder = self.new_node("once")
        invite = Invite(self, self.fleet, "once")
        status, said = self.join(folder, invite.code)
        self.assertEqual((status, said["node"], said["seeds"]), (0, "once", 1), said)
        self.assertEqual(invite.event("signed")["identity"], said["identity"])
        self.assertEqual(invite.end()[0], 0)
        file = folder / "keys" / "certificate.json"
        self.assertEqual(file.stat().st_mode & 0o777, 0o600)
        self.assertEqual(json.loads(file.read_text())["seeds"][0]["address"], f"{self.fleet.address('cloud')}:45000")
        self.assertIn("no faults", self.fleet.trb("check", folder).stdout)
        # Used: another computer with it gets nothing, and nothing is signed.
        other = self.new_node("once", self.folder / "other")
        before = self.serials("once")
        self.assertIn(self.refused(other, invite.code)["code"], ("already_claimed", "not_permitted"))
        self.assertEqual(self.serials("once"), before)
        # A new code renews the same keys, on no other computer.
        again = Invite(self, self.fleet, "once")
        self.assertIn("other keys", self.refused(other, again.code)["what"])
        self.assertEqual(self.join(folder, again.code)[0], 0)
        self.assertEqual(again.end()[0], 0)
        self.no_secret_is_kept(invite.code)

    def no_secret_is_kept(self, code):
        """Two of its groups one after the other: a single one is so short that it is found in other keys by chance."""
        groups = code.split("-")[1:6]
        secrets = [(one + between + other).encode() for one, other in zip(groups, groups[1:]) for between in ("", "-")]
        for path in self.fleet.dir("cloud").glob("**/*"):
            if path.is_file() and not path.is_symlink():
                text = path.read_bytes()
                self.assertFalse([secret for secret in secrets if secret in text], path)

    def test_what_is_mistyped_is_named_by_its_group_and_nothing_is_asked(self):
        folder = self.new_node("typed")
        invite = Invite(self, self.fleet, "typed")
        watch = support.Watch(self.fleet, "cloud")
        groups = invite.code.split("-")
        groups[6] = groups[6][:2] + ("A" if groups[6][2] != "A" else "B") + groups[6][3:]
        self.assertIn("group 7", self.refused(folder, "-".join(groups))["what"])
        self.assertIn("110 characters", self.refused(folder, "-".join(groups[1:]))["what"])
        self.assertEqual(watch.rise(("invitations.",)), {})
        # Typed in groups, in small letters, it is the same.
        self.assertEqual(self.join(folder, invite.code.lower().replace("-", " "))[0], 0)

    def test_a_code_that_is_withdrawn_or_of_nobody_opens_nothing(self):
        folder = self.new_node("late")
        invite = Invite(self, self.fleet, "late")
        invite.process.child.send_signal(signal.SIGINT)
        self.assertEqual(invite.end()[0], 1)
        watch = support.Watch(self.fleet, "cloud")
        self.assertIn("does not know this code", self.refused(folder, invite.code)["what"])
        watch.wait_counted("refused.unknown_peer_key")
        self.assertEqual(self.serials("late"), [])

    def test_another_node_s_folder_and_a_robot_without_one_are_told_and_cost_no_code(self):
        invite = Invite(self, self.fleet, "named")
        self.assertIn("the code is for 'named'", self.refused(self.new_node("other"), invite.code)["what"])
        self.assertIn("trb node new", self.refused(self.folder / "none", invite.code)["cure"])
        self.assertEqual(self.join(self.new_node("named"), invite.code)[0], 0)

    def test_what_the_authority_refused_is_put_right_and_the_same_code_is_good_for_the_same_keys(self):
        first = Invite(self, self.fleet, "redo")
        self.assertEqual(self.join(self.new_node("redo"), first.code)[0], 0)
        self.assertEqual(first.end()[0], 0)
        folder = self.new_node("redo", self.folder / "other")
        invite = Invite(self, self.fleet, "redo")
        self.assertIn("other keys", self.refused(folder, invite.code)["what"])
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "redo", "--via", self.fleet.dir("cloud"))
        status, said = self.join(folder, invite.code)
        self.assertEqual(status, 0, said)
        self.assertEqual(invite.end()[0], 0)

    def test_two_computers_at_once_one_joins_and_both_ends_know(self):
        folders = [self.new_node("twin", self.folder / name) for name in ("a", "b")]
        invite = Invite(self, self.fleet, "twin")
        answers = [None, None]

        def join(i):
            answers[i] = self.join(folders[i], invite.code)
        threads = [threading.Thread(target=join, args=(i,)) for i in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(status for status, _ in answers), [0, 1], answers)
        loser = [said for status, said in answers if status][0]
        self.assertEqual(loser["error"]["code"], "already_claimed")
        self.assertIn("trb fleet revoke", loser["error"]["cure"])
        self.assertEqual(sum((folder / "keys" / "certificate.json").exists() for folder in folders), 1)
        self.assertEqual(len(self.serials("twin")), 1)

    def test_who_stands_between_reads_nothing_changes_nothing_and_replays_nothing(self):
        folder = self.new_node("middle")
        invite = Invite(self, self.fleet, "middle")
        door = (self.fleet.address("cloud"), 45000)
        # A change anywhere in an answer: no certificate comes of it.
        for change in (20, 330):
            between = Between(door, change)
            between.start()
            self.addCleanup(between.close)
            status, said = self.join(folder, invite.code, "--at", between.address, "--timeout", "6")
            between.close()
            self.assertEqual((status, (folder / "keys" / "certificate.json").exists()), (1, False), said)
        between = Between(door)
        between.start()
        self.addCleanup(between.close)
        self.assertEqual(self.join(folder, invite.code, "--at", between.address)[0], 0)
        self.assertEqual(invite.end()[0], 0)
        between.close()
        seen = b"".join(between.asked + between.answered)
        self.assertGreater(len(seen), 1000)
        link_key = json.loads((folder / "keys" / "request.json").read_text())
        for word in (b"middle", b"join_call", b"certificate", bytes.fromhex(link_key["signature"])):
            self.assertNotIn(word, seen)
        # What it has kept, it says again: no connection comes of it.
        watch = support.Watch(self.fleet, "cloud")
        again = Invite(self, self.fleet, "middle")
        # Where it was reached, it will be dialled again.
        self.assertEqual(self.seeds(folder), [between.address])
        for asked in between.asked[:2]:
            with socket.create_connection(door) as replay:
                replay.sendall(asked)
                replay.settimeout(WAIT)
                try:
                    while replay.recv(65536):
                        pass
                except ConnectionError:
                    pass  # cut
        self.assertEqual(watch.rise(("invitations.calls",)), {})
        again.process.child.send_signal(signal.SIGINT)
        self.assertEqual(again.end()[0], 1)

    def test_another_computer_at_the_cloud_s_address_gets_nothing(self):
        folder = self.new_node("astray")
        invite = Invite(self, self.fleet, "astray")
        thief = support.make_fleet(self, block=BLOCK + 5, udp_port=UDP_PORT + 1, robots={})
        thief.start()
        error = self.refused(folder, invite.code, "--at", f"{thief.address('cloud')}:45000", "--timeout", "6")
        self.assertEqual(error["code"], "peer_unreachable")
        self.assertIn("another computer answers", error["what"])
        self.assertEqual(self.join(folder, invite.code)[0], 0)

    def test_the_cloud_node_s_router_is_killed_in_between_and_the_code_stays_good(self):
        folder = self.new_node("patient")
        invite = Invite(self, self.fleet, "patient")
        os.kill(self.fleet.pid("cloud", "router"), signal.SIGKILL)
        self.fleet.wait("the router is up again", lambda: self.fleet.trb("route", "list", node="cloud", check=False).returncode == 0, WAIT)
        watch = support.Watch(self.fleet, "cloud")
        self.fleet.wait("the invitation is there again", lambda: watch.counters().get("invitations.held", 0) >= 1, WAIT)
        self.assertEqual(self.join(folder, invite.code)[0], 0)
        self.assertEqual(invite.end()[0], 0)

    def test_a_node_that_calls_before_the_restarted_cloud_node_knows_the_code_again_goes_on(self):
        for name in ("early", "early2", "early3"):  # it goes on for 15 s, which a stalled machine uses up
            folder = self.new_node(name)
            invite = Invite(self, self.fleet, name)
            invite.process.child.send_signal(signal.SIGSTOP)
            os.kill(self.fleet.pid("cloud", "router"), signal.SIGKILL)
            self.fleet.wait("the router is up again", lambda: self.fleet.trb(
                "route", "list", node="cloud", check=False).returncode == 0, WAIT)
            watch = support.Watch(self.fleet, "cloud")
            answers = []
            joining = threading.Thread(target=lambda: answers.append(self.join(folder, invite.code)))
            joining.start()
            watch.wait_logged("unknown_peer_key", WAIT)
            invite.process.child.send_signal(signal.SIGCONT)
            joining.join()
            if answers[0][0] == 0:
                break
            invite.process.stop(signal.SIGINT)
        self.assertEqual(answers[0][0], 0, answers)
        self.assertEqual(invite.end()[0], 0)

    def test_the_code_is_asked_for_and_an_address_that_the_inviter_names_is_kept(self):
        folder = self.new_node("asked")
        between = Between((self.fleet.address("cloud"), 45000))
        between.start()
        self.addCleanup(between.close)
        process = trb_fleet.Process(
            [support.PROGRAMS / "trb", "fleet", "invite", self.fleet.authority_dir(), "asked", "--via", self.fleet.dir("cloud"),
             "--at", between.address], self.folder / "invite.log", env=dict(os.environ, TRB_PASSPHRASE=self.fleet.passphrase()))
        self.addCleanup(process.stop)
        told, end = process.wait_line("on the new computer", WAIT)
        code = next(line.strip() for line in process.lines[:end] if re.fullmatch(r"  ([0-9A-Z]{5}-)+[0-9A-Z]{5}", line))
        # Nobody else on the new computer sees it.
        self.assertIn("trb node join DIR ", told)
        self.assertNotIn("CODE", told)
        done = subprocess.run([support.PROGRAMS / "trb", "node", "join", folder], input=code + "\n", capture_output=True, text=True,
                              timeout=4 * WAIT)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.seeds(folder), [between.address])

    def test_a_join_that_is_killed_leaves_the_old_state_or_the_finished_one_and_can_be_repeated(self):
        folder = self.new_node("killed")
        invite = Invite(self, self.fleet, "killed")
        certificate = folder / "keys" / "certificate.json"
        command = [support.PROGRAMS / "trb", "node", "join", folder, invite.code]
        for step in range(6):
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                     preexec_fn=trb_fleet.end_with_parent)
            select.select([], [], [], 0.05 * step)  # where it is killed, not what is waited for
            child.kill()
            child.wait()
            if certificate.exists():
                break
            self.assertEqual(sorted(path.name for path in folder.glob("*.making")), [])
        status, said = self.join(folder, invite.code)
        if certificate.exists() and status:
            self.assertIn(said["error"]["code"], ("not_permitted", "already_claimed"))
        else:
            self.assertEqual(status, 0, said)
        self.assertIn("no faults", self.fleet.trb("check", folder).stdout)
        self.assertEqual(len(self.serials("killed")), 1)

    def test_a_cloud_node_s_folder_is_made(self):
        invite = Invite(self, self.fleet, "cloud2", "--role", "cloud")
        status, said = self.join(f"{self.folder}/cloud2/", invite.code, "--network", f"127.0.{BLOCK}.8")
        self.assertEqual(status, 0, said)
        self.assertEqual((self.folder / "cloud2").stat().st_mode & 0o777, 0o700)
        self.assertTrue((self.folder / "cloud2" / "places.json").exists())
        self.assertIn("no faults", self.fleet.trb("check", self.folder / "cloud2").stdout)
        self.assertEqual(invite.end()[0], 0)

    def test_what_is_wrong_at_the_inviter_is_named(self):
        def invite(*words, **env):
            done = subprocess.run([support.PROGRAMS / "trb", "fleet", "invite", *map(str, words), "--json"], capture_output=True, text=True,
                                  timeout=WAIT, stdin=subprocess.DEVNULL, env={**os.environ, "TRB_PASSPHRASE": self.fleet.passphrase(), **env})
            self.assertEqual(done.returncode, 1, done.stdout)
            return json.loads(done.stdout)["error"]
        authority, via = self.fleet.authority_dir(), self.fleet.dir("cloud")
        self.assertIn("NAME", invite(authority, "A b", "--via", via)["what"])
        self.assertIn("--role", invite(authority, "a", "--via", via, "--role", "king")["what"])
        self.assertIn("passphrase is wrong", invite(authority, "a", "--via", via, TRB_PASSPHRASE="wrong passphrase")["what"])
        self.assertIn("--through", invite(authority, "a", "--via", via, "--through", "clod")["what"])
        self.assertIn("--via", invite(authority, "a")["cure"])
        self.assertTrue(re.search("--at", invite(authority, "a", "--via", via, "--at", "cloud.example:45000")["cure"]))


if __name__ == "__main__":
    support.main()
