"""Driving by hand through the gateway: who may, who has the robot, and what ends it.

Addresses 127.0.226.x, 127.0.227.x.
"""
import threading
import time

import support
import trb_fleet
from gateway_case import CLOUD, GOOD, ROBOT, WAIT_S, GatewayCase

PERIOD_S = 0.1
PART = "base"
MOST_BEGUN = 3
SIGNED_OUT = 4401  # the code with which a stream ends


class Hand:
    """A page that drives: a live socket, and a thread that repeats the speeds that are held."""

    def __init__(self, case, client):
        self.live = client.live()
        case.addCleanup(self.die)
        case.assertEqual(self.live.status, 101)
        self.case, self.held, self.sequence, self.is_dead = case, None, 0, threading.Event()
        self.lock = threading.Lock()
        threading.Thread(target=self.repeat, daemon=True).start()

    def repeat(self):
        while not self.is_dead.wait(PERIOD_S):
            if self.held is not None:
                self.say(self.held)

    def say(self, speeds, robot=ROBOT, **more):
        with self.lock:
            self.sequence += 1
            try:
                self.live.say({"drive": robot, "part": PART, "speeds": speeds, "sequence": self.sequence, **more})
            except OSError:
                self.is_dead.set()

    def hear(self, found=lambda heard: True):
        return self.live.until(lambda heard: "drive" in heard and found(heard["drive"]))["drive"]

    def begin(self, speeds=(0,), **more):
        """The gateway's first answer to it. A stalled machine ends a drive, as it must: it is begun anew, at most three times."""
        for _ in range(MOST_BEGUN):
            self.held, self.sequence, self.began = None, 0, time.time_ns()
            self.say(list(speeds), **more)
            answer = self.hear(lambda heard: heard["sequence"] == 1)
            if answer.get("error", {}).get("status") != 504:
                break
        self.held = list(speeds) if answer["state"] == "driving" else None
        return answer

    def hold(self, speeds):
        self.held = list(speeds)

    def let_go(self):
        self.held = None
        with self.lock:
            self.live.say({"let_go": ROBOT})

    def die(self):
        self.is_dead.set()
        self.live.close()


@support.told_again
def unless_silent(case):
    """A stalled machine ends a drive for silence."""
    before = case.admin.ask("GET", "/api/v1/audit/head").json["number"]
    return lambda: any((one["action"], one["outcome"]) == ("drive end", "silence") and one["number"] > before
                       for one in case.admin.ask("GET", "/api/v1/audit?limit=50").json["records"])


class Drive(GatewayCase):
    block, udp_port = 226, 50226
    kinds = trb_fleet.DEMO_ROBOTS
    speed = 1

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        answer = cls.admin.ask("POST", "/api/v1/users", {"name": "otto", "role": "operator", "password": GOOD})
        assert answer.status == 201, answer.bytes
        cls.other = cls.client()
        assert cls.other.sign_in("otto", GOOD).status == 201
        cls.fleet.wait("the robot can be driven", lambda: cls.drives() != [], WAIT_S)
        cls.tap = support.Tap(cls.fleet, ROBOT)
        cls.addClassCleanup(cls.tap.child.stop)

    # ---- helpers

    @classmethod
    def drives(cls):
        return cls.viewer.ask("GET", f"/api/v1/robots/{ROBOT}").json["content"]["drives"]

    def hand(self, client=None):
        return Hand(self, client or self.operator)

    def velocities(self):
        """What the robot's node was sent; its Nacks name the word too."""
        return [body for body in self.tap.bodies("velocity") if "speeds" in body]

    def wait_velocity(self, what, found):
        self.fleet.wait(what, lambda: any(found(body) for body in self.velocities()), WAIT_S)

    def wait_over(self, hand, by="olga"):
        """The robot's node is told that this person lets go. A drive's number is the time at which it began."""
        self.wait_velocity(f"over by {by}", lambda body: body["over"] and body["by"] == by and int(body["drive"]) >= hand.began)

    def records(self, count=3):
        return [(one["who"], one["action"], one["about"], one["outcome"])
                for one in self.admin.ask("GET", f"/api/v1/audit?limit={count}").json["records"]]

    def wait_record(self, record):
        self.fleet.wait(f"{record} in the audit log", lambda: record in self.records(6), WAIT_S)

    def teleop(self, live, found):
        """The row of the robot's driver, once it is so; None: it is removed."""
        def rows(frame):
            return [row for block in frame.get("blocks", []) for row in block["rows"] if row["kind"] == "teleop"]
        frame = live.until(lambda heard: any(found(row.get("content")) for row in rows(heard)))
        return [row.get("content") for row in rows(frame) if found(row.get("content"))][-1]

    def wait_free(self):
        self.fleet.wait("nobody commands the robot", lambda: self.viewer.ask(
            "GET", f"/api/v1/robots/{ROBOT}").json["content"]["control"] == "", WAIT_S)

    # ---- stories

    @unless_silent
    def test_an_operator_drives_and_lets_go(self):
        part = next(one for one in self.drives() if one["part"] == PART)
        self.assertEqual(part["axes"][0], "x")
        self.assertEqual(len(part["axes"]), len(part["limits"]))
        self.wait_free()
        watch = self.viewer.live()
        self.addCleanup(watch.close)
        watch.say({"subscribe": "teleop"})
        hand = self.hand()
        answer = hand.begin()
        self.assertEqual(answer["state"], "driving", answer)
        self.assertGreater(answer["round_trip_s"], 0)
        self.assertEqual(self.teleop(watch, lambda row: row and row["holder"])["holder"], "olga")
        hand.hold([0.1])
        self.wait_velocity("forward", lambda body: body["speeds"] == [0.1] and body["by"] == "olga")
        for _ in range(5):
            self.assertEqual(hand.hear()["state"], "driving")
        hand.let_go()
        self.assertNotIn("error", hand.hear(lambda heard: heard["state"] == "over"))
        self.wait_over(hand)
        self.teleop(watch, lambda row: row is None)
        self.wait_record(("olga", "drive end", f"{ROBOT} {PART}", "done"))
        self.assertEqual(self.records(2)[1], ("olga", "drive begin", f"{ROBOT} {PART}", "done"))

    def test_a_viewer_and_a_token_that_only_reads_are_refused(self):
        token = self.admin.ask("POST", "/api/v1/tokens", {"name": "reads", "role": "operator", "read_only": True}).json
        before = len(self.velocities())
        for client in (self.viewer, self.client(token["secret"])):
            live = client.live()
            self.addCleanup(live.close)
            for word in ({"drive": ROBOT, "part": PART, "speeds": [0.1], "sequence": 1}, {"ask_for": ROBOT}, {"let_go": ROBOT}):
                live.say(word)
                error = live.until(lambda heard: "error" in heard)["error"]
                self.assertEqual(error["status"], 403)
                self.assertTrue(error["errors"][0]["hint"])
        self.assertEqual(len(self.velocities()), before)

    def test_forged_words_are_refused_and_too_many_end_the_socket(self):
        good = {"drive": ROBOT, "part": PART, "speeds": [0], "sequence": 1}
        before = len(self.velocities())
        live = self.operator.live()
        self.addCleanup(live.close)
        wrong = ({"drive": "nobody"}, {"drive": 5}, {"drive": "../up"}, {"part": "wheel"}, {"part": 0}, {"speeds": "fast"},
                 {"speeds": ["1"]}, {"speeds": [0] * 17}, {"speeds": [None]}, {"sequence": 0}, {"sequence": -1},
                 {"sequence": 1.5}, {"sequence": 2 ** 63}, {"take": "yes"}, {"by": "admin"}, {"over": True})
        for change in wrong:
            with self.subTest(change):
                live.say({**good, **change})
                error = live.until(lambda heard: "error" in heard)["error"]
                self.assertIn(error["status"], (400, 404, 413, 422))
                self.assertTrue(error["errors"][0]["hint"], error)
        for name in ("part", "speeds", "sequence"):
            live.say({key: value for key, value in good.items() if key != name})
            self.assertIn(name, live.until(lambda heard: "error" in heard)["error"]["detail"])
        self.assertEqual(len(self.velocities()), before)
        for _ in range(5):
            live.say({"let_go": 7})
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 1008)

    def test_a_word_of_no_drive_starts_nothing(self):
        hand = self.hand()
        hand.sequence = 6
        before = len(self.velocities())
        hand.say([0.1])
        answer = hand.hear()
        self.assertEqual((answer["state"], answer["error"]["status"]), ("over", 409))
        self.assertEqual(len(self.velocities()), before)

    def test_a_flood_is_refused_and_ends_the_drive(self):
        self.wait_free()
        hand = self.hand()
        self.assertEqual(hand.begin()["state"], "driving")
        before = len(self.velocities())
        hand.held = None
        for _ in range(80):
            hand.say([0.1])
        self.assertEqual(hand.live.until(lambda heard: "closed" in heard, most=400)["closed"], 1008)
        self.wait_over(hand)
        self.assertLess(len(self.velocities()) - before, 40)

    @unless_silent
    def test_two_people_one_asks_and_the_other_hands_over(self):
        self.wait_free()
        ann, bob = self.hand(), self.hand(self.other)
        self.assertEqual(ann.begin()["state"], "driving")
        ann.live.say({"subscribe": "teleop"})
        refused = bob.begin()
        self.assertEqual((refused["state"], refused["error"]["detail"]), ("over", f"olga drives '{ROBOT}'"))
        bob.live.say({"ask_for": ROBOT})
        self.teleop(ann.live, lambda row: row and row["asked_by"] == "otto")
        ann.let_go()
        self.teleop(ann.live, lambda row: row and row["kept_for"] == "otto")
        self.assertEqual(bob.begin()["state"], "driving")
        self.wait_record(("otto", "drive begin", f"{ROBOT} {PART}", "done"))
        self.assertIn(("olga", "drive end", f"{ROBOT} {PART}", "done, kept for otto"), self.records(3))

    @unless_silent
    def test_two_people_one_takes_and_both_names_are_on_record(self):
        self.wait_free()
        ann, bob = self.hand(), self.hand(self.other)
        self.assertEqual(ann.begin()["state"], "driving")
        ann.hold([0.05])
        self.assertEqual(bob.begin(take=True)["state"], "driving")
        lost = ann.hear(lambda heard: heard["state"] == "over")
        self.assertEqual(lost["error"]["detail"], f"otto has taken '{ROBOT}'")
        self.wait_record(("otto", "drive take", f"{ROBOT} {PART} from olga", "done"))
        self.assertIn(("olga", "drive end", f"{ROBOT} {PART}", "taken by otto"), self.records(4))
        self.wait_over(ann)

    @unless_silent
    def test_a_socket_that_dies_lets_go(self):
        self.wait_free()
        hand = self.hand()
        self.assertEqual(hand.begin()["state"], "driving")
        hand.hold([0.1])
        self.wait_velocity("forward", lambda body: body["speeds"] == [0.1] and int(body["drive"]) >= hand.began)
        hand.die()
        self.wait_over(hand)
        self.wait_record(("olga", "drive end", f"{ROBOT} {PART}", "the client has left"))

    def test_a_page_that_hangs_is_silent_and_does_not_drive_any_more(self):
        self.wait_free()
        hand = self.hand()
        self.assertEqual(hand.begin()["state"], "driving")
        hand.held = None
        silent = hand.hear(lambda heard: heard["state"] == "over")
        self.assertEqual(silent["error"]["status"], 504)
        self.wait_record(("olga", "drive end", f"{ROBOT} {PART}", "silence"))

    @unless_silent
    def test_who_is_signed_out_drives_no_further(self):
        self.wait_free()
        client = self.client()
        client.sign_in("olga", GOOD)
        hand = self.hand(client)
        self.assertEqual(hand.begin()["state"], "driving")
        client.ask("DELETE", "/api/v1/session")
        # The next word is refused, or the stream ends before it comes.
        hand.live.until(lambda heard: "error" in heard or heard.get("closed") == SIGNED_OUT)
        self.wait_over(hand)

    @unless_silent
    def test_a_stop_ends_the_drive(self):
        self.wait_free()
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        hand = self.hand()
        self.assertEqual(hand.begin()["state"], "driving")
        hand.hold([0.1])
        self.assertEqual(self.viewer.ask("GET", f"/api/v1/robots/{ROBOT}").status, 200)
        self.order("stop", client=self.other)
        ended = hand.hear(lambda heard: heard["state"] == "over")
        self.assertEqual(ended["error"]["status"], 409, ended)
        again = self.hand().begin()
        self.assertEqual((again["state"], again["error"]["title"]), ("over", "fenced"))


if __name__ == "__main__":
    support.main()
