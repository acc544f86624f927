"""Nodes that are put out of a fleet while it is up, and the lists that say so. No process restarts in between, but where
that is the story. Addresses 127.0.110.x."""
import collections
import datetime
import json
import shutil
import time

import zmq

import authority
import support
import wire
from certified import Life
from router_client import Member


class Revoked(Life):
    block = 110

    def test_revoked_while_connected(self):
        """In force on every node within two seconds, sent by one of them; no process restarts."""
        links = {node: self.routes(node)[other]["link"] for node, other in (("ant", "bee"), ("bee", "ant"))}
        start = time.time()
        said = self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--reason", "stolen", "--via",
                              self.fleet.dir("bee")).stdout
        self.assertIn("list 1, beacon key 2 for the 4 nodes that stay", said)
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has no cat", lambda: "cat" not in self.routes(node), 60)
        told, last = (self.logged_at(node, "peer_revoked") for node in ("bee", "ant"))
        print(f"revoked: {told - start:.2f} s to sign and hand over, {last - told:.2f} s more until every node has it")
        for node in ("ant", "bee"):
            self.watches[node].wait_counted("refused.cert_revoked")
            self.watches[node].wait_logged("peer_revoked cat (serial 3): stolen")
            self.watches[node].wait_logged("beacon_key number 2 from now on")
        spread = [last - told]
        for number, node in ((2, "dog"), (3, "elk")):  # what a stalled machine adds comes and goes
            if min(spread) >= 2:
                self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), node, "--via", self.fleet.dir("bee"))
                told, last = (self.logged_at(one, f"revocations list {number}") for one in ("bee", "ant"))
                spread.append(last - told)
        self.assertLess(min(spread), 2)
        self.watches["cat"].wait_logged("own_certificate_over this node's certificate is revoked: stolen")
        self.assertIn("revoked: stolen", self.fleet.services("cat")["router"]["note"])
        self.fleet.wait("cat is alone", lambda: self.online("cat") == set(), 60)  # its peers end its links
        self.assert_same_processes()
        for node, other in (("ant", "bee"), ("bee", "ant")):
            self.assertEqual(self.routes(node)[other]["link"], links[node], "the link of those that stay was lost")

    def logged_at(self, node, event):
        """By the line's own time: that of the next start of `trb` is this machine's, not the fleet's."""
        self.watches[node].wait_logged(f" {event} ", 60)
        line = next(line for line in self.watches[node].log().splitlines() if f" {event} " in line)
        return datetime.datetime.fromisoformat(line.split()[0].replace("Z", "+00:00")).timestamp()

    def test_a_revoked_node_s_key_knocks_in_vain(self):
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.watch.wait_logged("peer_revoked cat")
        before = self.watch.rise().get("refused.cert_revoked", 0)
        client = self.client(Member(self.fleet, "cat"))
        client.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.cert_revoked", before + 1)
        self.watch.wait_logged("revoked_key the revoked key of 'cat' knocked")

    def test_a_revoked_node_that_was_never_met(self):
        """It is refused at its Hello, and gets the list that revokes it."""
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "dog", "--via", self.fleet.dir("ant"))
        dog = Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog)
        self.assertEqual(client.receive().subtype, "fleet_news")
        self.assertEqual(client.wait_goodbye(), "cert_revoked")
        self.watch.wait_counted("refused.cert_revoked")
        self.watch.wait_logged("candidate_refused cert_revoked: certificate of 'dog' (serial 4) is revoked by list 1")

    def test_the_beacon_key_is_another_one(self):
        """The revoked node's beacons under the old key are ignored; a node that is signed now joins by beacon."""
        listener = support.beacon_listener(self, 50000 + self.block, 60)
        sender = None
        while sender != self.fleet.address("cat"):
            old, (sender, _) = listener.recvfrom(4096)
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.watch.wait_logged("beacon_key number 2")
        before = self.watch.rise().get("beacon.wrong_key", 0)
        listener.sendto(old, ("127.255.255.255", 50000 + self.block))
        self.watch.wait_counted("beacon.wrong_key", before + 1)
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), self.fleet.dir("dog") / "keys" / "request.json")
        self.fleet.bring_up("dog")
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has dog", lambda: "dog" in self.online(node), 60)
        self.fleet.wait("dog has both", lambda: self.online("dog") == {"ant", "bee"}, 60)
        self.assert_same_processes()

    def test_a_list_that_came_by_hand_and_a_restart(self):
        """news.json in one node's keys folder is enough; what is in force outlives every process."""
        said = self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat").stdout
        self.assertIn("the fleet does not know it yet", said)
        self.assertIn("cat", self.online())
        news = self.fleet.authority_dir() / "news.json"
        self.assertEqual(news.stat().st_mode & 0o777, 0o644)  # who copies it as root must not close it to the node's user
        brought = self.fleet.dir("bee") / "keys" / "news.json"
        brought.with_name("a folder").mkdir()
        brought.with_name("a folder").rename(brought)  # nobody can read it, root neither
        self.fleet.wait("bee says that it cannot read it",
                        lambda: "not in force: keys/news.json: cannot read" in self.fleet.services("bee")["router"]["note"], 60)
        brought.rmdir()
        shutil.copy(news, brought)
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has no cat", lambda: "cat" not in self.routes(node), 60)
        self.assert_same_processes()
        self.fleet.trb("reload", self.fleet.dir("ant"))
        self.fleet.wait("ant is another process", lambda: self.fleet.pid("ant", "router") not in (None, self.pids["ant"]), 60)
        self.fleet.wait("ant and bee are linked", lambda: self.online("bee") == {"ant"}, 60)
        self.watch.wait_logged("revocations list 1")
        self.assertNotIn("cat", self.routes())
        client = self.client(Member(self.fleet, "cat"))
        self.hello(client, Member(self.fleet, "cat"))
        self.assertEqual(client.wait_goodbye(), "cert_revoked")

    def test_a_list_that_is_damaged_forgets_nobody(self):
        """A copy stands in for it; without one the node lets nobody in until a person has mended it."""
        folder = self.fleet.dir("ant")
        news, copy = folder / "state/news", folder / "state/news.copy"
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--reason", "stolen", "--via", folder)
        self.fleet.wait("ant has no cat", lambda: "cat" not in self.routes(), 60)
        self.fleet.nodes.pop("bee").stop()  # it would tell the list anew

        def damage(path):
            content = bytearray(path.read_bytes())
            content[content.index(b"cat")] ^= 1
            path.write_bytes(content)

        def restart():
            self.fleet.nodes.pop("ant").stop()
            self.fleet.start_node("ant")
            self.fleet.nodes["ant"].wait_line("ready", 60)
        damage(news)
        self.assertIn("state/news: is damaged", self.fleet.trb("check", folder, check=False).stderr)
        restart()
        self.watch.wait_logged("copy_used")
        self.fleet.wait("both are whole", lambda: news.read_bytes() == copy.read_bytes(), 60)
        self.assertEqual(self.fleet.trb("check", folder, check=False).stderr, "")

        damage(news)
        damage(copy)
        restart()
        self.watch.wait_logged("revocations_unknown who is revoked is not known")
        self.fleet.bring_up("bee")
        self.client(Member(self.fleet, "dog")).wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        self.watch.wait_counted("refused.revocations_unknown")
        self.assertEqual(self.online(), set())
        self.assertIn("state/news: is damaged", self.fleet.services("ant")["router"]["note"])
        found = json.loads(self.fleet.trb("doctor", "--json", node="ant", check=False).stdout)["findings"]
        self.assertIn(("revocations_unknown", "problem"), [(row["cause"], row["severity"]) for row in found])
        # What it does not know it does not take over: it might be older.
        told = self.fleet.trb("fleet", "tell", self.fleet.authority_dir(), "--via", folder, check=False)
        self.assertIn(f"rm {folder.resolve()}/state/news", told.stderr)

        shutil.copy(self.fleet.authority_dir() / "news.json", folder / "keys")
        news.unlink()
        copy.unlink()
        self.fleet.wait("ant has bee by itself", lambda: self.online() == {"bee"}, 60)
        self.assertNotIn("cat", self.routes())
        self.watch.wait_logged("revocations_known it starts again")

    def test_a_folder_put_back_from_an_older_copy(self):
        """It learns what the fleet knows: a renewal admits nothing again that was revoked since the copy."""
        folder, via = self.fleet.authority_dir(), self.fleet.dir("ant")
        copy = folder.with_name("copy")
        shutil.copytree(folder, copy)
        self.fleet.trb("fleet", "revoke", folder, "cat", "--via", via)
        shutil.rmtree(folder)
        copy.rename(folder)
        self.assertIn("was older than what", self.fleet.trb("fleet", "tell", folder, "--via", via).stdout)
        again = self.fleet.trb("fleet", "renew", folder, self.fleet.dir("cat") / "keys" / "certificate.json", "--via", via,
                               check=False)
        self.assertIn("cert_revoked", again.stderr)
        self.assertIn("list 2, beacon key 3 for the 3 nodes that stay",
                      self.fleet.trb("fleet", "revoke", folder, "elk", "--via", via).stdout)
        self.watches["bee"].wait_logged("revocations list 2")
        self.assertEqual(self.online("bee"), {"ant"})

    def older_copy(self):
        """The folder as it was before cat, dog and elk were signed; what is in the folder now is lost by put_back()."""
        folder = self.fleet.authority_dir()
        copy = folder.with_name("older")
        shutil.copytree(folder, copy)
        for name, change in (("issued.json", lambda told: told.update(certificates=told["certificates"][:2])),
                             ("fleet.json", lambda told: told.update(next_serial=3))):
            told = json.loads((copy / name).read_text())
            change(told)
            (copy / name).write_text(json.dumps(told))
        return copy

    def put_back(self, copy):
        folder = self.fleet.authority_dir()
        shutil.rmtree(folder)
        copy.rename(folder)
        return folder

    def test_who_was_signed_and_revoked_after_the_copy_stays_revoked(self):
        """In the lists of the folder that was put back, and by its keys; no serial is given twice."""
        copy, via = self.older_copy(), self.fleet.dir("ant")
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "cat", "--reason", "stolen", "--via", via)
        folder = self.put_back(copy)
        self.assertIn("was older than what", self.fleet.trb("fleet", "tell", folder, "--via", via).stdout)
        self.fleet.trb("fleet", "revoke", folder, "bee", "--reason", "sold", "--via", via)
        self.watch.wait_logged(": 2 revoked, beacon key 3")
        rows = {row["id"]: row for row in json.loads(self.fleet.trb("fleet", "show", folder, "--json").stdout)["nodes"]}
        self.assertEqual(rows["cat"]["state"], "revoked")
        client = self.client(Member(self.fleet, "cat"))
        client.wait_event(zmq.EVENT_HANDSHAKE_FAILED_AUTH)
        refused = self.fleet.trb("fleet", "sign", folder, self.fleet.dir("cat") / "keys" / "request.json", check=False)
        self.assertIn("cert_revoked: the keys of 'cat' in this request were revoked", refused.stderr)
        self.fleet.trb("fleet", "sign", folder, self.fleet.dir("dog") / "keys" / "request.json")
        rows = {row["id"]: row for row in json.loads(self.fleet.trb("fleet", "show", folder, "--json").stdout)["nodes"]}
        self.assertGreater(rows["dog"]["serial"], 1000)

    def test_a_node_that_only_the_fleet_knows_is_revoked_by_its_name(self):
        copy, via = self.older_copy(), self.fleet.dir("ant")
        folder = self.put_back(copy)
        said = self.fleet.trb("fleet", "revoke", folder, "cat", "--reason", "stolen", "--via", via).stdout
        self.assertIn("cat: revoked up to serial ", said)
        for node in ("ant", "bee"):
            self.fleet.wait(f"{node} has no cat", lambda: "cat" not in self.routes(node), 60)

    def test_lists_that_do_not_hold(self):
        """Forged, foreign, older, of the same number: each refused and counted by name; the links stay."""
        dog = Member(self.fleet, "dog")
        key = self.authority()
        good = key.revocations(5, [(5, "elk")])
        newer = key.revocations(6, [(5, "elk")])
        forged = good[:3] + [bytes([good[3][0] ^ 1]) + good[3][1:]]
        foreign = key.sign("revocation_list", wire.pack([bytes(16), 6, time.time_ns(), [], 1, []]))
        cases = [
            ("bad_signature", forged, "was not signed by this fleet's authority"),
            ("foreign_fleet", foreign, "revocation list of another fleet"),
            (None, good, "revocations list 5"),
            ("downgraded", key.revocations(4, [(2, "bee")]), "revocation list 4; list 5 is in force"),
            ("conflict", key.revocations(5, [(2, "bee")]), "another revocation list with number 5"),
            (None, newer, "revocations list 6"),
            ("downgraded", good, "revocation list 5; list 6 is in force"),
            ("malformed", key.sign("revocation_list", b"noise"), "news_refused of dog: malformed"),
        ]
        expected = collections.Counter()
        for code, record, logged in cases:
            with self.subTest(logged):
                client = self.linked(dog)  # anew: it lasts no longer than a lease
                self.send(client, "fleet_news", "dog", data=authority.news(record))
                self.assert_alive(client, dog)
                self.watch.wait_logged(logged)
                if code:
                    expected[f"refused.{code}"] += 1
                    self.watch.wait_counted(f"refused.{code}", expected[f"refused.{code}"])
        self.linked(dog)
        self.assertEqual(self.online(), {"bee", "cat", "dog"})
        self.assertEqual(self.watch.rise(), expected)

    def test_oversized_news(self):
        dog = Member(self.fleet, "dog")
        client = self.linked(dog)
        self.send(client, "fleet_news", "dog", data=bytes(600_000))
        self.watch.wait_counted("refused.too_large")
        self.assert_alive(client, dog)

if __name__ == "__main__":
    support.main()
