"""Messages by way of a third member: only what the source itself has signed counts. The relay,
the source and the thief are this file's own client (wire.py, libzmq, libsodium), not the middleware's code.
"""
import itertools
import secrets
import time
import unittest

import authority
import support
import wire
from authority import SECOND, Authority, sign_with
from router_client import make_context
from sealer import Sealer, Signer

BLOCK = 120
UDP_PORT = 50120
TARGET = "cloud"  # also a relay, like every cloud


class Link(Sealer):
    """A member's link that lives for another lease with each word that it says."""

    def send(self, subtype, source, data=b""):
        ident = self.say(subtype, data)
        self.live()
        return ident


class Relays(unittest.TestCase):
    """cloud and arm are real routers; belt plays a relay, crane a member that cloud cannot reach."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)

    def setUp(self):
        services = {TARGET: ["router"], "arm": ["router"], "belt": ["router"], "crane": ["router"]}
        self.fleet = support.make_fleet(self, support.RouterFleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        self.fleet.bring_up(TARGET, "arm")
        self.fleet.wait("arm is linked", lambda: self.row("arm").get("state") == "ONLINE", 60)
        self.members = {name: Signer(self.fleet, name) for name in (TARGET, "arm", "belt", "crane")}
        self.counts = itertools.count(1)
        self.boots = {}
        self.watch = support.Watch(self.fleet, TARGET)

    def row(self, node, at=TARGET):
        rows = self.fleet.json("route", "list", node=at)["routes"]
        return next((row for row in rows if row["id"] == node), {})

    def boot(self, node):
        """Asked once: no router starts again here, and each question takes of the lease of those that are played."""
        if node not in self.boots:
            self.boots[node] = int(self.row(node, node)["boot"])
        return self.boots[node]

    def linked(self, name, relay=False):
        """A link of this member; `relay`: its Hello says that it relays, and its certificate allows it."""
        member = Signer(self.fleet, name)
        if relay:
            signer = Authority(self.fleet.authority_dir(), self.fleet.passphrase())
            member.serial = 1000
            member.certificate = signer.certificate(member.certificate, serial=member.serial, relay=True)
        client = Link(self.context, self.fleet, member, TARGET)
        self.addCleanup(client.close)
        hello = [member.certificate, 1, f"127.0.{BLOCK}.99:45000", "independent", time.time_ns(), True, [], 0, "behind", relay]
        client.say("hello", wire.pack(hello))
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def key(self, node, name):
        return bytes.fromhex((self.fleet.dir(node) / "keys" / f"{name}.key").read_text().strip())

    def link_key(self, node):
        """The public key."""
        return wire.unpack(self.members[node].certificate[2])[0][5]

    def relay_to_crane(self):
        """belt's link, by which cloud has learned of crane, and crane has proven that it is there."""
        belt = self.linked("belt", relay=True)
        belt.send("neighbours", "belt", data=wire.pack([[self.members["crane"].certificate], []]))
        self.crane_answers(belt, times=2)
        self.fleet.wait("crane is reached by belt", lambda: self.row("crane").get("via") == "belt", 60)
        return belt

    def crane_answers(self, belt, times=1):
        """The answer of crane's router to cloud's messages: it repeats their nonce."""
        for _ in range(times):
            _, word = self.answer(belt, TARGET, "relay_alive")
            self.crane_answers_one(belt, word)

    def crane_answers_one(self, belt, word):
        alive = [secrets.randbits(63) | 1, word.body()[0], 0, self.boot(TARGET), 0, 0, "", "independent", True]
        frame = wire.Frame("relay_alive", "crane", TARGET, id=next(self.counts) + 900, data=wire.pack(alive))
        self.hand(belt, self.signed("crane", boot=0, frame=frame.encode()))

    def live_on(self, belt):
        """Between what is refused, which takes a while: belt and crane are there for another lease."""
        for frame in belt.drain():
            told = self.told(frame, TARGET)
            if told and told[1].subtype == "relay_alive":
                self.crane_answers_one(belt, told[1])
        belt.live()

    def signed(self, signer, target=TARGET, source=None, count=None, boot=None, ends=5 * SECOND, to=None, frame=None,
               lock=None, own_boot=1):
        """What the signer's router would make of a request for the target's routing table."""
        asked = wire.Frame("route_list", source or signer, to or target, wire.REQUEST, id=next(self.counts) + 900,
                           data=wire.pack([]))
        sealed = authority.box(self.key(signer, "link"), self.link_key(lock or target),
                               asked.encode() if frame is None else frame)
        inner = [target, self.boot(target) if boot is None else boot, own_boot, count or next(self.counts),
                 time.time_ns() + ends, sealed]
        fleet, _ = wire.unpack(self.members[signer].certificate[2])
        return sign_with(self.key(signer, "identity"), "relayed", signer, fleet[0], wire.pack(inner))

    def hand(self, client, record, source="belt"):
        client.send("relayed", source, data=wire.pack([record]))

    def answer(self, client, signer, subtype="route_table"):
        """The frame that came back by the relay, signed by the signer and encrypted for crane or belt."""
        end = time.monotonic() + 10
        while time.monotonic() < end:
            told = self.told(client.receive(), signer)
            if told and told[1].subtype == subtype:
                return told
        raise TimeoutError(f"no {subtype} by the relay")

    def told(self, frame, signer):
        """What the signer has handed to the relay, and the frame in it. None: it is of somebody else, or nothing for a relay."""
        if frame.subtype != "relayed":
            return None
        record = frame.body()[0]
        if record[:2] != ["relayed", signer]:
            return None  # the other router sends to belt through cloud, too
        inner, _ = wire.unpack(record[2])
        return inner, wire.decode(authority.unbox(self.key(inner[0], "link"), self.link_key(signer), inner[5]))

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
            good = self.signed("crane", ends=60 * SECOND)  # replayed, it is still in its time
            self.hand(belt, good)
            inner, answered = self.answer(belt, TARGET)
            self.assertEqual(inner[:3], ["crane", 1, self.boot(TARGET)])
            self.assertEqual((answered.subtype, answered.source, answered.target), ("route_table", TARGET, "crane"))
        with self.subTest("replayed"):
            self.live_on(belt)
            self.hand(belt, good)
            self.assert_refused("replayed")
        with self.subTest("older than sixty-four that came"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", count=500))
            self.answer(belt, TARGET)
            self.hand(belt, self.signed("crane", count=436))
            self.assert_refused("replayed")
        with self.subTest("of a boot that has not shown that it is there"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", count=501, own_boot=2))
            self.assert_refused("replayed")

    def test_what_a_relay_may_not_hand_over_for_its_signature(self):
        belt = self.relay_to_crane()
        with self.subTest("tampered with: one byte of the payload, or of the signature"):
            self.live_on(belt)
            for part in (2, 3):
                changed = self.signed("crane")
                changed[part] = changed[part][:-1] + bytes([changed[part][-1] ^ 1])
                self.hand(belt, changed)
                self.assert_refused("bad_signature")
        with self.subTest("signed by the relay in the source's name"):
            self.live_on(belt)
            forged = self.signed("belt", source="crane")
            forged[1] = "crane"
            self.hand(belt, forged)
            self.assert_refused("bad_signature")

    def test_what_a_relay_may_not_hand_over_for_what_it_says(self):
        belt = self.relay_to_crane()
        with self.subTest("another source inside"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", source="arm"))
            self.assert_refused("source_mismatch")
        with self.subTest("another target inside"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", to="arm"))
            self.assert_refused("wrong_target")
        with self.subTest("for an earlier start of this router"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", boot=self.boot(TARGET) - 1))
            self.assert_refused("other_boot")
        with self.subTest("too late"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", ends=-SECOND))
            self.assert_refused("late")

    def test_what_a_relay_may_not_hand_over_for_whom_it_is(self):
        belt = self.relay_to_crane()
        with self.subTest("no frame"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", frame=b"nothing"))
            self.assert_refused("malformed")
        with self.subTest("locked for somebody else"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", lock="arm"))
            self.assert_refused("wrong_key")
        with self.subTest("of nobody"):
            self.live_on(belt)
            unknown = self.signed("crane")
            unknown[1] = "nobody"
            self.hand(belt, unknown)
            self.assert_refused("unknown_signer")
        with self.subTest("a second hop"):
            self.live_on(belt)
            self.hand(belt, self.signed("crane", target="arm"))
            self.assert_refused("second_hop")
        self.hand(belt, self.signed("crane"))
        self.answer(belt, TARGET)

    def test_by_a_real_relay_and_back(self):
        """belt reaches arm through cloud alone: cloud passes on, arm checks and answers the same way."""
        belt = self.linked("belt")
        told = belt.receive_until(lambda frame: frame.subtype == "neighbours").body()
        self.assertIn("arm", [wire.unpack(record[2])[0][2] for record in told[0]])

        def alive(echo, other):
            said = [secrets.randbits(63) | 1, echo, other, self.boot("arm"), 0, 0, "", "independent", True]
            frame = wire.Frame("relay_alive", "belt", "arm", id=next(self.counts) + 900, data=wire.pack(said))
            self.hand(belt, self.signed("belt", target="arm", boot=0, frame=frame.encode()))

        alive(0, 0)
        _, word = self.answer(belt, "arm", "relay_alive")
        alive(word.body()[0], 0)
        self.fleet.wait("arm knows belt by cloud", lambda: self.row("belt", "arm").get("via") == TARGET, 60)
        record = self.signed("belt", target="arm")
        for _ in range(2):  # the second is a replay: the relay need not detect it, arm does
            self.hand(belt, record)
        inner, answered = self.answer(belt, "arm")
        self.assertEqual((inner[0], answered.subtype, answered.source), ("belt", "route_table", "arm"))
        arm = support.Watch(self.fleet, "arm")
        self.fleet.wait("arm counts the replay", lambda: arm.counters().get("refused.relayed_replayed") == 1, 60)
        with self.subTest("the relay's own end: unknown target"):
            frame = wire.Frame("greeting", "belt", "crane", id=77, data=b"hello")
            self.hand(belt, self.signed("belt", target="crane", boot=1, count=77, frame=frame.encode()))
            refused = belt.receive_until(lambda one: one.subtype == "relay_refused").body()
            self.assertEqual(refused, ["crane", 77, "unknown_target"])

    def test_who_is_no_relay(self):
        """Without the right in its certificate a node is no relay, whatever its Hello says."""
        crane = self.linked("crane")
        crane.send("neighbours", "crane", data=wire.pack([[self.members["belt"].certificate], []]))
        self.watch.wait_counted("refused.not_permitted")
        self.watch.wait_logged("crane tells of neighbours and may not relay")
        self.assertEqual(self.row("belt"), {})
        self.hand(crane, self.signed("belt"), "crane")
        self.watch.wait_counted("refused.relayed_no_right")

    def test_a_relay_that_tells_of_who_is_no_member(self):
        belt = self.linked("belt", relay=True)
        kind, signer, payload, signature = self.members["crane"].certificate
        forged = [kind, signer, payload, bytes([signature[0] ^ 1]) + signature[1:]]
        belt.send("neighbours", "belt", data=wire.pack([[forged], []]))
        self.watch.wait_counted("refused.neighbour_bad_signature")
        self.assertEqual(self.row("crane"), {})

    def test_a_relay_that_says_a_dead_node_is_there(self):
        """For longer than a lease, with crane's old messages, replayed again and again."""
        belt = self.relay_to_crane()
        kept = self.signed("crane", boot=0, frame=wire.Frame(
            "relay_alive", "crane", TARGET, id=5000,
            data=wire.pack([7, 1, 0, self.boot(TARGET), 0, 0, "", "independent", True])).encode(), ends=60 * SECOND)

        def over():
            list(belt.drain())  # a link that confirms nothing lives for a lease, as long as this takes
            self.hand(belt, kept)
            belt.send("neighbours", "belt", data=wire.pack([[self.members["crane"].certificate], []]))
            return self.row("crane").get("state") == "OFFLINE"

        self.fleet.wait("crane is known to be gone", over, 40)

    def test_the_relay_says_that_it_lost_the_node(self):
        belt = self.relay_to_crane()
        belt.send("neighbours", "belt", data=wire.pack([[], ["crane"]]))
        self.fleet.wait("crane is lost", lambda: self.row("crane").get("state") == "CONNECTION_BROKEN", 60)


if __name__ == "__main__":
    support.main()
