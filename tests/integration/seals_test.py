"""Seals on real links: what is not sealed as it should be is refused, counted under a name of its own, told apart in the
log, and ends the link; a member that comes back is welcome. And the log of proof, read by somebody who was not there. The
client here has its own seals (libsodium's Ed25519, hashlib's BLAKE2b, proto/README.md), not the middleware's.
"""
import ctypes
import hashlib
import json
import os
import secrets
import shutil
import signal
import time
import unittest

import zmq

import authority
import support
import wire
from strangers_test import Client, Member

BLOCK = 100
UDP_PORT = 50100
TARGET = "ant"
STRICT = "fox"  # wants messages sealed before they are delivered
MOST = 64
WAIT = 6


def blake(data):
    return hashlib.blake2b(data, digest_size=32).digest()


class Signer(Member):
    """A member with its identity key, which signs as its router would."""

    def __init__(self, fleet, node):
        super().__init__(fleet, node)
        self.secret_key = bytes.fromhex((fleet.dir(node) / "keys" / "identity.key").read_text().strip())
        body, _ = wire.unpack(self.certificate[2])
        self.fleet, self.serial, self.identity = body[0], body[1], body[4]

    def sign(self, purpose, payload, key=None):
        message = b"talkrobots\0" + purpose.encode() + b"\0" + self.fleet + payload
        signature = ctypes.create_string_buffer(64)
        authority.SODIUM.crypto_sign_detached(signature, None, message, ctypes.c_ulonglong(len(message)),
                                              key or self.secret_key)
        return [purpose, self.id, payload, signature.raw]

    def has_signed(self, record):
        purpose, signer, payload, signature = record
        message = b"talkrobots\0" + purpose.encode() + b"\0" + self.fleet + payload
        return signer == self.id and 0 == authority.SODIUM.crypto_sign_verify_detached(
            signature, message, ctypes.c_ulonglong(len(message)), self.identity)


class Sealer(Client):
    """A member's end of a link that it dialled: it seals when told to, and checks the seals that it gets."""

    FIELDS = ("link", "serial", "peer_serial", "dialled", "first", "last", "previous", "hash", "utc")

    def __init__(self, context, fleet, member, target=TARGET):
        self.peer = Signer(fleet, target)
        super().__init__(context, fleet.address(target), self.peer.public, (member.public, member.secret))
        self.member = member
        self.open = []  # frames that are not sealed yet
        self.previous = bytes(32)
        self.heard_open = []
        self.heard_previous = bytes(32)
        self.seals_heard = 0

    def close(self):
        if not self.socket.closed:
            super().close()

    # ---- out

    def say(self, subtype, data=b"", **more):
        ident = next(self.ids)
        self.sequence += 1
        frame = wire.Frame(subtype, self.member.id, self.peer.id, data=data, id=ident, link=self.link,
                           sequence=self.sequence, **more).encode()
        self.socket.send(frame)
        self.open.append(frame)
        return ident

    def join(self, seal=None):
        """Says Hello, as its router would, and hears the other side's."""
        body = [self.member.certificate, next(Client.boots), f"127.0.{BLOCK}.99:45000", "independent", time.time_ns(), True]
        if seal is not None:
            profile = ["", "", "", "", "", [], [], [], [], "", "", False, ""]
            body += [profile, 0, seal]
        self.say("hello", wire.pack(body))
        return self

    def range(self, **changes):
        """What an honest seal states of what is open, but for the changes."""
        hashed = self.previous + b"".join(len(frame).to_bytes(4, "big") + frame for frame in self.open)
        honest = dict(link=self.link, serial=self.member.serial, peer_serial=self.peer.serial, dialled=True,
                      first=self.sequence - len(self.open) + 1, last=self.sequence, previous=self.previous,
                      hash=blake(hashed), utc=time.time_ns())
        return wire.pack([{**honest, **changes}[name] for name in self.FIELDS])

    def put_seal(self, record):
        """Sends a seal, good or not, with the next sequence."""
        self.sequence += 1
        frame = wire.Frame("seal", self.member.id, self.peer.id, data=wire.pack([record]), id=next(self.ids),
                           link=self.link, sequence=self.sequence).encode()
        self.socket.send(frame)
        self.previous = blake(record[2])
        self.open = []

    def seal(self, key=None, **changes):
        record = self.member.sign("seal", self.range(**changes), key)
        self.put_seal(record)
        return record

    # ---- in

    def receive(self, timeout=WAIT):
        if not self.socket.poll(int(timeout * 1000)):
            raise TimeoutError(f"nothing received in {timeout} s")
        raw = self.socket.recv()
        frame = wire.decode(raw)
        self.heard = frame.sequence
        if frame.subtype == "seal":
            self.check(frame)
        elif frame.subtype != "goodbye":
            self.heard_open.append(raw)
        return frame

    def check(self, frame):
        """The router's seal, by this file's own reading of the grammar."""
        record = frame.body()[0]
        stated = dict(zip(self.FIELDS, wire.unpack(record[2])[0]))
        hashed = self.heard_previous + b"".join(len(raw).to_bytes(4, "big") + raw for raw in self.heard_open)
        wanted = dict(link=self.link, serial=self.peer.serial, peer_serial=self.member.serial, dialled=False,
                      first=frame.sequence - len(self.heard_open), last=frame.sequence - 1, previous=self.heard_previous,
                      hash=blake(hashed))
        assert {name: stated[name] for name in wanted} == wanted, (stated, wanted)
        assert 0 < len(self.heard_open) <= MOST
        assert self.peer.has_signed(record), "the router's seal is not signed with its identity key"
        self.heard_previous, self.heard_open = blake(record[2]), []
        self.seals_heard += 1

    def drain(self):
        while self.socket.poll(0):
            yield self.receive(0)


class Case(unittest.TestCase):
    """A target with a scheduler, a good node, one that wants seals before delivery; cat and dog are played."""

    @classmethod
    def setUpClass(cls):
        cls.context = zmq.Context()
        cls.addClassCleanup(cls.context.term)
        services = {TARGET: ["router", "scheduler"], "bee": ["router"], STRICT: ["router", "scheduler"], "cat": ["router"],
                    "dog": ["router"], "elk": ["router"], "gnu": ["router"]}
        cls.fleet = support.make_fleet(cls, Sealing, services=services, block=BLOCK, udp_port=UDP_PORT)
        cls.fleet.bring_up(TARGET, "bee", STRICT)
        cls.cat, cls.dog = Signer(cls.fleet, "cat"), Signer(cls.fleet, "dog")

    def setUp(self):
        self.fleet.wait("the fleet is linked", lambda: {"bee", STRICT} <= self.online(), 15)
        self.links = {name: self.routes()[name]["link"] for name in ("bee", STRICT)}
        self.pid = self.fleet.pid(TARGET, "router")
        self.watch = support.Watch(self.fleet, TARGET)

    def tearDown(self):
        """Whatever a member did: nobody else's link was lost, and the router is the same process."""
        self.assertEqual({name: self.routes()[name]["link"] for name in self.links}, self.links)
        self.assertEqual(self.fleet.pid(TARGET, "router"), self.pid)

    def routes(self, node=TARGET):
        return {row["id"]: row for row in self.fleet.json("route", "list", node=node)["routes"]}

    def online(self, node=TARGET):
        return {name for name, row in self.routes(node).items() if row["state"] == "ONLINE"}

    def dial(self, member=None, target=TARGET):
        client = Sealer(self.context, self.fleet, member or self.cat, target)
        self.addCleanup(client.close)
        return client

    def joined(self, member=None, target=TARGET, seal=None):
        client = self.dial(member, target).join(seal)
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def ask_router(self, client):
        return client.say("route_list", wire.pack([]), type=wire.REQUEST)

    def ask_scheduler(self, client):
        return client.say("run_list", wire.pack([]), type=wire.REQUEST)

    def assert_good(self, client):
        """It is heard, its seal is taken, and it hears a seal over the answer."""
        ident = self.ask_router(client)
        client.seal()
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        before = client.seals_heard
        client.receive_until(lambda frame: frame.subtype == "seal")
        self.assertEqual(client.seals_heard, before + 1)

    def assert_alarm(self, client, reason, watch=None):
        """Refused under its own name and no other, told so to the peer and in the log; and it may come back."""
        watch = watch or self.watch
        self.assertEqual(client.wait_goodbye(), f"seal_broken: {reason}")
        watch.wait_counted(f"refused.seal_{reason}")
        watch.wait_logged(f"seal_alarm_{reason} link {client.link} of {client.member.id}, after sequence ")
        self.assertEqual(watch.rise(), {f"refused.seal_{reason}": 1})
        self.assertEqual(watch.log().count("seal_alarm_"), 1)
        self.assert_good(self.joined(client.member, client.peer.id))


class Sealing(support.RouterFleet):
    def node_json(self, node):
        more = {"seal": "before_delivery"} if node == STRICT else {}
        return {**super().node_json(node), **more}


class Seals(Case):
    def test_a_member_that_seals_is_heard_and_hears_seals(self):
        client = self.joined()
        self.assert_good(client)
        for _ in range(3):
            for _ in range(MOST - 1):
                client.say("greeting", b"hello")
            self.ask_router(client)
            client.seal()
        client.receive_until(lambda frame: frame.subtype == "route_table")
        self.fleet.wait("they are counted", lambda: self.watch.rise(("seals.",)).get("seals.messages", 0) >= 3 * MOST, WAIT)
        self.assertEqual(self.watch.rise(), {})

    def test_an_idle_link_of_sealed_keep_alives_stays(self):
        client = self.joined()
        client.seal()
        for _ in range(4):
            client.say("keep_alive", wire.keep_alive(client.heard))
            client.seal()
        self.assert_good(client)
        self.assertEqual(self.watch.rise(), {})

    # ---- missing, late

    def test_seals_that_are_missing(self):
        """The 64th message is taken, the 65th is not."""
        client = self.joined()
        for _ in range(MOST - 2):
            client.say("greeting", b"hello")
        ident = self.ask_router(client)
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        self.assertEqual(self.watch.rise(), {})
        client.say("greeting", b"hello")
        self.assert_alarm(client, "missing")

    def test_a_seal_that_is_late(self):
        """What came before a keep-alive is still not sealed at the next one."""
        client = self.joined()
        client.seal()
        client.say("greeting", b"hello")
        client.say("keep_alive", wire.keep_alive(client.heard))
        ident = self.ask_router(client)
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        self.assertEqual(self.watch.rise(), {})
        client.say("keep_alive", wire.keep_alive(client.heard))
        self.assert_alarm(client, "late")

    # ---- wrong

    def test_a_seal_that_is_none(self):
        client = self.joined()
        client.put_seal(["seal", "cat", b"\xc1", bytes(64)])
        self.assert_alarm(client, "malformed")

    def test_a_seal_over_other_messages(self):
        client = self.joined()
        client.say("greeting", b"I owe you ten")
        client.open[-1] = client.open[-1].replace(b"ten", b"one")
        client.seal()
        self.assert_alarm(client, "wrong_hash")

    def test_a_seal_of_another_key(self):
        client = self.joined()
        client.seal(key=self.dog.secret_key)
        self.assert_alarm(client, "wrong_signature")

    def test_a_seal_with_one_bit_of_its_signature_changed(self):
        client = self.joined()
        kind, signer, payload, signature = self.cat.sign("seal", client.range())
        client.put_seal([kind, signer, payload, bytes([signature[0] ^ 1]) + signature[1:]])
        self.assert_alarm(client, "wrong_signature")

    def test_a_signature_that_was_made_for_something_else(self):
        """A beacon's signature over the same bytes is no seal."""
        client = self.joined()
        kind, signer, payload, signature = self.cat.sign("beacon", client.range())
        client.put_seal(["seal", signer, payload, signature])
        self.assert_alarm(client, "wrong_signature")

    # ---- out of order, swapped

    def test_seals_out_of_order(self):
        """The second range's seal before the first's."""
        client = self.joined()
        client.seal()
        client.say("greeting", b"one")
        first = client.range()
        client.previous, client.open = blake(first), []
        client.say("greeting", b"two")
        client.seal()
        self.assert_alarm(client, "wrong_range")

    def test_a_seal_that_comes_twice(self):
        client = self.joined()
        record = client.seal()
        client.say("greeting", b"one")
        client.put_seal(record)
        self.assert_alarm(client, "wrong_range")

    def test_a_seal_over_nothing(self):
        client = self.joined()
        client.seal()
        client.seal()
        self.assert_alarm(client, "wrong_range")

    def test_a_seal_that_leaves_a_message_out(self):
        client = self.joined()
        client.say("greeting", b"one")
        client.seal(first=2)
        self.assert_alarm(client, "wrong_range")

    def test_a_chain_that_begins_anew(self):
        """Its range fits, but not behind the seal before."""
        client = self.joined()
        client.seal()
        client.say("greeting", b"one")
        client.previous = bytes(32)
        client.seal()
        self.assert_alarm(client, "wrong_range")

    def test_seals_swapped_between_links(self):
        cat, dog = self.joined(self.cat), self.joined(self.dog)
        of_cat = self.cat.sign("seal", cat.range())
        of_dog = self.dog.sign("seal", dog.range())
        with self.subTest("of another member's link"):
            cat.put_seal(of_dog)
            self.assert_alarm(cat, "wrong_link")
        with self.subTest("and the other way round"):
            self.watch = support.Watch(self.fleet, TARGET)
            dog.put_seal(of_cat)
            self.assert_alarm(dog, "wrong_link")

    def test_a_seal_of_the_member_s_own_earlier_link(self):
        record = self.joined().seal()
        client = self.joined()
        client.put_seal(record)
        self.assert_alarm(client, "wrong_link")

    def test_the_router_s_own_seal_thrown_back(self):
        client = self.joined()
        client.seal()
        seal = client.receive_until(lambda frame: frame.subtype == "seal").body()[0]
        client.say("greeting", b"one")
        client.put_seal(seal)
        self.assert_alarm(client, "wrong_link")

    # ---- downgraded

    def test_a_member_whose_hello_does_not_want_to_be_sealed(self):
        for count, (node, word) in enumerate((("elk", "none"), ("gnu", "")), 1):
            with self.subTest(word):
                client = self.dial(Signer(self.fleet, node)).join(seal=word)
                self.assertEqual(client.wait_goodbye(), "downgraded")
                self.watch.wait_counted("refused.downgraded", count)
                self.watch.wait_logged(f"downgraded: Hello of '{node}' wants messages sealed '{word}'")
                self.assertEqual(self.watch.rise(), {"refused.downgraded": count})
                self.assertNotIn(node, self.online())
        self.assertNotIn("seal_alarm", self.watch.log())
        self.assert_good(self.joined(seal="behind"))

    def test_a_seal_from_a_service_of_the_node(self):
        """Only a router's own seals leave it."""
        with self.context.socket(zmq.DEALER) as bus:
            bus.setsockopt(zmq.LINGER, 0)
            bus.connect(f"ipc://{self.fleet.dir(TARGET)}/bus/probe.ipc")
            hello = wire.pack(["cli", [], 1, os.getpid(), "independent"])
            bus.send(wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1, data=hello).encode())
            slot = wire.decode(bus.recv()).body()[2]
            record = self.cat.sign("seal", b"")
            bus.send(wire.Frame("seal", TARGET, "bee", type=wire.COMMAND, id=(slot << 48) + 1,
                                data=wire.pack([record])).encode())
            self.assertTrue(bus.poll(WAIT * 1000))
            self.assertEqual(wire.nack(wire.decode(bus.recv()))["code"], "not_permitted")
        self.assertEqual(self.watch.rise(("refused.seal",)), {})


class BeforeDelivery(Case):
    def setUp(self):
        super().setUp()
        self.strict = support.Watch(self.fleet, STRICT)

    def test_a_message_waits_for_its_seal(self):
        client = self.joined(target=STRICT)
        client.seal()
        ident = self.ask_scheduler(client)
        inner = self.ask_router(client)  # what routers say to each other does not wait: behind it, the first would be there
        self.assertEqual(client.answer_to(inner).subtype, "route_table")
        self.assertFalse([frame for frame in client.drain() if frame.reply_to == ident])
        client.seal()
        self.assertEqual(client.answer_to(ident).subtype, "run_table")
        self.assertEqual(self.strict.rise(), {})

    def test_each_message_to_one_that_wants_it_is_sealed_by_itself(self):
        client = self.joined(target=STRICT)
        client.seal()
        for _ in range(5):
            ident = self.ask_router(client)
            client.seal()
            client.answer_to(ident)
            self.assertEqual(client.receive().subtype, "seal")

    def test_a_message_with_a_wrong_seal_is_never_delivered(self):
        client = self.joined(target=STRICT)
        client.seal()
        ident = self.ask_scheduler(client)
        client.seal(key=self.dog.secret_key)
        heard = []
        with self.assertRaises(TimeoutError):
            while True:
                heard.append(client.receive(1.5))
                if heard[-1].subtype == "goodbye":
                    break
            while True:
                heard.append(client.receive(0.5))
        self.assertEqual(heard[-1].body()[0], "seal_broken: wrong_signature")
        self.assertFalse([frame for frame in heard if frame.reply_to == ident])
        self.strict.wait_counted("refused.seal_wrong_signature")
        self.assertEqual(self.strict.rise(), {"refused.seal_wrong_signature": 1})

    def test_two_that_want_different_things_agree_on_the_stricter(self):
        """ant seals behind the delivery, and each message by itself to fox, which asked for it."""
        before = support.Watch(self.fleet, STRICT)
        for _ in range(5):
            self.fleet.trb("request", STRICT, "route_list", node=TARGET, check=False)
        rise = before.rise(("seals.",))
        self.assertGreaterEqual(rise["seals.checked"], 5)
        self.assertEqual(before.rise(), {})


class Log(Case):
    """What the target kept of cat's words, shown to a third party: a folder with the log, and fleet.json."""

    def kept(self):
        """cat says 10 messages and seals them, says 3 more, and is gone without a word."""
        client = self.joined()
        for number in range(9):
            client.say("greeting", f"promise {number}".encode())
        client.seal()
        for number in range(2):
            client.say("greeting", f"last word {number}".encode())
        client.answer_to(self.ask_router(client))
        link = client.link
        client.close()
        self.watch.wait_logged("open_end 3 messages of cat from sequence 12 on are authenticated, not provable", 15)
        folder = self.fleet.root / f"third-{secrets.token_hex(4)}"
        folder.mkdir()
        source = self.fleet.dir(TARGET) / "log" / "proof"
        end = time.monotonic() + WAIT
        while True:  # it is on the disk a tenth of a second later
            shutil.copytree(source, folder / "proof", dirs_exist_ok=True)
            self.fleet_json = folder / "fleet.json"
            shutil.copy(self.fleet.authority_dir() / "fleet.json", self.fleet_json)
            rows = [row for row in self.proof(folder / "proof")[1]["messages"] if row["link"] == str(link)]
            if len(rows) == 13:
                return folder / "proof", rows
            self.assertLess(time.monotonic(), end, f"{len(rows)} rows of link {link}")

    def proof(self, *words, fleet=None):
        done = self.fleet.trb("proof", *words, "--fleet", fleet or self.fleet_json, "--json", check=False)
        return done.returncode, json.loads(done.stdout)

    def test_what_is_proven_by_whom_and_which_tail_is_not(self):
        folder, rows = self.kept()
        status, report = self.proof(folder)
        self.assertEqual((status, report["faults"]), (0, []))
        self.assertEqual([row["state"] for row in rows], ["proven"] * 10 + ["authenticated"] * 3)
        self.assertEqual({row["by"] for row in rows}, {"cat"})
        self.assertEqual(bytes.fromhex(rows[1]["data_hex"]), b"promise 0")
        tails = [row for row in report["tails"] if row["link"] == rows[0]["link"]]
        self.assertEqual([(row["by"], row["first"], row["messages"]) for row in tails], [("cat", 12, 3)])
        nodes = {row["by"]: row for row in report["nodes"]}
        self.assertGreater(nodes["bee"]["proven"], 0)
        self.assertEqual(nodes["cat"]["broken"], 0)
        text = self.fleet.trb("proof", folder, "--fleet", self.fleet_json).stdout
        self.assertIn(f"Authenticated only: 3 messages of cat, link {rows[0]['link']} from sequence 12 on", text)

    def test_it_is_for_its_owner_alone(self):
        folder = self.fleet.dir(TARGET) / "log" / "proof"
        self.assertEqual(folder.stat().st_mode & 0o777, 0o700)
        self.fleet.wait("there is a log", lambda: list(folder.iterdir()), WAIT)
        self.assertEqual({path.stat().st_mode & 0o777 for path in folder.iterdir()}, {0o600})

    def test_one_byte_changed(self):
        """It names file, record and byte; the messages of that range are broken, those of the others are not."""
        folder, rows = self.kept()
        path = next(path for path in sorted(folder.iterdir()) if b"promise 4" in path.read_bytes())
        good = path.read_bytes()
        at = good.rindex(b"promise 4")
        path.write_bytes(good[:at] + b"P" + good[at + 1:])
        status, report = self.proof(folder)
        self.assertEqual(status, 1)
        changed = [row for row in report["messages"] if row["link"] == rows[0]["link"]]
        self.assertEqual([row["state"] for row in changed], ["broken"] * 10 + ["authenticated"] * 3)
        damaged, seal = report["faults"]
        self.assertEqual((damaged["file"], damaged["record"]), (str(path), rows[5]["record"]))
        self.assertTrue(damaged["offset"] < at < damaged["offset"] + 200)
        self.assertIn("its bytes are not those that were written", damaged["what"])
        self.assertIn("the seal of cat over records", seal["what"])
        self.assertIn("wrong_hash", seal["what"])
        text = self.fleet.trb("proof", folder, "--fleet", self.fleet_json, check=False).stdout
        self.assertIn(f"FAULT {path}, record {damaged['record']} at byte {damaged['offset']}: damaged", text)

    def test_a_file_that_was_cut_off_a_wrong_file_and_another_fleet_s_key(self):
        folder, _ = self.kept()
        path = sorted(folder.iterdir())[-1]
        with self.subTest("cut off"):
            cut = folder.parent / "cut.log"
            cut.write_bytes(path.read_bytes()[:-5])
            status, report = self.proof(cut)
            self.assertEqual((status, len(report["faults"])), (1, 1))
            self.assertIn("cut off: ", report["faults"][0]["what"])
            self.assertGreater(report["faults"][0]["offset"], 0)
        with self.subTest("no log"):
            wrong = folder.parent / "wrong.log"
            wrong.write_text("{}")
            status, report = self.proof(wrong)
            self.assertEqual(status, 1)
            self.assertIn("no proof log", report["faults"][0]["what"])
        with self.subTest("not there"):
            done = self.fleet.trb("proof", folder / "absent.log", "--fleet", self.fleet_json, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("absent.log", done.stderr)
        with self.subTest("no key"):
            done = self.fleet.trb("proof", folder, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn("--fleet", done.stderr)
        with self.subTest("another fleet"):
            key = json.loads(self.fleet_json.read_text())
            key["authority_key"] = secrets.token_hex(32)
            other = folder.parent / "other" / "fleet.json"
            other.parent.mkdir()
            other.write_text(json.dumps(key))
            status, report = self.proof(folder, fleet=other)
            self.assertEqual((status, {row["state"] for row in report["messages"]}), (1, set()))
            self.assertTrue(report["faults"])


class FullBus(Case):
    def test_a_service_that_does_not_read(self):
        """Whoever asks it is told that the queue is full, over a link and on the bus; the rest of the node goes on."""
        pid = int(self.fleet.services(TARGET)["scheduler"]["pid"])
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(os.kill, pid, signal.SIGCONT)
        client = self.joined()
        client.seal()
        codes, end = [], time.monotonic() + 30
        while "queue_full" not in codes and time.monotonic() < end:
            for _ in range(MOST - 1):
                client.say("run_list", wire.pack([]), type=wire.REQUEST)
            inner = self.ask_router(client)
            client.seal()
            while (frame := client.receive()).reply_to != inner:
                if frame.subtype == "nack":
                    codes.append(wire.nack(frame)["code"])
        self.assertEqual(set(codes), {"queue_full"})
        done = self.fleet.trb("request", TARGET, "run_list", node=TARGET, check=False)
        self.assertIn("queue_full", done.stdout + done.stderr)
        os.kill(pid, signal.SIGCONT)
        end = time.monotonic() + 30
        while self.answer(client) != "run_table":
            self.assertLess(time.monotonic(), end, "the scheduler reads again, and nothing reaches it")
        self.assertEqual(self.watch.rise(), {})

    def answer(self, client):
        """What the scheduler, with all that is in its queue, answers next, or the router for it."""
        ident = self.ask_scheduler(client)
        client.seal()
        return client.receive_until(lambda frame: frame.reply_to == ident, 30).subtype


if __name__ == "__main__":
    unittest.main(verbosity=2)
