"""Orders by the cloud's gateway, stops and runs: each is done once and on record, whatever is killed or silent meanwhile.

Addresses 127.0.80.x, 127.0.81.x.
"""
import concurrent.futures
import contextlib
import functools
import http.client
import os
import signal
import sqlite3
import time

import support
from gateway_case import CLOUD, ROBOT, SCENARIO, WAIT_S, GatewayCase

MOST_TRIED = 4  # a robot has 3 s to answer, which a stalled machine uses up before the story has


class Orders(GatewayCase):
    block, udp_port = 80, 50080

    def test_stop_and_release(self):
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        stopped = self.order("stop", {"reason": "a box on the way"})
        self.assertEqual([row["state"] for row in stopped.json["robots"]], ["confirmed"])
        self.fleet.wait("it is shown as stopped", lambda: self.viewer.ask(
            "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)
        self.order("release")
        self.assertEqual(self.operator.ask("POST", "/api/v1/stop").json["robots"][0]["robot"], ROBOT)

    def test_a_run_is_started_once_whatever_is_killed(self):
        checked = self.viewer.ask("POST", "/api/v1/scenarios/check", SCENARIO).json
        self.assertEqual((checked["good"], checked["faults"]), (True, []))
        wrong = {"name": "wrong", "tasks": [{"id": "go", "robot": ROBOT, "skill": "dance"}]}
        # 503 while the cloud's router gathers the fleet.
        self.assertFalse(self.post("/api/v1/scenarios/check", wrong, self.viewer).json["good"])
        refused = self.post("/api/v1/runs", {"scenario": wrong})
        self.assert_problem(refused, 422)
        self.assertTrue(all(one["pointer"].startswith("/scenario/tasks/0/") for one in refused.json["errors"]), refused.json)
        refused = self.operator.ask("POST", "/api/v1/runs", {"scenario": 5})
        self.assertEqual({one["pointer"] for one in refused.json["errors"]}, {"/scenario"})
        start = {"scenario": SCENARIO, "priority": 3}
        first = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key="one")
        self.assertEqual(first.status, 201, first.bytes)
        run = first.json["run"]
        self.assertEqual(self.last_about("POST /api/v1/runs"), [("'short' " + run, "done"), ("'short'", "begins")])
        self.kill_gateway()
        again = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key="one")
        self.assertEqual((again.status, again.json["run"]), (201, run))
        self.assertEqual((again.headers["Location"], again.headers["Idempotent-Replay"]), (f"/api/v1/runs/{run}", "true"))
        other = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO}, Idempotency_Key="one")
        self.assert_problem(other, 409)
        self.fleet.wait("the run is over", lambda: self.viewer.ask("GET", f"/api/v1/runs/{run}").json.get("state") == "FINISHED", WAIT_S)
        self.fleet.wait("the run is in the archive", lambda: run in self.archived(), 2 * WAIT_S)  # a minute after its end
        self.assertEqual(self.archived().count(run), 1)

    def archived(self, query=""):
        return [one["run"] for one in self.viewer.ask("GET", f"/api/v1/archive{query}").json["runs"]]

    def test_the_archive_comes_in_pages_and_has_no_run_that_is_open(self):
        tasks = [{**SCENARIO["tasks"][0], "id": f"t{i}", "after": [f"t{i - 1}"] if i else []} for i in range(50)]
        held = self.operator.ask("POST", "/api/v1/runs", {"scenario": {"name": "held", "tasks": tasks}}).json["run"]
        self.addCleanup(self.operator.ask, "POST", f"/api/v1/runs/{held}/abort")
        self.assert_problem(self.operator.ask("POST", f"/api/v1/runs/{held}/pause", {"reason": "x" * 256}), 413, "too_large")
        paused = self.operator.ask("POST", f"/api/v1/runs/{held}/pause", {"reason": "lunch"})
        self.assertEqual(paused.status, 200, paused.bytes)
        self.fleet.wait("who holds it is said", lambda: "by olga: lunch" in self.viewer.ask(
            "GET", f"/api/v1/runs/{held}").json["waits_for"], WAIT_S)
        self.assertEqual(self.last_about("POST /api/v1/runs/{run}/pause")[0], (f"{held} lunch", "done"))
        runs = [self.operator.ask("POST", "/api/v1/runs", {"scenario": {**SCENARIO, "name": f"page {i}"}}).json["run"] for i in range(3)]
        for run in runs:
            self.operator.ask("POST", f"/api/v1/runs/{run}/abort")
        self.fleet.wait("they are in the archive", lambda: set(runs) <= set(self.archived()), 2 * WAIT_S)
        whole = self.archived("?limit=500")
        self.assertNotIn(held, whole)
        paged, cursor = [], ""
        while cursor is not None:
            page = self.viewer.ask("GET", f"/api/v1/archive?limit=2&cursor={cursor}").json
            self.assertLessEqual(len(page["runs"]), 2)
            self.assertEqual(page["more"], bool(page["next"]))
            paged += [one["run"] for one in page["runs"]]
            cursor = page["next"] or None
        self.assertEqual(paged, whole)
        for query in ("limit=0", "limit=501", "cursor=ab", "cursor=" + self.viewer.ask("GET", "/api/v1/robots?limit=1").json["next"] + "00"):
            self.assertIn(self.viewer.ask("GET", f"/api/v1/archive?{query}").status, (400, 422), query)

    def last_about(self, action):
        """The last two records of a route, the newest first."""
        return [(one["about"], one["outcome"]) for one in self.admin.ask("GET", "/api/v1/audit?limit=20&who=olga").json["records"]
                if one["action"] == action][:2]

    def test_a_decision_is_on_record_with_verdict_and_robot(self):
        alert, run = "0123456789abcdef", "/api/v1/runs/0123456789abcdef/tasks/go"
        self.operator.ask("POST", f"/api/v1/alerts/{alert}/decision", {"verdict": "override", "robot": ROBOT, "reason": "nearer"})
        self.assertEqual(self.last_about("POST /api/v1/alerts/{alert}/decision")[1], (f"{alert} override, {ROBOT}", "begins"))
        self.operator.ask("POST", f"{run}/move", {"robot": ROBOT, "reason": "nearer"})
        self.assertEqual(self.last_about("POST /api/v1/runs/{run}/tasks/{task}/move")[1],
                         (f"0123456789abcdef go {ROBOT}", "begins"))

    def test_a_repeat_of_what_had_a_long_answer_is_answered(self):
        tasks = [{"id": f"t{i}", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}} for i in range(900)]
        run = self.operator.ask("POST", "/api/v1/runs", {"scenario": {"name": "long", "tasks": tasks}}).json["run"]
        self.addCleanup(self.operator.ask, "POST", f"/api/v1/runs/{run}/abort")
        first, again = (self.operator.ask("POST", f"/api/v1/runs/{run}/pause", Idempotency_Key="long-pause") for _ in range(2))
        self.assertGreater(len(first.bytes), 1 << 16)
        self.assertEqual((again.status, again.json["run"], again.headers["Idempotent-Replay"]), (200, run, "true"))
        self.assertTrue(again.json["tasks"])
        wrong = {"scenario": {"name": "wrong", "tasks": [{**one, "skill": "dance"} for one in tasks]}}
        first, again = (self.post("/api/v1/runs", wrong, Idempotency_Key="long-refusal") for _ in range(2))
        self.assert_problem(first, 422)
        self.assertGreater(len(first.bytes), 4096)
        self.assertEqual((again.status, again.bytes, again.headers["Idempotent-Replay"]), (422, first.bytes, "true"))
        message = {"target": ROBOT, "type": "information", "subtype": "a_note", "data": "it rains"}
        self.assertEqual(self.operator.ask("POST", "/api/v1/messages", message, Idempotency_Key="long-answer").status, 200)
        keys = ["long-refusal", "long-answer"]
        self.write_store("UPDATE requests SET body = x'' WHERE key = ?", [(key,) for key in keys])
        self.assert_problem(self.operator.ask("POST", "/api/v1/runs", wrong, Idempotency_Key=keys[0]), 422, "not_kept")
        again = self.operator.ask("POST", "/api/v1/messages", message, Idempotency_Key=keys[1])
        self.assertEqual((again.status, again.headers["Idempotent-Replay"]), (200, "true"))
        self.assertIn("too long to be kept", again.json["not_kept"])

    def write_store(self, sql, rows):
        """Between two gateways: the one that runs stands still, and is killed."""
        pid = self.fleet.pid(CLOUD, "cloud-gateway")

        def written():
            os.kill(pid, signal.SIGSTOP)
            try:
                with contextlib.closing(sqlite3.connect(self.fleet.dir(CLOUD) / "state/gateway.db", timeout=1)) as store, store:
                    return store.executemany(sql, rows)
            except sqlite3.OperationalError:  # it stands amid a write of its own
                os.kill(pid, signal.SIGCONT)
        self.fleet.wait("the store is written", written, WAIT_S)
        self.kill_gateway()
        self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)

    def test_a_stop_is_ordered_though_no_further_key_is_kept(self):
        kept = [(who, f"filler-{i}") for who, count in (("a", 5000), ("b", 5000), ("c", 5000), ("d", 4980), ("olga", 20))
                for i in range(count)]
        self.addCleanup(self.order, "release")
        self.addCleanup(self.write_store, "DELETE FROM requests WHERE key LIKE ?", [("filler-%",)])
        self.write_store("INSERT INTO requests(user, key, digest, effect, since, status, body) VALUES(?, ?, x'00', '', ?, 200, x'7b7d')",
                         [(*one, time.time_ns()) for one in kept])
        refused = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release", Idempotency_Key="no-room")
        self.assert_problem(refused, 429, "queue_full")
        for key in ("no-room", "filler-0"):  # the other one was used for something else
            stopped = self.order("stop", path="/api/v1/", Idempotency_Key=key)
            self.assertEqual([one["state"] for one in stopped.json["robots"]], ["confirmed"])

    def test_a_stop_of_one_robot_waits_for_no_list_of_the_fleet(self):
        stop, pid = f"/api/v1/robots/{ROBOT}/stop", self.fleet.pid(CLOUD, "cloud-gateway")
        self.addCleanup(self.order, "release")

        def first_answer():
            with contextlib.suppress(OSError, http.client.HTTPException):
                return self.operator.ask("POST", stop)
        os.kill(pid, signal.SIGKILL)
        answers = []
        self.fleet.wait("the next gateway's first answer", lambda: answers.append(first_answer()) or answers[-1], WAIT_S)
        self.assertEqual(answers[-1].status, 200, answers[-1].bytes)
        self.assertEqual(answers[-1].json["robots"][0]["robot"], ROBOT)
        self.fleet.wait("it is ready", self.is_ready, WAIT_S)
        self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)
        self.assert_problem(self.operator.ask("POST", "/api/v1/robots/nobody/stop"), 404, "missing")

    def test_a_stop_with_the_key_of_an_earlier_one_is_ordered_again(self):
        self.addCleanup(self.order, "release")
        for _ in range(2):
            stopped = self.order("stop", Idempotency_Key="stop-again")
            self.assertNotIn("Idempotent-Replay", stopped.headers)
            self.fleet.wait("it is shown as stopped", lambda: self.viewer.ask(
                "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)
            self.order("release")
            self.fleet.wait("it is shown as released", lambda: not self.viewer.ask(
                "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)

    def test_a_stop_that_the_robot_does_not_confirm_is_on_record_as_that(self):
        go_on, answer = self.under_way("stop")
        told = answer()
        self.assertEqual((told.status, told.json["robots"][0]["state"]), (200, "sent"), told.bytes)
        go_on()
        self.assertEqual(self.orders("stop")[:2], [f"not confirmed by 1 of 1: {ROBOT} sent", "begins"])
        # In the moment after its stall it takes what is as old as that for late.
        self.order("release")
        self.assertEqual(self.orders("release")[0], "done")

    def test_what_nobody_can_be_told_does_not_begin(self):
        for path, body, status in (("/api/v1/runs", {"scenario": SCENARIO, "priority": "high"}, 422),
                                   ("/api/v1/runs", {}, 400),
                                   (f"/api/v1/robots/{ROBOT}/release", {"reason": 7}, 422),
                                   (f"/api/v1/robots/{ROBOT}/retired", {}, 400),
                                   ("/api/v1/robots/nobody/release", {}, 404),
                                   ("/api/v1/runs/0123456789abcdef/pause", {"reason": 7}, 422)):
            for more in ({}, {"Idempotency_Key": f"wrong {path} {status}".replace(" ", "-")}):
                refused = self.operator.ask("POST", path, body, **more)
                self.assert_problem(refused, status)
                last = self.admin.ask("GET", "/api/v1/audit?limit=2&who=olga").json["records"]
                self.assertEqual(last[0]["outcome"], f"refused: {status}", path)
                self.assertNotEqual(last[1]["outcome"], "begins", path)

    def test_a_row_of_a_robot_that_is_lost_has_changed(self):
        paths = [f"/api/v1/robots/{ROBOT}", f"/api/v1/robots/{ROBOT}/skills", f"/api/v1/nodes/{ROBOT}"]
        self.fleet.wait("it is shown as live", lambda: all(
            self.viewer.ask("GET", path).json["live"] == "live" for path in paths), WAIT_S)
        tags = {path: self.viewer.ask("GET", path).headers["ETag"] for path in paths}
        pid = self.fleet.pid(ROBOT, "router")
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(self.fleet.wait, "the robot is online", self.is_online, WAIT_S)
        self.addCleanup(os.kill, pid, signal.SIGCONT)
        for path, tag in tags.items():
            self.fleet.wait("it is not heard", lambda p=path: self.viewer.ask("GET", p).json["live"] == "not_heard", WAIT_S)
            lost = self.viewer.ask("GET", path, If_None_Match=tag)
            self.assertEqual((lost.status, lost.json["live"]), (200, "not_heard"), path)
            # What the cloud's router tells of it may come a moment later.
            self.fleet.wait("it has not changed again", lambda p=path: self.viewer.ask(
                "GET", p, If_None_Match=self.viewer.ask("GET", p).headers["ETag"]).status == 304, WAIT_S)

    def test_a_release_that_reached_nobody_is_tried_anew_with_its_key(self):
        release, more = f"/api/v1/robots/{ROBOT}/release", {"Idempotency_Key": "reach-nobody"}
        pid = self.fleet.pid(ROBOT, "router")
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(os.kill, pid, signal.SIGCONT)
        self.fleet.wait("it is not heard", lambda: self.viewer.ask(
            "GET", f"/api/v1/nodes/{ROBOT}").json["live"] == "not_heard", WAIT_S)
        for _ in range(2):
            nobody = self.operator.ask("POST", release, **more)
            self.assertEqual((nobody.status, nobody.json["robots"][0]["state"]), (200, "unreachable"))
            self.assertNotIn("Idempotent-Replay", nobody.headers)
        os.kill(pid, signal.SIGCONT)
        self.fleet.wait("the robot is online", self.is_online, WAIT_S)
        self.order("release")  # without a key
        anew = self.operator.ask("POST", release, **more)
        self.assertEqual((anew.json["robots"][0]["state"], "Idempotent-Replay" in anew.headers), ("confirmed", False))
        self.assertEqual(self.operator.ask("POST", release, **more).headers["Idempotent-Replay"], "true")

    # ---- a gateway that ends while a robot has not answered yet

    def under_way(self, word, **more):
        """An order that its robot hears and cannot answer; see held()."""
        return self.held(ROBOT, "mode-adapter", f"/api/v1/robots/{ROBOT}/{word}", **more)

    def held(self, node, service, path, body=None, **more):
        """An order that a service cannot answer, once it is on record; what lets the service answer, and a function that
        waits for the order's answer: None if the connection was cut."""
        pid = self.fleet.pid(node, service)
        before = self.newest()
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(os.kill, pid, signal.SIGCONT)

        def ask():
            with contextlib.suppress(OSError, http.client.HTTPException):
                return self.operator.ask("POST", path, body, **more)
        pool = concurrent.futures.ThreadPoolExecutor(1)
        self.addCleanup(pool.shutdown)
        answer = pool.submit(ask)
        self.fleet.wait("that it begins is on record", lambda: self.newest() > before, WAIT_S)
        return (lambda: os.kill(pid, signal.SIGCONT)), lambda: answer.result(WAIT_S)

    def newest(self):
        """The number of olga's last record. All of them take longer to be looked at than the gateway waits for a robot."""
        records = self.admin.ask("GET", "/api/v1/audit?limit=1&who=olga").json["records"]
        return records[0]["number"] if records else 0

    def orders(self, word):
        """What is on record of them, the newest first."""
        return [one["outcome"] for one in self.admin.ask("GET", "/api/v1/audit?limit=1000&who=olga").json["records"]
                if one["action"] == f"POST /api/v1/robots/{{robot}}/{word}" or
                (one["action"] == "unanswered" and one["about"] == f"/api/v1/robots/{{robot}}/{word} {ROBOT}")]

    def told_to_end_under(self, word):
        """The answer to an order under way when the gateway is told to end, once there is the next one."""
        go_on, answer = self.under_way(word)
        pid = self.fleet.pid(CLOUD, "cloud-gateway")

        def is_next():
            return self.fleet.pid(CLOUD, "cloud-gateway") not in (None, pid)
        os.kill(pid, signal.SIGTERM)
        self.fleet.wait("it is not there for others any more", lambda: is_next() or not self.is_ready(), WAIT_S)
        go_on()
        told = answer()
        self.fleet.wait("another gateway", lambda: is_next() and self.is_ready(), WAIT_S)
        return told

    def test_what_is_under_way_when_the_gateway_is_told_to_end_is_answered_and_on_record(self):
        for word in ("stop", "release"):
            for _ in range(MOST_TRIED):
                told = self.told_to_end_under(word)
                self.assertIsNotNone(told, "the connection was cut")
                if told.json["robots"][0]["state"] != "sent":
                    break
                self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)
            self.assertEqual((told.status, told.json["robots"][0]["state"]), (200, "confirmed"), told.bytes)
            self.assertEqual(self.orders(word)[:2], ["done", "begins"])
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)

    def killed_under(self, key, hold):
        """The key of an order that hold() begins, and that was under way when the gateway was killed."""
        for i in range(MOST_TRIED):
            more = {"Idempotency_Key": f"{key}-{i}"}
            go_on, answer = hold(**more)
            self.kill_gateway()
            go_on()
            if answer() is None:
                return more
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)
        self.fail("each was answered before the gateway was killed")

    def test_what_is_under_way_when_the_gateway_is_killed_is_on_record(self):
        for word, again in (("stop", 200), ("release", 503)):
            more = self.killed_under(f"killed-{word}", functools.partial(self.under_way, word))
            self.assertEqual(self.orders(word)[:2], ["not confirmed", "begins"])
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)
            repeated = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/{word}", **more)
            self.assertEqual(repeated.status, again, "of a stop alone nothing has to be known")
        self.order("release")

    def test_who_looks_whether_it_was_done_is_told_what_to_look_for(self):
        for service, path, body, effect in (
                ("scheduler", "/api/v1/runs", {"scenario": SCENARIO}, "start of a run of scenario 'short'"),
                ("resilience", "/api/v1/alerts/0123456789abcdef/decision", {"verdict": "skip"},
                 "decision on alert 0123456789abcdef: skip")):
            more = self.killed_under(f"look-{service}", functools.partial(self.held, CLOUD, service, path, body))
            last = self.admin.ask("GET", "/api/v1/audit?limit=1&who=olga").json["records"][0]
            self.assertEqual((last["action"], last["about"], last["outcome"]), ("unanswered", effect, "not confirmed"))
            repeated = self.operator.ask("POST", path, body, **more)
            self.assert_problem(repeated, 503, "not_confirmed")
            self.assertIn(effect, repeated.json["detail"])
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)

    def test_an_empty_list_says_when_nobody_has_told_what_there_is(self):
        def silent(path="/api/v1/alerts"):
            return self.viewer.ask("GET", path).json.get("silent")
        pid = self.fleet.pid(CLOUD, "resilience")
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(lambda: self.fleet.pid(CLOUD, "resilience") == pid and os.kill(pid, signal.SIGCONT))
        self.kill_gateway()
        self.fleet.wait("all others have told theirs", lambda: silent() == ["resilience"], WAIT_S)
        self.assertEqual(silent("/api/v1/runs"), ["resilience"])
        os.kill(pid, signal.SIGCONT)
        self.fleet.wait("all have told theirs", lambda: silent() is None, WAIT_S)


if __name__ == "__main__":
    support.main()
