"""A member's keys are stolen: what a thief may send as fast as possible; and what a member may try that is allowed to
relay. The other nodes keep their links, answer each other within their time, and their memory and descriptors stay bounded.
"""
import secrets
import time

import authority
import support
import wire
import zmq
from attack_fleet import FRIEND, TARGET, Attacker, Case
from attacks_member_test import ESCAPES, FOR_EVER, NOTHING, profile
from sealer import Signer

# How a handshake ends.
ENDS = (zmq.EVENT_HANDSHAKE_SUCCEEDED, zmq.EVENT_HANDSHAKE_FAILED_AUTH, zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL,
        zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL, zmq.EVENT_DISCONNECTED, zmq.EVENT_CLOSED)


class Floods(Case):
    """What it sends as fast, or as often, as it can."""

    BLOCK, UDP_PORT = 182, 50182

    def test_small_words_without_end(self):
        cat = self.attacker("cat")
        with self.attempt():
            for _ in range(20_000):
                cat.put("greeting", b"x")
            cat.live()

    def test_echoes_of_64_kilobytes(self):
        """It does not read the answers: they are bounded; no answer is longer than its request."""
        dog = self.attacker("dog")
        with self.attempt():
            try:
                for _ in range(600):
                    dog.put("echo_request", wire.pack([bytes(60_000)]), type=wire.REQUEST)
                dog.live()
            except zmq.ZMQError:
                pass

    def test_tables_without_end(self):
        """A request of a hundred bytes, an answer of thousands: 4 MiB in a second, the rest is refused by name."""
        elk = self.attacker("elk")
        for name in ("fox", "gnu", "hen"):  # so that the tables are not empty
            self.attacker(name, profile=profile()).put("node_profile", wire.pack(profile("x" * 60, 255)))
        with self.attempt("refused.queue_full"):
            codes = []
            for _ in range(1500):
                for subtype in ("route_list", "service_list", "router_counters", "link_troubles"):
                    elk.put(subtype, NOTHING, type=wire.REQUEST)
                while elk.socket.poll(0):
                    frame = elk.receive(0)
                    if frame.subtype == "nack":
                        codes.append(wire.nack(frame)["code"])
            codes += elk.nacks(least=0 if codes else 1)
        self.assertEqual(set(codes), {"queue_full"})

    def test_its_link_is_cut_and_made_again_without_a_pause(self):
        # Each with a fresh socket, as fast as possible.
        with self.attempt("refused.too_many_hellos"):
            for _ in range(100):
                one = Attacker(self, "lark")
                try:
                    one.join()
                    one.wait_event(*ENDS, timeout=2)  # what it says goes out then, however slow the machine is
                except (TimeoutError, zmq.ZMQError):
                    pass
                time.sleep(0.01)
                one.close()

    def test_news_of_256_copies_twenty_times_a_second(self):
        gnu = self.attacker("gnu")
        copies = [gnu.member.certificate] * 256
        with self.attempt("refused.too_much_news"):
            for _ in range(40):
                gnu.put("fleet_news", authority.news(certificates=copies))
                time.sleep(0.02)
            gnu.live()

    def test_old_and_forged_lists_twenty_times_a_second(self):
        key = authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())
        hen = self.attacker("hen")
        good = key.revocations(7)
        hen.put("fleet_news", authority.news(good))
        hen.seal()
        old = key.revocations(3)
        forged = [*good[:3], secrets.token_bytes(64)]
        with self.attempt("refused.downgraded"):
            for number in range(40):
                hen.put("fleet_news", authority.news(forged if number % 2 else old))
                time.sleep(0.02)
            hen.live()

    def test_rights_asked_for_by_every_word_of_a_node_s_own_bus(self):
        words = ("execute", "outcome", "adapter_state", "bridge_command", "execution_state", "node_sensors", "sign_request",
                 "signed_record", "service_hello", "service_welcome", "peer_expired", "run_submit", "alert_decide",
                 "cancel_execution", "hello_wanted", "journal_run", "certificate", "decision", "relay_alive", "beacon")
        ibis = self.attacker("ibis")
        with self.attempt("refused.not_permitted"):
            for _ in range(50):
                for word in words:
                    ibis.put(word, NOTHING, type=wire.COMMAND)
            ibis.seal()

    def test_a_listener_of_the_lane_that_wants_everything(self):
        """Another's topic, every topic, one of 2 kB; messages that are not subscriptions: lane_test.py."""
        jay = self.attacker("jay")
        lane = f"tcp://{self.fleet.address(TARGET)}:45001"
        with self.attempt("refused.lane_topic"):
            for topic in (FRIEND.encode() + b"\0", b"", bytes(2_000), b"jay", TARGET.encode() + b"\0") * 5:
                ear = self.context.socket(zmq.SUB)
                self.addCleanup(ear.close, 0)
                ear.setsockopt(zmq.RECONNECT_IVL, -1)
                ear.curve_serverkey = jay.peer.public
                ear.curve_publickey, ear.curve_secretkey = jay.member.public, jay.member.secret
                ear.setsockopt(zmq.SUBSCRIBE, topic)
                ear.connect(lane)
                self.assertFalse(ear.poll(50), "it heard what is another's")
            jay.live()


class Relays(Case):
    """A member that may relay: it can only lose and delay what it carries."""

    BLOCK, UDP_PORT = 184, 50184

    def test_it_tells_of_a_thousand_members(self):
        cat = self.relay("cat")
        kind, signer, payload, _ = Signer(self.fleet, "dog").certificate
        with self.attempt("refused.neighbour_bad_signature"):
            for _ in range(32):
                made_up = [[kind, signer, payload.replace(b"dog", secrets.token_hex(2)[:3].encode()), secrets.token_bytes(64)]
                           for _ in range(64)]
                cat.put("neighbours", wire.pack([made_up, []]))
            cat.live()
        self.assertLessEqual(len(self.fleet.json("route", "list", node=TARGET)["routes"]), 10)

    def test_it_says_that_all_are_gone(self):
        dog = self.relay("dog")
        with self.attempt():
            for _ in range(50):
                dog.put("neighbours", wire.pack([[], [FRIEND, TARGET, "cat", "dog", *(f"n{i}" for i in range(1000))]]))
            dog.live()
        self.assertEqual(self.row(FRIEND)["state"], "ONLINE")

    def test_it_reaches_the_honest_node_that_is_linked(self):
        """Linked nodes stay linked: a relay never replaces a link."""
        elk = self.relay("elk")
        with self.attempt():
            for _ in range(20):
                elk.put("neighbours", wire.pack([[Signer(self.fleet, FRIEND).certificate], []]))
                elk.put("neighbours", wire.pack([[], [FRIEND]]))
            elk.live()
            time.sleep(1)
        self.assertEqual(self.row(FRIEND)["via"], "")

    def test_it_floods_with_what_nobody_signed(self):
        fox = self.relay("fox")
        with self.attempt("refused.relayed_bad_signature"):
            for _ in range(3000):
                inner = wire.pack([TARGET, 1, 1, 1, time.time_ns() + 10**9, secrets.token_bytes(200)])
                fox.put("relayed", wire.pack([["relayed", FRIEND, inner, secrets.token_bytes(64)]]))
            fox.live()

    def test_it_answers_for_one_that_is_off(self):
        """With messages that it signs itself."""
        gnu = self.relay("gnu")
        with self.attempt():
            gnu.put("neighbours", wire.pack([[Signer(self.fleet, "hen").certificate], []]))
            for _ in range(100):
                inner = wire.pack([TARGET, 0, 1, 1, time.time_ns() + 10**9, secrets.token_bytes(200)])
                record = gnu.member.sign("relayed", inner)
                record[1] = "hen"
                gnu.put("relayed", wire.pack([record]))
            gnu.live()
            time.sleep(0.5)
        self.assertNotEqual(self.row("hen")["state"], "ONLINE")

    def test_it_says_that_another_s_messages_were_lost(self):
        ibis = self.relay("ibis")
        with self.attempt():
            for count in range(2000):
                ibis.put("relay_refused", wire.pack([FRIEND, count, ESCAPES]))
                ibis.put("relay_refused", wire.pack(["nobody", FOR_EVER - count, "queue_full"]))
            ibis.live()

    def test_it_asks_to_pass_a_megabyte_on_and_on(self):
        """To a node linked with the target; the target's budget for its links holds."""
        jay = self.relay("jay")
        with self.attempt():
            try:
                for _ in range(100):
                    inner = wire.pack([FRIEND, 1, 1, 1, time.time_ns() + 10**9, bytes(500_000)])
                    jay.put("relayed", wire.pack([jay.member.sign("relayed", inner)]))
                jay.live()
            except zmq.ZMQError:
                pass


if __name__ == "__main__":
    support.main()
