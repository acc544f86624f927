"""One member's keys are stolen, and used: it answers in another's place, and sends a profile that fills a message.
The thief is this file's own client (sealer.py, wire.py and libzmq). Addresses 127.0.128.x and 127.0.129.x.
"""
import json
import os
import signal
import subprocess
import time
import unittest

import support
import trb_fleet
import wire
from router_client import make_context
from sealer import Sealer, Signer
from trb_fleet import CLOUD

BLOCK = 128
THIEF = "pioneer1"
ROBOTS = {name: trb_fleet.ROBOTS[name] for name in ("ur3", THIEF)}
MOST = 1_048_426  # bytes of the profile: the frame around it is just accepted


def large_profile():
    """Every field is within its own bound, the whole just within a message."""
    parameter = ["p", "text", False, "", [], ["x" * 250] * 64, 0]
    skills = [["s%03d" % i, "mobile", [parameter], False, 1.0] for i in range(64)]
    places = ["y" * 100] * 20

    def profile():
        return ["lines", "interpreter", "lines", "evil", "", [], [], skills, places, "ONLINE", "", False, "", []]

    rest = MOST - len(wire.pack(profile()))
    while rest:
        size = rest - 2 if 40 < rest <= 257 else 200  # a text of 32 to 255 bytes has a head of two
        places.append("z" * size)
        rest -= size + 2
    return wire.pack(profile())


class StolenKeys(unittest.TestCase):
    """The cloud and one robot are up; the other robot's keys are the thief's."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        cls.fleet = support.make_fleet(cls, block=BLOCK, udp_port=50128, robots=ROBOTS)
        cls.fleet.start_robot("ur3")
        for node in ("ur3", CLOUD):
            cls.fleet.start_node(node)
        cls.fleet.wait("ur3 is there", lambda: cls.robot_is("ur3") == "ONLINE", 60)
        cls.fleet.wait("resilience is there", lambda: cls.service("resilience")["state"] == "up", 60)
        cls.member = Signer(cls.fleet, THIEF)

    @classmethod
    def routes(cls):
        done = cls.fleet.trb("route", "list", "--json", node=CLOUD, check=False)
        return {row["id"]: row for row in json.loads(done.stdout)["routes"]} if done.returncode == 0 else {}

    @classmethod
    def robot_is(cls, robot):
        return cls.routes().get(robot, {"profile": {"robot": ""}})["profile"]["robot"]

    @classmethod
    def service(cls, name):
        done = cls.fleet.trb("service", "list", "--json", node=CLOUD, check=False)
        rows = json.loads(done.stdout)["services"] if done.returncode == 0 else []
        return next((row for row in rows if row["service"] == name), {"state": "unknown"})

    def setUp(self):
        self.thief = Sealer(self.context, self.fleet, self.member, CLOUD)
        self.addCleanup(self.thief.close)
        self.thief.say("hello", wire.hello(self.member.certificate, time.time_ns(), f"127.0.{BLOCK}.99:45000"))
        self.thief.seal()
        self.assertEqual(self.thief.receive().subtype, "hello")
        self.fleet.wait("the thief is a member", lambda: self.routes()[THIEF]["state"] == "ONLINE", 60)
        self.watch = support.Watch(self.fleet, CLOUD)

    def stay(self):
        """Its link lasts for 10 s more."""
        list(self.thief.drain())
        self.thief.live()

    def stop(self, *more):
        command = [support.PROGRAMS / "trb", "stop", "ur3", "--json", *more, "--node", self.fleet.dir(CLOUD)]
        return subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True)

    def state_of(self, child):
        robot, = json.loads(child.communicate(timeout=60)[0])["robots"]
        return robot["state"]

    def test_a_member_that_acknowledges_in_anothers_place_confirms_no_stop(self):
        """It even knows the id, which no node sends it: from the cloud's own tap."""
        tap = support.Tap(self.fleet, CLOUD)
        self.addCleanup(tap.child.stop)
        adapter = self.fleet.pid("ur3", "mode-adapter")
        os.kill(adapter, signal.SIGSTOP)
        self.addCleanup(os.kill, adapter, signal.SIGCONT)

        self.stay()
        child = self.stop("--timeout", 4)
        told = []

        def seen():
            tap.child.drain()
            told[:] = [json.loads(line) for line in tap.child.lines if '"subtype":"stop"' in line]
            return told

        self.fleet.wait("the stop is on its way", seen, 60)
        ident = int(told[0]["id"])
        for guess in (ident, ident, ident + 1, ident - 1, ident & ~0xffffffff0000, ident):
            for subtype, body in (("ack", ["stopped", ""]), ("nack", ["robot_error", "stop", "ur3", "no", ""])):
                self.thief.say(subtype, wire.pack(body), reply_to=guess)
        self.thief.seal()
        self.stay()
        self.assertEqual(self.state_of(child), "sent")
        self.stay()
        self.assertNotEqual(child.returncode, 0)
        self.watch.wait_counted("refused.not_asked", 8)
        self.watch.wait_logged(f"not_asked {THIEF} sent ack as an answer to what 'cli' of {CLOUD} did not ask of it")
        self.assertEqual(self.routes()[THIEF]["state"], "ONLINE")

        os.kill(adapter, signal.SIGCONT)
        self.assertEqual(self.state_of(self.stop("--timeout", 30)), "confirmed")
        self.assertLessEqual(set(self.watch.rise()), {"refused.not_asked"})

    def test_a_profile_that_fills_a_message_is_refused_and_harms_nobody(self):
        before = self.routes()
        resilience = self.fleet.pid(CLOUD, "resilience")
        profile = large_profile()
        self.assertEqual(len(profile), MOST)
        self.thief.say("node_profile", profile)
        self.thief.seal()
        self.watch.wait_counted("refused.profile_too_large")
        self.watch.wait_logged(f"profile_too_large {THIEF}: it told a profile of {MOST} bytes")
        # Long enough for a relay's lists, and for several keep-alives.
        end = time.monotonic() + 4
        while time.monotonic() < end:
            self.thief.live()
            for _ in self.thief.drain():
                pass
            rows = self.routes()
            self.assertEqual(rows["ur3"]["link"], before["ur3"]["link"])
            self.assertEqual(rows[THIEF]["link"], before[THIEF]["link"])
            self.assertEqual(rows[THIEF]["profile"], before[THIEF]["profile"])
        self.assertEqual(self.fleet.pid(CLOUD, "resilience"), resilience)
        self.assertEqual(self.service("resilience")["state"], "up")
        self.assertEqual(self.fleet.json("alert", "list", node=CLOUD)["alerts"], [])
        report = self.fleet.trb("doctor", THIEF, node=CLOUD, check=False).stdout
        self.assertIn("profile_too_large", report)


if __name__ == "__main__":
    support.main()
