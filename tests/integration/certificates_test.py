"""Certificates on real nodes: refused when not valid, renewed while the fleet is up. No process restarts in between.
Addresses 127.0.112.x."""
import json
import os
import shutil
import socket
import subprocess
import time
import unittest

import zmq

import authority
import support
import wire
from certified import NODES, TARGET, WAIT, Life
from router_client import Member


class Dates(Life):
    block = 112

    def of_another_fleet(self, member):
        """Signed with the same authority's key, so that only its fleet is wrong."""
        body, _ = wire.unpack(self.authority().certificate(member.certificate)[2])
        body[0] = bytes(16)
        return self.authority().sign("certificate", wire.pack(body), fleet=body[0])

    def test_certificates_that_do_not_hold(self):
        """Expired, not yet valid, of another fleet: refused and counted by name."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        day = authority.DAY
        cases = [
            ("cert_expired", key.certificate(dog.certificate, begins=-2 * day, ends=-1), "certificate of 'dog' ended"),
            ("cert_not_yet_valid", key.certificate(dog.certificate, begins=day, ends=2 * day), "'dog' is valid from"),
            ("foreign_fleet", self.of_another_fleet(dog), "certificate of 'dog' is of another fleet"),
        ]
        for code, certificate, logged in cases:
            with self.subTest(code):
                # One stranger's key each: one that was refused stays out for a while.
                public, secret = zmq.curve_keypair()
                raw = zmq.utils.z85.decode(public)
                body, _ = wire.unpack(certificate[2])
                body[5] = raw
                client = self.client(keys=(public, secret))
                self.hello(client, dog, key.sign("certificate", wire.pack(body), fleet=body[0]))
                self.assertEqual(client.wait_goodbye(), code)
                self.watch.wait_counted(f"refused.{code}")
                self.watch.wait_logged(logged)

    def test_an_older_certificate(self):
        """Refused as downgraded, and given the newer one, so that a node that was away during its renewal can join."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        newer = key.certificate(dog.certificate, serial=90)
        client = self.client(dog)
        self.hello(client, dog, newer)
        self.assertEqual(client.receive().subtype, "hello")
        again = self.client(dog)
        self.hello(again, dog)
        answer = again.receive()
        self.assertEqual((answer.subtype, answer.body()[1]), ("fleet_news", [newer]))
        self.assertEqual(again.wait_goodbye(), "downgraded")
        self.assert_alive(client, dog)
        self.watch.wait_counted("refused.downgraded")
        self.watch.wait_logged("downgraded: an older certificate of 'dog': serial 4, 90 is known")
        self.assertEqual(self.watch.rise(), {"refused.downgraded": 1})

    def test_renewals_that_do_not_hold(self):
        """What a member passes on is accepted only for the authority's signature; the link that brought it stays."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        bee = Member(self.fleet, "bee").certificate
        good = key.certificate(bee, serial=70)
        body, _ = wire.unpack(key.certificate(Member(self.fleet, TARGET).certificate, serial=71)[2])
        body[4] = bytes(32)
        cases = [
            ("bad_signature", good[:3] + [bytes([good[3][0] ^ 1]) + good[3][1:]], "of 'bee' was not signed"),
            ("foreign_fleet", self.of_another_fleet(dog), "of 'dog' is of another fleet"),
            ("cert_expired", key.certificate(bee, serial=72, ends=-1), "of 'bee' ended"),
            ("cert_not_yet_valid", key.certificate(bee, serial=73, begins=authority.DAY), "of 'bee' is valid from"),
            ("downgraded", key.certificate(bee, serial=1), "an older certificate of 'bee': serial 1"),
            ("wrong_key", key.sign("certificate", wire.pack(body)), f"of '{TARGET}' for other keys than this node's"),
        ]
        for code, record, logged in cases:
            with self.subTest(code):
                client = self.linked(dog)  # anew: it lasts no longer than a lease
                self.send(client, "fleet_news", "dog", data=authority.news(certificates=[record]))
                self.assert_alive(client, dog)
                self.watch.wait_counted(f"refused.{code}")
                self.watch.wait_logged(logged)
        self.linked(dog)
        self.assertEqual(self.online(), {"bee", "cat", "dog"})
        self.assertEqual(self.watch.rise(), {f"refused.{code}": 1 for code, _, _ in cases})

    def test_a_weaker_mechanism(self):
        """PLAIN against CURVE, NULL in strangers_test: the router allows only CURVE."""
        plain = self.context.socket(zmq.DEALER)
        self.addCleanup(plain.close, 0)
        plain.plain_username, plain.plain_password = b"dog", b"dog"
        plain.connect(f"tcp://{self.fleet.address(TARGET)}:45000")
        self.fleet.wait("it is counted", lambda: self.watch.rise(), WAIT)
        self.assertLessEqual(set(self.watch.rise()), {"refused.no_curve", "refused.no_zmtp"})

    def test_an_older_protocol(self):
        """ZMTP 1.0 and 2.0 have no CURVE: the connection ends before its first message."""
        hello = wire.Frame("hello", "dog", TARGET, link=7, sequence=1).encode()
        greetings = {"1.0": b"\x01\x00", "2.0": b"\xff" + bytes(7) + b"\x01\x7f" + b"\x01" + b"\x05" + bytes(2)}
        for count, (version, greeting) in enumerate(greetings.items(), 1):
            with self.subTest(version):
                plain = socket.create_connection((self.fleet.address(TARGET), 45000), timeout=WAIT)
                self.addCleanup(plain.close)
                plain.sendall(greeting + b"\x00" + bytes([min(len(hello), 255)]) + hello)
                try:
                    while plain.recv(1000):
                        pass
                except ConnectionResetError:
                    pass
                self.fleet.wait("it is counted", lambda: self.watch.rise(("ended.",)) == {"ended.no_link": count}, WAIT)
        self.assertEqual(self.watch.rise(), {})

    def test_another_version_of_the_wire(self):
        dog = Member(self.fleet, "dog")
        for count, version in enumerate((1, 3), 1):
            client = self.linked(dog)
            frame = wire.Frame("route_list", "dog", TARGET, type=wire.REQUEST, id=9, link=client.link, sequence=2)
            client.socket.send(bytes([version]) + frame.encode()[1:])
            self.assertIn("version_mismatch", client.wait_goodbye())
            self.watch.wait_counted("refused.version_mismatch", count)
            self.watch.wait_logged(f"frame_refused version_mismatch: wire version {version}")
        self.assertEqual(self.watch.rise(), {"refused.version_mismatch": 2})

    def test_a_certificate_that_ends_while_connected(self):
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.client(dog)
        self.hello(client, dog, key.certificate(dog.certificate, serial=90, ends=8 * authority.SECOND))
        self.assertEqual(client.receive().subtype, "hello")
        self.assertIn("certificate has ended", client.wait_goodbye())
        self.watch.wait_logged("link_closed dog: its certificate has ended")
        self.watch.wait_counted("refused.cert_expired")
        self.assertEqual(set(self.watch.rise()), {"refused.cert_expired"})


class Renewed(Life):
    block = 112

    def until(self, node):
        return self.fleet.json("fleet", "show", self.fleet.dir(node))["not_after"]

    def test_a_renewal_spreads_and_no_link_is_lost(self):
        links = {node: {n: row["link"] for n, row in self.routes(node).items()} for node in NODES}
        before = {node: self.until(node) for node in NODES}
        said = self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), "--all", "--days", "700", "--via",
                              self.fleet.dir("cat")).stdout
        self.assertIn("5 renewed certificates, told to 2 nodes", said, "dog and elk are members, too")
        for node in NODES:
            self.watches[node].wait_logged("certificate_renewed serial")
            self.fleet.wait(f"{node} has it on disk",
                            lambda: int(self.until(node)) > int(before[node]) + 300 * authority.DAY, 60)
            for other in set(NODES) - {node}:
                certificate = bytes.fromhex(self.routes(node)[other]["certificate"]["payload"])
                self.assertGreaterEqual(wire.unpack(certificate)[0][1], 6, "the serial that others know")
        self.assertEqual({node: {n: row["link"] for n, row in self.routes(node).items()} for node in NODES}, links)
        self.assert_same_processes()
        self.assertEqual(self.watch.rise(), {})

    def test_who_is_to_be_renewed_must_be_said(self):
        for words, error in (((), "whose certificate is to be renewed?"), (("cat", "--all"), "--all: nodes are named, too")):
            refused = self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), *words, check=False)
            self.assertNotEqual(refused.returncode, 0)
            self.assertIn(error, refused.stderr)

    def test_a_node_that_was_off_while_it_was_renewed(self):
        """It comes with its old certificate, is refused, gets the new one, and joins with it."""
        self.fleet.nodes["cat"].stop()
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), "cat", "--via", self.fleet.dir("ant"))
        self.fleet.bring_up("cat")
        self.fleet.wait("cat is back", lambda: self.online("cat") == {"ant", "bee"}, 60)
        self.assertIn("certificate_renewed serial 6", self.watches["cat"].log())

    def test_a_renewal_that_begins_later_than_now(self):
        """The authority's clock was ahead: told by name to whoever hands it on, and by the router of one that was brought."""
        folder, day = self.fleet.authority_dir(), authority.DAY
        later = self.authority().certificate(Member(self.fleet, "bee").certificate, serial=70, begins=day, ends=2 * day)
        rows = [dict(zip(("kind", "signer", "payload", "signature"), record))
                for record in (["", "", "", ""], [*later[:2], later[2].hex(), later[3].hex()])]
        (folder / "news.json").write_text(json.dumps({"revocations": rows[0], "certificates": rows[1:]}))
        told = self.fleet.trb("fleet", "tell", folder, "--via", self.fleet.dir("ant"), check=False)
        self.assertEqual(told.returncode, 1, told.stdout)
        for words in ("cert_not_yet_valid", "certificate of 'bee' is valid from ", "if the authority's is ahead, set it"):
            self.assertIn(words, told.stderr)
        brought = self.fleet.dir("bee") / "keys" / "news.json"
        shutil.copy(folder / "news.json", brought)
        note = lambda: self.fleet.services("bee")["router"]["note"]
        self.fleet.wait("bee tells of it", lambda: "not in force: keys/news.json: certificate of 'bee' is valid from " in note(), 60)
        self.watches["bee"].wait_logged("news_refused of keys/news.json: cert_not_yet_valid")
        brought.unlink()
        self.fleet.wait("bee has nothing to tell", lambda: note() == "", 60)
        self.assertEqual(self.online("bee"), {"ant", "cat"})
        # Of the clock that is right now, one that begins before it takes its place.
        self.fleet.trb("fleet", "renew", folder, "bee", "--trust-clock", "--via", self.fleet.dir("ant"))
        self.watches["bee"].wait_logged("certificate_renewed serial 71")
        self.assert_same_processes()

    def renew(self, node, days):
        self.fleet.trb("fleet", "renew", self.fleet.authority_dir(), node, "--days", days, "--via", self.fleet.dir(node))

    def ends_soon(self, node):
        """What trb doctor shows of it."""
        report = json.loads(self.fleet.trb("doctor", "--json", node=node, check=False).stdout)
        return [row for row in report["findings"] if row["cause"] == "cert_ends_soon"]

    def test_a_certificate_that_ends_soon(self):
        """Warnings from 30 days before: in the log, in trb service list, in trb doctor; none once renewed."""
        self.renew(TARGET, 31)
        self.watch.wait_logged("certificate_renewed serial 6")
        self.assertEqual(self.ends_soon(TARGET), [])
        self.assertNotIn("certificate ends", self.fleet.trb("service", "list", node=TARGET).stdout)
        self.renew(TARGET, 29)
        self.watch.wait_logged("certificate_ends certificate ends")
        self.watch.wait_logged(f"in 28 days: trb fleet renew FLEET_DIR {TARGET}")
        self.assertIn(f"in 28 days: trb fleet renew FLEET_DIR {TARGET}",
                      self.fleet.trb("service", "list", node=TARGET).stdout)
        row, = self.ends_soon(TARGET)
        self.assertEqual((row["subject"], row["severity"]), (TARGET, "note"))
        self.assertIn("28 days", row["what"])
        self.assertIn(f"trb fleet renew FLEET_DIR {TARGET}", row["cure"])
        self.assertEqual(self.watch.log().count("certificate_ends"), 1)
        self.renew(TARGET, 365)
        self.watch.wait_logged("certificate_renewed serial 8")
        self.assertEqual(self.ends_soon(TARGET), [])
        self.assertNotIn("certificate ends", self.fleet.trb("service", "list", node=TARGET).stdout)
        self.assert_same_processes()


class PageCertificate(unittest.TestCase):
    """What `trb check` says of the certificate of a cloud node's page. No node runs."""

    def setUp(self):
        if not (support.PROGRAMS / "trb-cloud-gateway").exists():
            self.skipTest("built without the gateway")
        self.folder = support.temporary_folder(self)
        self.cloud = self.folder / "cloud"
        self.trb("fleet", "init", self.folder / "authority")
        self.trb("node", "new", self.cloud, "--cloud", "cloud", "--network", "127.0.112.9", "--page", "127.0.112.9:8443")
        self.trb("fleet", "sign", self.folder / "authority", self.cloud / "keys" / "request.json")

    def trb(self, *words, status=0):
        done = subprocess.run([support.PROGRAMS / "trb", *map(str, words)], capture_output=True, text=True, timeout=60,
                              stdin=subprocess.DEVNULL, env=dict(os.environ, TRB_PASSPHRASE="correct horse battery staple"))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout

    def pair(self, name, days):
        """As somebody else has made it, for so many days from now."""
        request, certificate, key = (self.folder / f"{name}.{kind}" for kind in ("csr", "crt", "key"))
        for words in (("req", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-subj", "/CN=hall",
                       "-keyout", key, "-out", request),
                      ("x509", "-req", "-in", request, "-signkey", key, "-days", str(days), "-out", certificate)):
            subprocess.run(["openssl", *words], check=True, capture_output=True)
        key.chmod(0o600)
        return certificate, key

    def put(self, certificate, key):
        for path, name in ((certificate, "gateway.crt"), (key, "gateway.key")):
            shutil.copy(path, self.cloud / "keys" / name)

    def faults(self):
        told = json.loads(self.trb("check", self.cloud, "--json", status=1))["faults"]
        return [(row["file"], row["what"], row["cure"]) for row in told]

    def test_what_the_check_says_of_the_page_s_certificate(self):
        good, ended = self.pair("good", 300), self.pair("ended", -1)
        self.put(*good)
        self.assertIn("no faults", self.trb("check", self.cloud))
        with self.subTest("another certificate's key"):
            self.put(good[0], ended[1])
            (file, what, cure), = self.faults()
            self.assertEqual((file, what), ("keys/gateway.key", "is not the key of keys/gateway.crt"))
            self.assertIn("put that certificate's own key there", cure)
        with self.subTest("ended"):
            self.put(*ended)
            (file, what, cure), = self.faults()
            self.assertEqual(file, "keys/gateway.crt")
            self.assertRegex(what, r"^ended 20.*: no browser takes it$")
            self.assertIn("put a new one there, and its key", cure)
        with self.subTest("others may read the key"):
            self.put(*good)
            (self.cloud / "keys" / "gateway.key").chmod(0o644)
            (file, what, cure), = self.faults()
            self.assertEqual((file, what), ("keys/gateway.key", "others may read this secret key"))
            self.assertIn(f"chmod 600 {self.cloud}/keys/gateway.key", cure)
        with self.subTest("no key"):
            (self.cloud / "keys" / "gateway.key").unlink()
            (file, what, _), = self.faults()
            self.assertEqual((file, what), ("keys/gateway.key", "no such file, but keys/gateway.crt is there"))


if __name__ == "__main__":
    support.main()
