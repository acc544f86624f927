"""A member's keys are stolen: what a thief may try, each attempt under its name. In each case the other nodes
keep their links, answer each other within their time, and their memory and descriptors stay bounded.
"""
import contextlib
import secrets
import time

import authority
import support
import trb_fleet
import wire
import zmq
from attack_fleet import FRIEND, TARGET, Attacker, Case, Service
from sealer import Signer

FOR_EVER = 2**64 - 1
ESCAPES = "\x1b]0;owned\x07\x1b[2J\x9b31m\x7f\r\nforged\tby"
NOTHING = wire.pack([])


def cut(text, size):
    return text.encode()[:size].decode(errors="ignore")


def profile(text="", words=0, detail=""):
    """The profile of a node whose robot has these words."""
    many = [cut(f"{number}{text}", 64) for number in range(words)]
    return ["lines", cut(text, 16), cut(text, 16), cut(text, 64), cut(text, 64), many[:64], many, [], many, "ONLINE",
            cut(detail, 255), False, cut(text, 64)]


class Words(Case):
    """What it sends, once or now and then."""

    def test_a_robot_claims_the_words_of_the_cloud(self):
        key = authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())
        robot = key.certificate(Signer(self.fleet, "kite").certificate, serial=900, role=0)
        cat = self.attacker("kite", certificate=robot)
        with self.attempt("refused.not_permitted"):
            for subtype in ("run_decision", "release_tasks"):
                cat.put(subtype, NOTHING, type=wire.COMMAND)
            cat.seal()
            self.assertEqual(cat.nacks(least=2), ["not_permitted"] * 2)

    def test_a_thief_of_a_cloud_s_keys_speaks_as_a_robot(self):
        dog = self.attacker("dog")
        with self.attempt("refused.not_permitted"):
            for subtype in ("robot_state", "robot_fault", "robot_connection"):
                dog.put(subtype, NOTHING)
            dog.seal()

    def test_a_stop_in_another_s_name(self):
        elk = self.attacker("elk")
        with self.attempt("refused.source_mismatch"):
            for _ in range(50):
                elk.sequence += 1
                frame = wire.Frame("stop", FRIEND, TARGET, type=wire.COMMAND, id=next(elk.ids), link=elk.link,
                                   sequence=elk.sequence, data=wire.pack(["it is me"])).encode()
                elk.socket.send(frame)
                elk.open.append(frame)
                elk.seal()

    def test_answers_and_nacks_for_another_s_questions(self):
        """For a connection whose slot it knows, and which sent its request to another node; and for all others."""
        fox = self.attacker("fox")
        asker = Service(self.context, f"ipc://{self.fleet.dir(TARGET)}/bus/probe.ipc")
        self.addCleanup(asker.close)
        with self.attempt("refused.not_asked"):
            asked = [asker.say(TARGET, FRIEND, "echo_request", wire.pack([b""]), wire.REQUEST) for _ in range(50)]
            for ident in asked + [slot << 48 | 1 for slot in range(100)]:
                fox.put("nack", wire.pack(["queue_full", "echo_request", TARGET, "", ""]), reply_to=ident)
                fox.put("echo", wire.pack([b"forged"]), reply_to=ident)
                fox.put("echo", wire.pack([b"forged"]), reply_to=asker.slot << 48 | secrets.randbits(48))
            fox.live()
        heard = [(frame.subtype, frame.source, frame.body()) for frame in asker.drain()]
        self.assertEqual(heard, [("echo", FRIEND, [b""])] * 50)

    def test_a_keep_alive_that_confirms_what_was_never_sent(self):
        gnu = self.attacker("gnu")
        with self.attempt():
            for heard in (0, FOR_EVER, FOR_EVER - 1, 1):
                gnu.say("keep_alive", wire.keep_alive(heard))
                gnu.seal()
            ident = gnu.put("route_list", NOTHING, type=wire.REQUEST)
            gnu.seal()
            self.assertEqual(gnu.answer_to(ident).subtype, "route_table")

    def test_sequences_at_their_ends(self):
        with self.attempt("refused.sequence"):
            for sequence in (0, FOR_EVER, 2**63):
                hen = self.attacker("hen")
                hen.send("greeting", "hen", sequence=sequence)
                self.assertIn("sequence", hen.wait_goodbye())

    def test_times_at_their_ends(self):
        ibis = self.attacker("ibis")
        with self.attempt("dropped.expired"):
            over = ibis.put("route_list", NOTHING, type=wire.REQUEST, remaining_ms=0)
            long = ibis.put("route_list", NOTHING, type=wire.REQUEST, remaining_ms=2**32 - 1)
            ibis.seal()
            self.assertEqual(wire.nack(ibis.answer_to(over))["code"], "expired")
            self.assertEqual(ibis.answer_to(long).subtype, "route_table")

    def test_flags_and_types_that_nobody_knows(self):
        with self.attempt("refused.bad_value"):
            for kind, flags in ((0, 0), (255, 0), (wire.REQUEST, 0xFFFF)):
                jay = self.attacker("jay")
                jay.put("route_list", NOTHING, type=kind, flags=flags)
                jay.seal()
                jay.nacks(0.2)
                jay.close()

    def test_names_of_64_kilobytes_and_with_escapes(self):
        cat = self.attacker("dog")
        with self.attempt():
            for target in ("x" * 65_000, ESCAPES, "../../etc/passwd", "*"):
                try:
                    cat.put(target, b"", type=wire.COMMAND)
                    cat.send("greeting", "dog", target=target, type=wire.COMMAND)
                    cat.nacks(0.1)
                except (zmq.ZMQError, wire.WireError):
                    pass  # its link has ended
        self.assert_nothing_commands_a_terminal()

    def test_a_thousand_words_that_nobody_knows(self):
        """They do not make the table of counters grow."""
        elk = self.attacker("elk")
        before = len(support.Watch(self.fleet, TARGET).counters())
        with self.attempt("dropped.no_service"):
            for number in range(1000):
                elk.put(f"word_{number}", b"x", type=wire.COMMAND)
            elk.seal()
            elk.nacks()
        self.assertLess(len(support.Watch(self.fleet, TARGET).counters()), before + 8)

    def test_what_is_none_behind_each_of_the_router_s_own_words(self):
        with self.attempt("refused.malformed"):
            for name, subtype in zip(("cat", "dog", "elk", "fox"), ("neighbours", "relayed", "fleet_news", "relay_refused")):
                one = self.attacker(name)
                for data in (b"", b"\xc1", b"\xdd\xff\xff\xff\xff", wire.pack([[], [], [], []]), b"\x91" * 5000):
                    one.put(subtype, data)
                one.seal()
                one.nacks(0.2)

    # ---- profiles

    def test_a_profile_over_its_bound(self):
        fox = self.attacker("fox")
        with self.attempt("refused.profile_too_large"):
            for size in (65_537, 1_000_000):
                fox.put("node_profile", wire.pack(profile()[:-1] + ["x"]) + bytes(size))
                fox.put("node_profile", wire.pack([*profile()[:7], [["s" * 64, "", [], False, 0.0]] * 900, *profile()[8:]]))
            fox.seal()
            fox.nacks()

    def test_a_profile_that_commands_terminals(self):
        """Every text at its bound and full of escapes: trb and the logs show them harmlessly."""
        gnu = self.attacker("gnu")
        with self.attempt():
            gnu.put("node_profile", wire.pack(profile(ESCAPES, 255, ESCAPES * 9)))
            gnu.seal()
            self.fleet.wait("it is told", lambda: "owned" in self.row("gnu").get("profile", {}).get("maker", ""), 60)
            self.assert_nothing_commands_a_terminal()
        self.assertEqual(self.row("gnu")["profile"]["maker"], ESCAPES)  # for a program the text is unchanged

    def assert_nothing_commands_a_terminal(self):
        """In what trb prints and the routers log there is no control character but the newline, and each line is ours."""
        said = [self.fleet.trb(*words, node=TARGET, check=False)
                for words in (("route", "list"), ("robot", "list"), ("doctor",), ("doctor", "gnu"), ("robot", "list", "--json"))]
        text = "".join(done.stdout + done.stderr for done in said)
        text += (self.fleet.dir(TARGET) / "log" / "router.log").read_text(errors="replace")
        self.assertEqual({c for c in text if (ord(c) < 32 and c != "\n") or 0x7F <= ord(c) < 0xA0}, set())
        self.assertEqual([line for line in text.splitlines() if line.startswith("forged")], [])

    def test_a_profile_a_hundred_times_a_second(self):
        hen = self.attacker("hen")
        with self.attempt():
            end, number = time.monotonic() + 1, 0
            while time.monotonic() < end:
                number += 1
                hen.put("node_profile", wire.pack(profile(f"{number} " + "x" * 50, 255)))
                time.sleep(0.01)
            hen.live()

    # ---- Hello

    def test_a_hello_of_the_last_boot(self):
        """While it is linked its owner is refused by name; once it is gone (silent: after a lease) not."""
        thief = self.attacker("jay", boot=FOR_EVER)
        with self.attempt("refused.conflict"):
            late = Attacker(self, "jay")
            self.addCleanup(late.close)
            late.join(boot=7)
            self.assertIn("conflict", late.wait_goodbye())
            thief.put("goodbye", wire.pack(["bye"]))
            thief.seal()
            self.fleet.wait("the owner comes in", lambda: self.comes_in("jay", 7), 60)

    def comes_in(self, name, boot):
        one = Attacker(self, name)
        try:
            one.join(boot=boot)
            return one.receive(1).subtype == "hello"
        except (TimeoutError, zmq.ZMQError):
            return False
        finally:
            one.close()

    def test_addresses_that_lead_nowhere_or_to_the_victim(self):
        """It is dialled with back-off when it is gone, and the victim does not dial itself."""
        own = f"{self.fleet.address(TARGET)}:45000"
        nowhere = ("", "255.255.255.255:1", f"{self.fleet.address(TARGET)}:0", own, "0.0.0.0:45000")
        with self.attempt() as seen:
            for name, address in zip(("cat", "dog", "elk", "fox", "gnu"), nowhere):
                one = Attacker(self, name)
                self.addCleanup(one.close)
                one.join(address=address, lane=address)
                word = one.receive_until(lambda frame: frame.subtype in ("hello", "goodbye"))
                print(address or "none", word.subtype, end="; ")
                one.close()
            seen.honest.wait_answers(100)
            self.assertLess(seen.watch.log().count("dial_ended"), 50)

    def test_an_address_that_is_a_name(self):
        with self.attempt("refused.bad_value"):
            for address in ("localhost:1", "robots.example:45000", ESCAPES, "127.0.0.1:99999"):
                one = Attacker(self, "hen")
                self.addCleanup(one.close)
                one.join(address=address)
                one.wait_goodbye()
                time.sleep(0.2)
        self.assert_nothing_commands_a_terminal()

    def test_clocks_at_the_ends_of_time(self):
        with self.attempt():
            for name, utc in (("ibis", 2**63 - 1), ("cat", -2**63), ("dog", 0)):
                self.attacker(name, utc=utc).live()
        self.assertEqual(self.fleet.json("route", "list", node=TARGET)["routes"][0]["clock"], "verified")

    def test_a_goodbye_of_a_megabyte(self):
        with self.attempt():
            one = self.attacker("elk")
            one.put("goodbye", wire.pack([ESCAPES * 40_000]))
            with contextlib.suppress(zmq.Again):  # it may have ended the link already
                one.seal()
            one.nacks(0.2)
        self.assert_nothing_commands_a_terminal()


if __name__ == "__main__":
    support.main()
