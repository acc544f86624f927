"""Seals on real links: a wrong seal is refused, counted under a name of its own, distinguished in the
log, and ends the link; a member that comes back is welcome.
"""
import os
import signal
import time
import unittest

import zmq

import support
import wire
from sealer import MOST, STRICT, TARGET, WAIT, Case, Signer, blake


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
            client.live()
        self.assert_good(client)
        self.assertEqual(self.watch.rise(), {})

    # ---- missing, late

    def test_seals_that_are_missing(self):
        """The 64th message is accepted, the 65th is not."""
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
        """A beacon's signature over the same bytes is not a seal."""
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
        inner = self.ask_router(client)  # routers' own messages do not wait: after this one the first would be there
        self.assertEqual(client.answer_to(inner).subtype, "route_table")
        self.assertFalse([frame for frame in client.drain() if frame.reply_to == ident])
        client.seal()
        self.assertEqual(client.answer_to(ident).subtype, "run_table")
        self.assertEqual(self.strict.rise(), {})

    def test_a_copy_for_who_hears_waits_for_the_seal_too(self):
        self.heard()
        client = self.joined(target=STRICT)
        client.seal()
        client.say("task_progress", b"one")
        ident = self.ask_router(client)
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
        self.assertEqual(self.heard(), [], "it was heard before its seal was checked")
        client.seal()
        self.assertTrue(self.ear.poll(WAIT * 1000))
        self.assertEqual(self.heard(), [("task_progress", "cat")])
        self.assertEqual(self.strict.rise(), {})

    def heard(self):
        frames = []
        while self.ear.poll(0):
            frames.append(wire.decode(self.ear.recv()))
        return [(frame.subtype, frame.source) for frame in frames if frame.subtype == "task_progress"]

    def test_each_message_to_one_that_wants_it_is_sealed_by_itself(self):
        client = self.joined(target=STRICT)
        client.seal()
        for _ in range(5):
            ident = self.ask_router(client)
            client.seal()
            client.answer_to(ident)
            self.assertEqual(client.receive().subtype, "seal")

    def test_a_message_with_a_wrong_seal_is_never_delivered_and_its_sender_is_told(self):
        """By a Nack before the Goodbye, under a seal of the router's."""
        client = self.joined(target=STRICT)
        client.seal()
        ident = self.ask_scheduler(client)
        client.seal(key=self.dog.secret_key)
        heard = [client.receive()]
        while heard[-1].subtype != "goodbye":
            heard.append(client.receive())
        with self.assertRaises(TimeoutError):
            while True:
                heard.append(client.receive(0.5))
        self.assertEqual(heard[-1].body()[0], "seal_broken: wrong_signature")
        answers = [frame for frame in heard if frame.reply_to == ident]
        self.assertEqual([(frame.subtype, wire.nack(frame)["code"]) for frame in answers], [("nack", "seal_broken")])
        self.assertEqual(heard[heard.index(answers[0]) + 1].subtype, "seal")
        self.assertEqual(self.strict.rise(("dropped.seal",)), {"dropped.seal_broken": 1})
        self.strict.wait_logged("undelivered 1 messages of cat waited for their seal and are not delivered")
        self.strict.wait_counted("refused.seal_wrong_signature")
        self.assertEqual(self.strict.rise(), {"refused.seal_wrong_signature": 1})

    def test_two_that_want_different_things_agree_on_the_stricter(self):
        """ant seals after the delivery, but each message by itself to fox, which requires it."""
        before = support.Watch(self.fleet, STRICT)
        for _ in range(5):
            self.fleet.trb("request", STRICT, "route_list", node=TARGET, check=False)
        rise = before.rise(("seals.",))
        self.assertGreaterEqual(rise["seals.checked"], 5)
        self.assertEqual(before.rise(), {})


class FullBus(Case):
    def test_a_service_that_does_not_read(self):
        """A requester gets queue_full over its link, once it has its share of the queue. Another member, and the own
        node, still find room there; the rest of the node goes on."""
        pid = int(self.fleet.services(TARGET)["scheduler"]["pid"])
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(os.kill, pid, signal.SIGCONT)
        client, other = self.joined(), self.joined(self.dog)
        client.seal()
        other.seal()
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
        waits = self.ask_scheduler(other)
        inner = self.ask_router(other)
        other.seal()
        self.assertEqual(other.receive_until(lambda frame: frame.reply_to in (waits, inner)).subtype, "route_table")
        done = self.fleet.trb("request", TARGET, "run_list", node=TARGET, check=False)
        self.assertNotIn("queue_full", done.stdout + done.stderr)
        dropped = self.dropped()
        os.kill(pid, signal.SIGCONT)
        answers, end = [], time.monotonic() + 30
        while "run_table" not in answers:
            self.assertLess(time.monotonic(), end, "the scheduler reads again, and nothing reaches it")
            answers.append(self.answer(client))
        # A Nack for each refused request; the other dropped messages are answers.
        if "none" in answers:
            self.assertGreater(self.dropped() - dropped, answers.count("nack"), "neither answered nor counted")
        self.assertEqual(self.watch.rise(), {})

    def answer(self, client):
        """The next answer of the scheduler, with all that is in its queue, or of the router for it. All its answers
        together may be more than the link to this client holds: the last of them are dropped and counted, and the
        request is repeated."""
        ident = self.ask_scheduler(client)
        client.seal()
        try:
            return client.receive_alive(lambda frame: frame.reply_to == ident, 3).subtype
        except TimeoutError:
            return "none"

    def dropped(self):
        return self.watch.rise(("dropped.queue_full",)).get("dropped.queue_full", 0)


if __name__ == "__main__":
    support.main()
