"""Messages by way of a third member: what it carries counts only as far as the source's own signature goes. The relay,
the source and the thief are this file's own client (wire.py, libzmq, libsodium), not the middleware's code.
"""
import itertools
import time
import unittest

import zmq

import support
import wire
from authority import SECOND, sign_with
from strangers_test import Client, Member

BLOCK = 120
UDP_PORT = 50120
TARGET = "cloud"  # which is a relay too, as every cloud is


class Relays(unittest.TestCase):
    """cloud and arm are real routers; belt plays a relay, crane a member that cloud cannot reach."""

    @classmethod
    def setUpClass(cls):
        cls.context = zmq.Context()
        cls.addClassCleanup(cls.context.term)

    def setUp(self):
        services = {TARGET: ["router"], "arm": ["router"], "belt": ["router"], "crane": ["router"]}
        self.fleet = support.make_fleet(self, support.RouterFleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        self.fleet.bring_up(TARGET, "arm")
        self.fleet.wait("arm is linked", lambda: self.row("arm").get("state") == "ONLINE", 10)
        self.members = {name: Member(self.fleet, name) for name in (TARGET, "belt", "crane")}
        self.counts = itertools.count(1)
        self.watch = support.Watch(self.fleet, TARGET)

    def row(self, node, at=TARGET):
        rows = self.fleet.json("route", "list", node=at)["routes"]
        return next((row for row in rows if row["id"] == node), {})

    def boot(self, node):
        return int(self.row(node, node)["boot"])

    def linked(self, name, relay=False):
        member = self.members[name]
        client = Client(self.context, self.fleet.address(TARGET), self.members[TARGET].public,
                        (member.public, member.secret))
        self.addCleanup(client.close)
        hello = [member.certificate, 1, f"127.0.{BLOCK}.99:45000", "independent", time.time_ns(), True, [], 0, "behind", relay]
        client.send("hello", name, data=wire.pack(hello))
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def relay_to_crane(self):
        """belt's link, with cloud told that crane is reached by it."""
        belt = self.linked("belt", relay=True)
        reached = [[self.members["crane"].certificate, 1, "", "independent", True, []]]
        belt.send("neighbours", "belt", data=wire.pack([reached, []]))
        self.fleet.wait("crane is reached by belt", lambda: self.row("crane").get("via") == "belt", 5)
        return belt

    def signed(self, signer, target=TARGET, source=None, count=None, boot=None, ends=5 * SECOND, to=None, frame=None):
        """What the signer's router would make of a request for the target's routing table."""
        asked = wire.Frame("route_list", source or signer, to or target, wire.REQUEST, id=next(self.counts) + 900,
                           data=wire.pack([]))
        inner = [target, boot or self.boot(target), 1, count or next(self.counts), time.time_ns() + ends,
                 asked.encode() if frame is None else frame]
        fleet, _ = wire.unpack(self.members[signer].certificate[2])
        secret = bytes.fromhex((self.fleet.dir(signer) / "keys" / "identity.key").read_text().strip())
        return sign_with(secret, "relayed", signer, fleet[0], wire.pack(inner))

    def hand(self, client, record, source="belt"):
        client.send("relayed", source, data=wire.pack([record]))

    def answer(self, client, signer):
        """The frame that came back by the relay, of which the signature is the signer's."""
        frame = client.receive_until(lambda one: one.subtype == "relayed")
        record = frame.body()[0]
        self.assertEqual(record[:2], ["relayed", signer])
        inner, _ = wire.unpack(record[2])
        return inner, wire.decode(inner[5])

    def assert_refused(self, reason, count=1):
        """Under this name and under no other."""
        name = f"refused.relayed_{reason}"
        self.watch.wait_counted(name, count)
        self.assertEqual(self.watch.rise(), {name: count})
        self.watch.wait_logged("relayed_refused by belt")
        self.watch = support.Watch(self.fleet, TARGET)

    def test_what_a_relay_hands_over(self):
        belt = self.relay_to_crane()
        with self.subTest("good: delivered, and its answer goes back by the relay"):
            good = self.signed("crane")
            self.hand(belt, good)
            inner, answered = self.answer(belt, TARGET)
            self.assertEqual(inner[:3], ["crane", 1, self.boot(TARGET)])
            self.assertEqual((answered.subtype, answered.source, answered.target), ("route_table", TARGET, "crane"))
        with self.subTest("replayed"):
            self.hand(belt, good)
            self.assert_refused("replayed")
        with self.subTest("older than one that came"):
            self.hand(belt, self.signed("crane", count=50))
            self.answer(belt, TARGET)
            self.hand(belt, self.signed("crane", count=49))
            self.assert_refused("replayed")

    # Two tests: a link on which nobody tells what it has heard ends after a lease, and each refusal takes a while.

    def test_what_a_relay_may_not_hand_over(self):
        belt = self.relay_to_crane()
        with self.subTest("tampered with: one byte of the payload, or of the signature"):
            for part in (2, 3):
                changed = self.signed("crane")
                changed[part] = changed[part][:-1] + bytes([changed[part][-1] ^ 1])
                self.hand(belt, changed)
                self.assert_refused("bad_signature")
        with self.subTest("signed by the relay in the source's name"):
            forged = self.signed("belt", source="crane")
            forged[1] = "crane"
            self.hand(belt, forged)
            self.assert_refused("bad_signature")
        with self.subTest("another source inside"):
            self.hand(belt, self.signed("crane", source="arm"))
            self.assert_refused("source_mismatch")
        with self.subTest("another target inside"):
            self.hand(belt, self.signed("crane", to="arm"))
            self.assert_refused("wrong_target")
        with self.subTest("for an earlier start of this router"):
            self.hand(belt, self.signed("crane", boot=self.boot(TARGET) - 1))
            self.assert_refused("other_boot")
        with self.subTest("too late"):
            self.hand(belt, self.signed("crane", ends=-SECOND))
            self.assert_refused("late")
        with self.subTest("no frame"):
            self.hand(belt, self.signed("crane", frame=b"nothing"))
            self.assert_refused("malformed")
        with self.subTest("of nobody"):
            unknown = self.signed("crane")
            unknown[1] = "nobody"
            self.hand(belt, unknown)
            self.assert_refused("unknown_signer")
        with self.subTest("a second hop"):
            self.hand(belt, self.signed("crane", target="arm"))
            self.assert_refused("second_hop")
        self.hand(belt, self.signed("crane"))
        self.answer(belt, TARGET)

    def test_by_a_real_relay_and_back(self):
        """belt reaches arm through cloud alone: cloud passes on, arm checks and answers the same way."""
        belt = self.linked("belt")
        told = belt.receive_until(lambda frame: frame.subtype == "neighbours").body()
        self.assertIn("arm", [wire.unpack(row[0][2])[0][2] for row in told[0]])
        self.fleet.wait("arm knows belt by cloud", lambda: self.row("belt", "arm").get("via") == TARGET, 5)
        record = self.signed("belt", target="arm")
        for _ in range(2):  # the second is a replay: the relay need not know, arm does
            self.hand(belt, record)
        inner, answered = self.answer(belt, "arm")
        self.assertEqual((inner[0], answered.subtype, answered.source), ("belt", "route_table", "arm"))
        arm = support.Watch(self.fleet, "arm")
        self.fleet.wait("arm counts the replay", lambda: arm.counters().get("refused.relayed_replayed") == 1, 5)
        self.assertEqual(arm.counters()["relayed.received"], 1)
        with self.subTest("the relay's own end: unknown target"):
            frame = wire.Frame("greeting", "belt", "crane", id=77, data=b"hello")
            self.hand(belt, self.signed("belt", target="crane", boot=1, frame=frame.encode()))
            nack = belt.receive_until(lambda one: one.subtype == "nack")
            self.assertEqual((nack.reply_to, wire.nack(nack)["code"]), (77, "unknown_target"))

    def test_who_is_no_relay(self):
        crane = self.linked("crane")
        crane.send("neighbours", "crane", data=wire.pack([[], []]))
        self.watch.wait_counted("refused.not_permitted")
        self.watch.wait_logged("crane tells of neighbours and is no relay")

    def test_a_relay_that_tells_of_who_is_no_member(self):
        belt = self.linked("belt", relay=True)
        kind, signer, payload, signature = self.members["crane"].certificate
        forged = [kind, signer, payload, bytes([signature[0] ^ 1]) + signature[1:]]
        belt.send("neighbours", "belt", data=wire.pack([[[forged, 1, "", "independent", True, []]], []]))
        self.watch.wait_counted("refused.neighbour_bad_signature")
        self.assertEqual(self.row("crane"), {})

    def test_the_relay_says_that_it_lost_the_node(self):
        belt = self.relay_to_crane()
        belt.send("neighbours", "belt", data=wire.pack([[], [["crane", 9000]]]))
        self.fleet.wait("crane is lost", lambda: self.row("crane").get("state") == "CONNECTION_BROKEN", 5)
        self.fleet.wait("its lease ends", lambda: self.row("crane").get("state") == "OFFLINE", 5)


if __name__ == "__main__":
    unittest.main()
