#!/usr/bin/env python3
"""Two cloud nodes of one fleet, each with its gateway, on one PostgreSQL server behind nginx; scripts/test-two-gateways sets
all of it up.

Addresses 127.0.100.x, 127.0.101.x.
"""
import concurrent.futures
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "integration"))
import support  # noqa: E402
import trb_fleet  # noqa: E402
import gateway_client  # noqa: E402
import gateway_contract  # noqa: E402
import servers  # noqa: E402
from two_clouds import CLOUDS, SECOND, TwoClouds  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402

ROBOT = "pioneer1"
DRIVEN = "pioneer2"  # by hand
GOOD = "a good long password"
SCENARIO = {"name": "short", "tasks": [{"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}]}
SIGNED_OUT_S = 1.0
BACK_S = 3.0


class TwoGateways(unittest.TestCase):
    contract = gateway_contract.Contract()

    @classmethod
    def setUpClass(cls):
        if servers.newest_postgres() is None:
            raise unittest.SkipTest("PostgreSQL is not installed")
        cls.database = servers.Postgres(cls.folder())
        cls.addClassCleanup(cls.database.stop)
        cls.authority = servers.Authority(cls.folder())
        robots = {ROBOT: trb_fleet.ROBOTS[ROBOT], DRIVEN: trb_fleet.DEMO_ROBOTS[DRIVEN]}
        cls.fleet = support.make_fleet(cls, TwoClouds, block=100, udp_port=50100, robots=robots, speed=20,
                                       gateway_port=trb_fleet.free_port(), database=cls.database, authority=cls.authority)
        cls.fleet.start()
        cls.fleet.wait_formed(60)
        for node in CLOUDS:
            cls.fleet.wait(f"the gateway of {node} is ready", lambda: cls.is_ready(node), 60)
        cls.nginx = servers.Nginx(cls.folder(), cls.fleet.proxy_port, cls.fleet.ports.values(), cls.authority)
        cls.addClassCleanup(cls.nginx.stop)
        cls.admin = cls.at(CLOUD)
        cls.sign_in_anew()
        for name, role in (("olga", "operator"), ("second", "admin")):
            answer = cls.admin.ask("POST", "/api/v1/users", {"name": name, "role": role, "password": GOOD})
            assert answer.status == 201, answer.bytes

    @classmethod
    def sign_in_anew(cls):
        """The admin, with the password of the node's console and then one of his own."""
        made = cls.fleet.json("cloud", "password", cls.fleet.dir(CLOUD))["password"]
        assert cls.admin.sign_in("admin", made).status == 201
        changed = cls.admin.ask("PUT", "/api/v1/me/password", {"old": made, "new": GOOD})
        assert changed.status == 204, changed.bytes
        assert cls.admin.sign_in("admin", GOOD).status == 201

    @classmethod
    def folder(cls):
        made = tempfile.TemporaryDirectory(prefix="trb-", ignore_cleanup_errors=True)
        cls.addClassCleanup(made.cleanup)
        return made.name

    @classmethod
    def at(cls, node, like=None):
        """A client of one gateway; `like`: with that one's session."""
        out = gateway_client.Client(cls.fleet.ports[node], cls.authority.certificate, None, cls.contract)
        if like:
            out.cookie, out.csrf = like.cookie, like.csrf
        return out

    @classmethod
    def through_nginx(cls):
        """Its own answers, such as a 502, follow no contract of the gateway's."""
        return gateway_client.Client(cls.fleet.proxy_port, cls.authority.certificate)

    @classmethod
    def is_ready(cls, node):
        try:
            return cls.at(node).ask("GET", "/api/v1/ready").status == 200
        except (OSError, FileNotFoundError):
            return False

    def signed_in(self, client, user="olga"):
        answer = client.sign_in(user, GOOD)
        self.assertEqual(answer.status, 201, answer.bytes)
        return client

    def both(self, like):
        return [self.at(node, like) for node in CLOUDS]

    def within(self, seconds, what, condition):
        took = self.fleet.wait(what, condition, seconds)
        print(f"  {what}: {took * 1000:.0f} ms", flush=True)

    # ---- sessions

    def test_who_signs_in_through_nginx_is_known_at_both_at_once(self):
        for _ in range(3):
            olga = self.signed_in(self.through_nginx())
            for _ in range(4):
                self.assertEqual(olga.ask("GET", "/api/v1/me").json["user"], "olga")
            for gateway in self.both(olga):
                self.assertEqual(gateway.ask("GET", "/api/v1/me").status, 200)

    def test_who_signs_out_at_one_is_out_at_the_other_and_his_live_stream_ends(self):
        here = self.signed_in(self.at(CLOUD))
        there = self.at(SECOND, here)
        live = there.live()
        self.assertEqual(live.status, 101)
        live.say({"subscribe": "fleet"})
        live.hear()
        self.assertEqual(here.ask("DELETE", "/api/v1/session").status, 204)
        begin = time.monotonic()
        self.assertEqual(there.ask("GET", "/api/v1/me").status, 401)
        self.assertEqual(live.until(lambda message: "closed" in message)["closed"], 4401)
        self.assertLess(time.monotonic() - begin, SIGNED_OUT_S)

    def test_a_live_stream_alone_ends_within_a_second_of_the_sign_out_elsewhere(self):
        here = self.signed_in(self.at(CLOUD))
        live = self.at(SECOND, here).live()
        live.say({"subscribe": "fleet"})
        live.hear()
        self.assertEqual(here.ask("DELETE", "/api/v1/session").status, 204)
        begin = time.monotonic()
        self.assertEqual(live.until(lambda message: "closed" in message)["closed"], 4401)
        self.assertLess(time.monotonic() - begin, SIGNED_OUT_S)

    # ---- two at once

    def at_once(self, *calls):
        """Their answers; all begin at the same moment."""
        start = threading.Barrier(len(calls))

        def call(one):
            start.wait()
            return one()
        with concurrent.futures.ThreadPoolExecutor(len(calls)) as pool:
            return [one.result() for one in [pool.submit(call, one) for one in calls]]

    def test_one_key_at_both_at_once_is_done_once(self):
        olga = self.signed_in(self.at(CLOUD))
        gateways = self.both(olga)
        for i in range(10):
            key = f"both-at-once-{i:04}"
            body = {"name": key, "tasks": []}
            answers = self.at_once(*[lambda one=one: one.ask("POST", "/api/v1/scenarios", body, Idempotency_Key=key)
                                     for one in gateways])
            statuses = sorted(answer.status for answer in answers)
            self.assertEqual(statuses[0], 201, [answer.bytes for answer in answers])
            self.assertIn(statuses[1], (201, 409), [answer.bytes for answer in answers])
            repeats = [one.ask("POST", "/api/v1/scenarios", body, Idempotency_Key=key) for one in gateways]
            self.assertEqual(repeats[0].bytes, repeats[1].bytes)
            listed = gateways[1].ask("GET", "/api/v1/scenarios?limit=500").json["items"]
            self.assertEqual(sum(one["name"] == key for one in listed), 1)

    def test_of_two_changes_of_one_scenario_one_is_told(self):
        olga = self.signed_in(self.at(CLOUD))
        gateways = self.both(olga)
        made = gateways[0].ask("POST", "/api/v1/scenarios", SCENARIO)
        place, tag = made.headers["Location"], made.headers["ETag"]
        for _ in range(10):
            answers = self.at_once(*[lambda one=one, name=name: one.ask("PUT", place, {**SCENARIO, "name": name}, If_Match=tag)
                                     for one, name in zip(gateways, ("left", "right"))])
            won = [answer for answer in answers if answer.status == 200]
            lost = [answer for answer in answers if answer.status != 200]
            self.assertEqual(len(won), 1, [answer.bytes for answer in answers])
            self.assertIn(lost[0].status, (412, 503), lost[0].bytes)
            for one in gateways:
                self.assertEqual(one.ask("GET", place).json["name"], won[0].json["name"])
            tag = won[0].headers["ETag"]

    def test_two_admins_who_remove_each_other_leave_one(self):
        for _ in range(5):
            other = self.at(SECOND)
            self.signed_in(other, "second")
            answers = self.at_once(
                lambda: self.admin.ask("PATCH", "/api/v1/users/second", {"role": "viewer"}),
                lambda: other.ask("PATCH", "/api/v1/users/admin", {"role": "viewer"}))
            self.assertLess(sum(answer.status == 200 for answer in answers), 2, [answer.bytes for answer in answers])
            roles = self.database.sql("SELECT count(*) FROM talkrobots.users WHERE role = 2 AND disabled = 0").strip()
            self.assertNotEqual(roles, "0")
            self.make_admins_again()

    def make_admins_again(self):
        self.sign_in_anew()
        self.assertEqual(self.admin.ask("PATCH", "/api/v1/users/second", {"role": "admin"}).status, 200)

    def test_both_write_one_audit_log_without_a_gap_and_it_verifies(self):
        olga = self.signed_in(self.at(CLOUD))
        gateways = self.both(olga)

        def change(one, name):
            for i in range(20):
                made = one.ask("POST", "/api/v1/scenarios", {"name": f"{name} {i}", "tasks": []})
                while made.status == 503:  # the other was quicker
                    made = one.ask("POST", "/api/v1/scenarios", {"name": f"{name} {i}", "tasks": []})
                self.assertEqual(made.status, 201, made.bytes)
        self.at_once(*[lambda one=one, name=name: change(one, name) for one, name in zip(gateways, CLOUDS)])
        numbers = [int(number) for number in self.database.sql("SELECT number FROM talkrobots.audit ORDER BY number").split()]
        self.assertEqual(numbers, list(range(1, len(numbers) + 1)))
        head = self.fleet.wait("the head is signed", lambda: self.admin.ask("GET", "/api/v1/audit/head").json["signed_to"] > 0, 20)
        self.assertLess(head, 20)
        self.assert_log_verifies()

    def assert_log_verifies(self):
        for node in CLOUDS:
            path = pathlib.Path(self.folder()) / "audit.jsonl"
            path.write_bytes(self.at(node, self.admin).ask("GET", "/api/v1/audit/export").bytes)
            done = self.fleet.trb("audit", "verify", path, "--fleet", self.fleet.authority_dir())
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            print("  " + done.stdout.strip().splitlines()[0], flush=True)

    def test_one_history_of_a_robot_and_each_change_once(self):
        olga = self.signed_in(self.at(CLOUD))

        def fences(node):
            items = self.at(node, olga).ask("GET", f"/api/v1/robots/{ROBOT}/history?kind=fence").json["items"]
            return [one["value"] for one in items]
        self.fleet.wait("both tell what others have stopped", lambda: fences(CLOUD) == fences(SECOND) and True not in fences(CLOUD)[:1], 60)
        before = fences(CLOUD).count(True)
        for word, fenced in (("stop", True), ("release", False)):
            self.assertEqual(olga.ask("POST", f"/api/v1/robots/{ROBOT}/{word}").status, 200)
            for one in self.both(olga):
                self.fleet.wait("the gateway sees it", lambda one=one: one.ask("GET", f"/api/v1/robots/{ROBOT}").json
                                ["content"]["fenced"] is fenced, 10)
        self.fleet.wait("the change is in the history", lambda: fences(SECOND)[:2] == [False, True], 10)
        self.assertEqual(fences(CLOUD), fences(SECOND))
        self.assertEqual(fences(CLOUD).count(True), before + 1)

    # ---- one is gone

    def test_either_gateway_is_killed_and_he_goes_on(self):
        olga = self.signed_in(self.through_nginx())
        made = olga.ask("POST", "/api/v1/scenarios", {"name": "kept", "tasks": []}, Idempotency_Key="kept-by-both-1")
        self.assertEqual(made.status, 201)
        for node in CLOUDS:
            pid = self.fleet.pid(node, "cloud-gateway")
            os.kill(pid, signal.SIGKILL)
            self.within(BACK_S, f"he is served with the gateway of {node} killed",
                        lambda: olga.ask("GET", "/api/v1/me").status == 200)
            for _ in range(6):
                self.assertEqual(olga.ask("GET", "/api/v1/me").status, 200)
            again = olga.ask("POST", "/api/v1/scenarios", {"name": "kept", "tasks": []}, Idempotency_Key="kept-by-both-1")
            self.assertEqual((again.status, again.bytes), (201, made.bytes))
            self.fleet.wait("the killed one is ready again",
                            lambda: self.fleet.pid(node, "cloud-gateway") not in (None, pid) and self.is_ready(node), 30)

    def test_the_server_is_killed_and_both_come_back_by_themselves(self):
        olga = self.signed_in(self.at(CLOUD))
        place = olga.ask("POST", "/api/v1/scenarios", SCENARIO).headers["Location"]
        pids = [self.fleet.pid(node, "cloud-gateway") for node in CLOUDS]
        self.database.kill()
        for gateway in self.both(olga):
            refused = gateway.ask("GET", "/api/v1/me")
            self.assertEqual(refused.status, 503, refused.bytes)
            self.assertTrue(refused.json["type"].endswith("no_database"), refused.bytes)
            self.assertTrue(refused.json["errors"][0]["hint"])
            self.assertEqual(gateway.ask("GET", "/api/v1/health").status, 200)
            self.assertEqual(gateway.ask("GET", "/api/v1/ready").status, 503)
        self.database.start()
        self.within(BACK_S, "both serve again", lambda: all(gateway.ask("GET", place).status == 200 for gateway in self.both(olga)))
        self.assertEqual([self.fleet.pid(node, "cloud-gateway") for node in CLOUDS], pids)

    def test_the_server_is_killed_and_a_stop_stops_all_the_same(self):
        olga = self.signed_in(self.at(CLOUD))
        gateways = self.both(olga)
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)

        def stops():
            answer = self.admin.ask("GET", "/api/v1/audit?limit=500&who=olga")
            return [one for one in answer.json["records"] if one["action"].endswith("/stop")] if answer.status == 200 else []
        before = len(stops())
        for gateway in gateways:
            self.assertEqual(gateway.ask("GET", "/api/v1/me").status, 200)  # which both know by now
        self.database.kill()
        for i, gateway in enumerate(gateways):
            for more in ({}, {"Idempotency_Key": f"stop-without-database-{i}"}):
                stopped = gateway.ask("POST", f"/api/v1/robots/{ROBOT}/stop", **more)
                self.assertEqual(stopped.status, 200, stopped.bytes)
                self.assertEqual(stopped.json["robots"][0]["state"], "confirmed", stopped.bytes)
                self.assertEqual(stopped.headers["Audit-Record"], "owed")
            self.assertEqual(gateway.ask("POST", f"/api/v1/robots/{ROBOT}/release").status, 503)
        self.assertEqual(self.at(CLOUD).ask("POST", "/api/v1/stop").status, 503, "nobody knows who that is")
        self.database.start()
        self.fleet.wait("begin and end of all four stops are on record", lambda: len(stops()) == before + 8, 20)
        # Heads that were asked for meanwhile are stored with later records.
        last = self.admin.ask("GET", "/api/v1/audit/head").json["number"]
        self.fleet.wait("a head covers the stops", lambda: self.admin.ask("GET", "/api/v1/audit/head").json["signed_to"] >= last, 90)
        self.assertEqual(self.signed_in(self.at(SECOND)).ask("GET", "/api/v1/me").status, 200)
        self.assert_log_verifies()

    def test_a_record_that_waits_for_the_server_keeps_no_stop_from_robots(self):
        olga = self.signed_in(self.at(CLOUD))
        self.assertEqual(olga.ask("GET", "/api/v1/me").status, 200)
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        tap = support.Tap(self.fleet, ROBOT)
        self.addCleanup(tap.child.stop)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            # Others read on; who writes waits for two seconds, and gives up.
            lock = pool.submit(self.database.sql, "BEGIN; LOCK TABLE talkrobots.versions IN EXCLUSIVE MODE; SELECT pg_sleep(5)")
            self.fleet.wait("the table is locked", lambda: self.database.sql(
                "SELECT count(*) FROM pg_locks WHERE mode = 'ExclusiveLock' AND relation = 'talkrobots.versions'::regclass"
            ).strip() != "0", 5)
            stopped = pool.submit(olga.ask, "POST", f"/api/v1/robots/{ROBOT}/stop", Idempotency_Key="stop-behind-a-lock")
            self.within(1, "the robot's node hears the stop", lambda: tap.bodies("stop"))
            self.assertEqual(stopped.result(20).status, 200)
            lock.result(20)

    def test_the_server_is_killed_and_who_drove_meanwhile_is_on_record(self):
        olga = self.signed_in(self.at(CLOUD))
        self.fleet.wait("the robot can be driven", lambda: olga.ask("GET", f"/api/v1/robots/{DRIVEN}").json["content"]["drives"], 20)
        live = olga.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})
        live.hear()

        def drives():
            answer = self.admin.ask("GET", "/api/v1/audit?limit=500&who=olga")
            return [one["action"] for one in answer.json["records"] if one["action"].startswith("drive ")] \
                if answer.status == 200 else []
        before = drives()
        self.database.kill()
        live.say({"drive": DRIVEN, "part": "base", "speeds": [0.1], "sequence": 1})
        told = live.until(lambda heard: "drive" in heard)["drive"]
        self.assertEqual(told["state"], "driving", told)
        live.until(lambda heard: "closed" in heard)
        self.database.start()
        self.fleet.wait("begin and end are on record", lambda: len(drives()) >= len(before) + 2, 20)
        self.assertEqual(drives(), ["drive end", "drive begin", *before])
        self.assert_log_verifies()

    # ---- the second cloud's word

    def test_a_run_that_is_started_at_the_second_cloud_finishes(self):
        olga = self.signed_in(self.at(SECOND))
        started = olga.ask("POST", "/api/v1/runs", {"scenario": SCENARIO})
        self.assertEqual(started.status, 201, started.bytes)
        run = started.json["run"]
        self.fleet.wait("the run finishes", lambda: olga.ask("GET", f"/api/v1/runs/{run}").json["state"] == "FINISHED", 60)

    def test_an_alert_is_decided_at_the_second_cloud_and_signed_at_the_first(self):
        olga = self.signed_in(self.at(SECOND))
        self.addCleanup(self.fleet.trb, "robot", "repaired", ROBOT, node=CLOUD)
        self.fleet.trb("robot", "fault", ROBOT, "mobile", "--text", "a wheel is off", node=CLOUD)
        first = self.signed_in(self.at(CLOUD))
        started = first.ask("POST", "/api/v1/runs", {"scenario": SCENARIO})
        self.assertEqual(started.status, 201, started.bytes)
        run = started.json["run"]

        def alerts(person):
            return [row["content"] for row in person.ask("GET", "/api/v1/alerts").json["items"]
                    if row["content"]["run"] == run and row["content"]["state"] == "OPEN"]
        # The decider must know of it, too: nobody is as quick as a test.
        self.fleet.wait("both clouds show the run's alert", lambda: alerts(first) and alerts(olga), 30)
        decided = olga.ask("POST", f"/api/v1/alerts/{alerts(olga)[0]['id']}/decision", {"verdict": "skip", "reason": "not today"},
                           Idempotency_Key="skip-at-the-second")
        self.assertEqual(decided.status, 200, decided.bytes)
        self.fleet.wait("the run goes on to its end", lambda: olga.ask("GET", f"/api/v1/runs/{run}").json["state"] == "FINISHED", 30)
        for gateway in self.both(olga):
            decisions = gateway.ask("GET", f"/api/v1/runs/{run}").json["decisions"]
            self.assertEqual([one["person"] for one in decisions], [f"olga@{SECOND}"])

    def test_no_secret_of_the_database_is_in_a_log(self):
        for path in self.fleet.root.rglob("*.log"):
            self.assertNotIn(self.database.password, path.read_text(errors="replace"), path)


if __name__ == "__main__":
    support.main()
