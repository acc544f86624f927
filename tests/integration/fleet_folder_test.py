"""The folder of a fleet's authority: commands that write in it side by side lose nothing; who types its passphrase may
stop. No node runs."""
import contextlib
import fcntl
import json
import os
import pathlib
import pty
import shutil
import signal
import subprocess
import termios
import time
import unittest

import support
import trb_fleet
import wire
from trb_process import wait_until

PASSPHRASE = "correct horse battery staple"
NODES = [f"arm{i}" for i in range(5)]
WAIT = 30  # for a starved machine


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = support.temporary_folder(self)
        self.authority = self.folder / "authority"
        self.trb("fleet", "init", self.authority)
        for node in NODES:
            (self.folder / node).mkdir()
            (self.folder / node / "node.json").write_text(json.dumps({"id": node}))
            self.trb("fleet", "request", self.folder / node)

    def start(self, *words):
        child = subprocess.Popen([support.PROGRAMS / "trb", *map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True, env=dict(os.environ, TRB_PASSPHRASE=PASSPHRASE),
                                 preexec_fn=trb_fleet.end_with_parent)
        self.addCleanup(child.communicate)
        self.addCleanup(child.kill)
        return child

    def trb(self, *words):
        child = self.start(*words)
        said, problem = child.communicate(timeout=WAIT)
        self.assertEqual(child.returncode, 0, problem)
        return said

    def refused(self, *words):
        child = self.start(*words)
        said, problem = child.communicate(timeout=WAIT)
        self.assertEqual(child.returncode, 1, said)
        return problem

    def request(self, node):
        return self.folder / node / "keys" / "request.json"

    def members(self):
        return {row["id"]: row["serial"] for row in json.loads(self.trb("fleet", "show", self.authority, "--json"))["nodes"]}

    def valid(self, authority):
        rows = json.loads(self.trb("fleet", "show", authority, "--json"))["nodes"]
        return sorted(row["id"] for row in rows if row["state"] == "valid")

    def change(self, name, change):
        told = json.loads((self.authority / name).read_text())
        change(told)
        (self.authority / name).write_text(json.dumps(told))

    def content(self):
        return {path.name: path.read_bytes() for path in self.authority.iterdir()}

    def test_requests_that_are_signed_side_by_side_are_all_kept(self):
        children = [self.start("fleet", "sign", self.authority, self.request(node)) for node in NODES]
        for child in children:
            self.assertEqual(child.wait(WAIT), 0)
        self.assertEqual(sorted(self.members()), NODES)
        self.assertEqual(len(set(self.members().values())), len(NODES))

    @contextlib.contextmanager
    def held(self):
        """The folder, as another command has it."""
        folder = os.open(self.authority, os.O_RDONLY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX)
            yield folder
        finally:
            os.close(folder)

    def waits_for_the_lock(self, child):
        row = f"-> FLOCK  ADVISORY  WRITE {child.pid} "
        return child.poll() is not None or row in pathlib.Path("/proc/locks").read_text()

    def test_each_command_that_writes_waits_until_the_folder_is_free_and_reads_it_then(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        for words in (("sign", self.authority, self.request(NODES[3])), ("renew", self.authority, NODES[0]),
                      ("revoke", self.authority, NODES[1]), ("tell", self.authority)):
            with self.subTest(words[0]), self.held() as lock:
                before = self.content()
                child = self.start("fleet", *words)
                self.assertIsNotNone(wait_until(lambda child=child: self.waits_for_the_lock(child), WAIT))
                self.assertIsNone(child.poll(), "it did not wait")
                self.assertEqual(self.content(), before)
                fcntl.flock(lock, fcntl.LOCK_UN)
                self.assertEqual(child.wait(WAIT), 0)

    def test_of_two_lists_with_one_number_neither_is_told_until_a_third_has_both(self):
        """The folder was put back from a copy, and has revoked since; a node knows the other list."""
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        copy = self.folder / "copy"
        shutil.copytree(self.authority, copy)
        self.trb("fleet", "revoke", self.authority, NODES[0])
        self.trb("fleet", "revoke", copy, NODES[1])
        node = self.folder / NODES[2]
        (node / "state").mkdir()
        (node / "state" / "news").write_bytes(self.news(self.authority))
        problem = self.refused("fleet", "tell", copy, "--via", node)
        self.assertIn("put back to an older copy", problem)
        self.assertIn(f"trb fleet revoke {copy} ID --via {node}", problem)
        self.assertIn("put back to an older copy", self.refused("fleet", "renew", copy, NODES[2], "--via", node))
        self.refused("fleet", "revoke", copy, NODES[1], "--via", node)  # no router is up there: signed, and not handed on
        self.assertEqual(self.valid(copy), [NODES[2]])

    def test_who_is_revoked_after_the_end_is_revoked_for_good(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        self.change("issued.json", lambda issued: issued["certificates"][0].update(not_after=1))
        said = self.trb("fleet", "revoke", self.authority, NODES[0], "--reason", "stolen")
        self.assertIn(f"{NODES[0]}: revoked up to serial 1; its certificate had ended already", said)
        self.trb("fleet", "revoke", self.authority, NODES[1])  # this list need not have the first one any more
        self.assertEqual(self.valid(self.authority), [NODES[2]])
        rows = json.loads(self.trb("fleet", "show", self.authority, "--json"))["nodes"]
        self.assertEqual([row["state"] for row in rows], ["revoked", "revoked", "valid"])
        self.assertIn(f"'{NODES[0]}' is revoked already", self.refused("fleet", "renew", self.authority, NODES[0]))
        self.assertIn("were revoked", self.refused("fleet", "sign", self.authority, self.request(NODES[0])))

    def test_of_two_copies_that_are_used_in_turn_each_says_whom_the_other_s_list_lacks(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:4]))
        copy = self.folder / "copy"
        shutil.copytree(self.authority, copy)
        self.trb("fleet", "revoke", self.authority, NODES[0])
        self.trb("fleet", "revoke", copy, NODES[1])
        self.trb("fleet", "revoke", copy, NODES[2])  # its list 2 is the newer one
        node = self.folder / NODES[3]
        (node / "state").mkdir()
        (node / "state" / "news").write_bytes(self.news(copy))
        for words in (("tell", self.authority), ("renew", self.authority, NODES[3])):
            problem = self.refused("fleet", *words, "--via", node)
            self.assertIn(f"list 2 lacks '{NODES[0]}' (serial 1), which was revoked in {self.authority}", problem)
            self.assertIn(f"trb fleet revoke {self.authority} {NODES[0]} --via {node}", problem)
        self.assertEqual(self.valid(self.authority), [NODES[3]])
        self.refused("fleet", "revoke", self.authority, NODES[0], "--via", node)  # no router is up there: signed
        problem = self.refused("fleet", "tell", self.authority, "--via", node)
        self.assertIn("does not answer", problem)
        self.assertEqual(self.valid(self.authority), [NODES[3]])

    def test_a_clock_that_contradicts_the_folder_or_the_node_signs_nothing(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        node, day = self.folder / NODES[2], 86_400 * 10**9
        (node / "state").mkdir()
        noted = node / "state" / "utc"
        signs = (("sign", self.authority, self.request(NODES[3])), ("renew", self.authority, NODES[0]),
                 ("revoke", self.authority, NODES[1]))
        begins = [row["not_before"] for row in json.loads((self.authority / "issued.json").read_text())["certificates"]]

        def begin(first):
            self.change("issued.json", lambda issued: issued["certificates"][-1].update(not_before=first))

        for why, first, told in (("has signed at", time.time_ns() + day, None),
                                 ("has last noted", begins[-1], time.time_ns() - 31 * day),
                                 ("the node knows that it is", begins[-1], time.time_ns() + day)):
            begin(first)
            via = ("--via", node) if told else ()
            if told:
                noted.write_text(f"{told}\n")
            before = self.content()
            for words in signs:
                with self.subTest(why, command=words[0]):
                    problem = self.refused("fleet", *words, *via)
                    self.assertIn("conflict: the clock of this computer says ", problem)
                    self.assertIn(why, problem)
                    self.assertIn("--trust-clock", problem)
            self.assertEqual(self.content(), before, "something was signed")
        self.trb("fleet", "sign", self.authority, self.request(NODES[3]), "--via", node, "--trust-clock")

    def test_by_a_clock_that_lets_all_have_ended_nobody_is_revoked(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        self.change("issued.json", lambda issued: [row.update(not_after=1) for row in issued["certificates"]])
        before = self.content()
        problem = self.refused("fleet", "revoke", self.authority, NODES[0])
        self.assertIn("the certificates of all nodes have ended", problem)
        self.assertEqual(self.content(), before)
        self.trb("fleet", "revoke", self.authority, NODES[0], "--trust-clock")

    def test_a_node_whose_knowledge_cannot_be_read_is_not_one_that_knows_nothing(self):
        """The folder was put back from a copy; what was revoked since is in the node's file, which is damaged."""
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        copy = self.folder / "copy"
        shutil.copytree(self.authority, copy)
        self.trb("fleet", "revoke", self.authority, NODES[0])
        node = self.folder / NODES[2]
        (node / "state").mkdir()
        known = node / "state" / "news"
        before = {path.name: path.read_bytes() for path in copy.iterdir()}
        for damage in (lambda: known.write_bytes(self.news(self.authority)[:100]), lambda: (known.unlink(), known.mkdir())):
            damage()
            for words in (("renew", copy, "--all"), ("revoke", copy, NODES[1]), ("tell", copy)):
                problem = self.refused("fleet", *words, "--via", node)
                self.assertIn(f"what {node} knows cannot be read: {known}: ", problem)
                self.assertIn("name another node with --via", problem)
            self.assertEqual({path.name: path.read_bytes() for path in copy.iterdir()}, before)
        known.rmdir()
        known.write_bytes(self.news(self.authority))
        self.refused("fleet", "renew", copy, "--all", "--via", node)  # no router is up there: signed, and not handed on
        self.assertEqual(self.valid(copy), NODES[1:3])

    def test_what_is_done_is_json_for_a_program(self):
        made = json.loads(self.trb("fleet", "init", self.folder / "second", "--json"))
        self.assertEqual((made["dir"], made["name"]), (str(self.folder / "second"), "fleet"))
        self.assertEqual(json.loads(self.trb("fleet", "request", self.folder / NODES[0], "--json")),
                         {"request": str(self.request(NODES[0]))})
        signed = json.loads(self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:2]), "--json"))
        self.assertEqual(signed, {"certificates": [str(self.folder / node / "keys" / "certificate.json") for node in NODES[:2]]})

    def test_what_is_not_handed_on_names_the_way_and_a_repeat_goes_it(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        node, before = self.folder / NODES[2], self.content()
        for words in (("revoke", self.authority, NODES[0]), ("renew", self.authority, NODES[0]), ("tell", self.authority)):
            problem = self.refused("fleet", *words, "--via", self.folder / "mistyped")
            self.assertIn("mistyped: no node.json there", problem)
        self.assertEqual(self.content(), before, "something was signed")
        way = f"trb fleet tell {self.authority} --via {node}"
        problem = self.refused("fleet", "revoke", self.authority, NODES[0], "--via", node)  # no router is up there
        self.assertIn(f"signed, and in {self.authority}, but the fleet does not know", problem)
        self.assertIn(way, problem)
        problem = self.refused("fleet", "revoke", self.authority, NODES[0], "--via", node)
        self.assertIn("but the fleet does not know", problem)
        self.assertIn(way, problem)
        self.assertIn(f"trb fleet tell {self.authority} --via NODE_DIR", self.refused("fleet", "revoke", self.authority, NODES[0]))
        self.refused("fleet", "revoke", self.authority, NODES[0], NODES[1], "--via", node)
        self.assertEqual(self.valid(self.authority), [NODES[2]], "who is revoked already kept another from it")

    def news(self, authority):
        """What a node that has taken this folder's news has on disk."""
        news = json.loads((authority / "news.json").read_text())
        record = news["revocations"]
        return wire.pack([[record["kind"], record["signer"], bytes.fromhex(record["payload"]),
                           bytes.fromhex(record["signature"])], []])

    def test_all_leaves_out_who_has_ended_or_is_revoked_and_tells_of_whom_the_folder_does_not_know(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:4]))
        self.trb("fleet", "revoke", self.authority, NODES[0])
        self.change("issued.json", lambda issued: issued["certificates"][3].update(not_after=1))
        self.change("fleet.json", lambda fleet: fleet.update(next_serial=fleet["next_serial"] + 1))  # of a version that kept none
        before = self.members()
        said = self.trb("fleet", "renew", self.authority, "--all")
        self.assertIn(f"note: the certificate of {NODES[3]} has ended; name it to renew it", said)
        self.assertIn("note: 1 certificate was signed before this folder kept it; such a node is left out", said)
        self.assertEqual({node for node, serial in self.members().items() if serial > before[node]}, set(NODES[1:3]))

    def test_a_right_is_never_changed_for_everybody(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:2]))
        before = self.content()
        for right in ("--relay", "--no-relay"):
            said = self.refused("fleet", "renew", self.authority, "--all", right)
            self.assertIn(f"{right}: with --all it would change a right of every member", said)
        self.assertEqual(self.content(), before)

    def test_more_than_have_room_in_one_message_are_refused_before_anything_is_signed(self):
        self.trb("fleet", "sign", self.authority, self.request(NODES[0]))
        self.change("issued.json", lambda issued: issued.update(
            certificates=[dict(issued["certificates"][0], id=f"n{serial}", serial=serial) for serial in range(1, 258)]))
        before = self.content()
        self.assertIn("257 renewals at once; 256 at most", self.refused("fleet", "renew", self.authority, "--all"))
        self.assertTrue(self.content() == before, "something was signed")  # assertEqual would compare it line by line for hours

    def test_who_is_asked_for_the_passphrase_may_stop_and_the_terminal_shows_again_what_is_typed(self):
        env = {name: value for name, value in os.environ.items() if name != "TRB_PASSPHRASE"}
        for words in (("sign", self.authority, self.request(NODES[0])), ("invite", self.authority, NODES[0])):
            for how in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(words[0], how=how):
                    master, terminal = pty.openpty()
                    self.addCleanup(os.close, master)
                    self.addCleanup(os.close, terminal)
                    child = subprocess.Popen([support.PROGRAMS / "trb", "fleet", *words], stdin=terminal, stdout=terminal,
                                             stderr=terminal, env=env, preexec_fn=trb_fleet.end_with_parent)
                    self.addCleanup(child.wait)
                    self.addCleanup(child.kill)
                    shows = lambda terminal=terminal: bool(termios.tcgetattr(terminal)[3] & termios.ECHO)
                    self.assertIsNotNone(wait_until(lambda shows=shows: not shows(), WAIT), "it does not ask")
                    child.send_signal(how)
                    self.assertEqual(child.wait(WAIT), -how)
                    self.assertTrue(shows())

    def test_a_pipe_in_a_file_s_place_that_somebody_holds_open_keeps_no_command_waiting(self):
        self.trb("fleet", "sign", self.authority, *map(self.request, NODES[:3]))
        for node in NODES[:2]:
            self.trb("fleet", "revoke", self.authority, node)
        for name in ("fleet.json", "authority.key", "issued.json", "revocations.json", "revoked.json"):
            file, kept = self.authority / name, self.folder / name
            file.rename(kept)
            os.mkfifo(file, 0o600)
            holder = os.open(file, os.O_RDWR)
            with self.subTest(name):
                problem = self.refused("fleet", "renew", self.authority, NODES[2])
                self.assertIn(f"{file}: is a pipe, and nothing comes out of it", problem)
            os.close(holder)
            kept.replace(file)
        self.trb("fleet", "renew", self.authority, NODES[2])

    def test_what_a_killed_command_has_left_half_written_goes_with_the_next_one(self):
        left, young = self.authority / "authority.key.new4711", self.authority / "news.json.new4712"
        for path in (left, young):
            path.write_text("half")
        os.utime(left, (time.time() - 3600,) * 2)
        self.trb("fleet", "sign", self.authority, self.request(NODES[0]))
        self.assertEqual((left.exists(), young.exists()), (False, True))

    def test_a_node_of_another_fleet_is_told_as_that_and_nothing_is_signed(self):
        self.trb("fleet", "sign", self.authority, self.request(NODES[0]))
        other, stranger = self.folder / "other", self.folder / NODES[4]
        self.trb("fleet", "init", other)
        self.trb("fleet", "sign", other, self.request(NODES[4]))
        before = self.content()
        for words in (("renew", NODES[0]), ("revoke", NODES[0]), ("sign", self.request(NODES[1])), ("tell",)):
            with self.subTest(words[0]):
                problem = self.refused("fleet", words[0], self.authority, *words[1:], "--via", stranger)
                self.assertIn(f"foreign_fleet: --via {stranger}: a node of another fleet than that of {self.authority}", problem)
                self.assertIn("name the folder of a node of this fleet", problem)
                self.assertNotIn("sign the node's request", problem)
        self.assertEqual(self.content(), before)

    def test_a_folder_that_is_not_there_or_no_folder_is_named(self):
        for place in (self.folder / "nowhere", self.request(NODES[0])):
            self.assertIn("trb fleet init", self.refused("fleet", "sign", place, self.request(NODES[0])))


if __name__ == "__main__":
    support.main()
