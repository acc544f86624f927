"""The cloud's gateway over HTTPS: a real fleet, its page's requests, and those of people who mean harm.

Addresses 127.0.242.x, 127.0.243.x.
"""
import concurrent.futures
import contextlib
import gzip
import http.client
import itertools
import os
import signal
import sqlite3
import time

import jsonschema
import support
from gateway_case import CLOUD, GOOD, ROBOT, SCENARIO, WAIT_S, GatewayCase

FREE, LONG_S = 5, 4  # guesses without a wait; a wait that is not over before a busy machine's next word
DIST = support.REPO / "services/cloud-gateway/web/dist"


class Gateway(GatewayCase):
    block, udp_port = 242, 50242

    # ---- sign-in

    def test_the_cookie_is_for_this_page_alone(self):
        for trait in ("Secure", "HttpOnly", "SameSite=Strict", "Path=/"):
            self.assertIn(trait, self.admin.set_cookie)
        self.assertTrue(self.admin.set_cookie.startswith("__Host-"))
        self.assertEqual(self.admin.ask("GET", "/api/v1/me").json["role"], "admin")

    def test_a_sign_in_gives_a_new_session_and_a_sign_out_ends_it(self):
        client = self.client()
        client.cookie = "0" * 64  # one that somebody has planted
        self.assertEqual(client.sign_in("vic", GOOD).status, 201)
        self.assertNotEqual(client.cookie, "0" * 64)
        self.assertEqual(client.ask("DELETE", "/api/v1/session").status, 204)
        self.assert_problem(client.ask("GET", "/api/v1/robots"), 401, "not_signed_in")

    def test_guessing_has_to_wait(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "gus", "role": "viewer", "password": GOOD})
        self.wait_refused(lambda i: self.client().sign_in("gus", f"wrong {i} wrong wrong"), 401, LONG_S)
        refused = self.client().sign_in("gus", GOOD)
        self.assert_problem(refused, 429, "wait")
        self.assertGreater(int(refused.headers["Retry-After"]), 0)

    def wait_refused(self, guess, wrong, at_least=0):
        """Guesses as soon as it may, until it has to wait, for so many seconds."""
        tries = itertools.count()

        def has_to_wait():
            i = next(tries)
            answer = guess(i)
            if i < FREE or answer.status != 429:
                self.assertEqual(answer.status, wrong)
                return False
            return int(answer.headers["Retry-After"] or 0) >= at_least  # what is refused so is no try

        self.fleet.wait("guessing has to wait", has_to_wait, WAIT_S)

    def test_an_unknown_user_is_refused_as_a_wrong_password_is(self):
        wrong, unknown = self.client().sign_in("olga", "wrong wrong wrong"), self.client().sign_in("nobody", "wrong wrong wrong")
        self.assertEqual((wrong.status, wrong.bytes), (unknown.status, unknown.bytes))

    def test_a_new_password_ends_the_sessions(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "pia", "role": "viewer", "password": GOOD})
        one, two = self.client(), self.client()
        one.sign_in("pia", GOOD)
        two.sign_in("pia", GOOD)
        self.assert_problem(one.ask("PUT", "/api/v1/me/password", {"old": "wrong wrong wrong", "new": GOOD + "!"}), 403)
        self.assert_problem(one.ask("PUT", "/api/v1/me/password", {"old": GOOD, "new": "short"}), 422)
        self.assertEqual(one.ask("PUT", "/api/v1/me/password", {"old": GOOD, "new": GOOD + "!"}).status, 204)
        self.assertEqual(two.ask("GET", "/api/v1/me").status, 401)
        self.assertEqual(two.sign_in("pia", GOOD).status, 401)
        self.assertEqual(two.sign_in("pia", GOOD + "!").status, 201)

    def keep_hashing(self):
        """The gateway's two threads have to hash these passwords before anything that is sent from now on."""
        for _ in range(16):
            connection, _ = self.admin.begin("PUT", "/api/v1/users/vic/password", {"password": GOOD})
            self.addCleanup(connection.close)
        self.addCleanup(lambda: self.viewer.sign_in("vic", GOOD))

    def eva(self, role):
        """A user for one test, signed in."""
        self.admin.ask("POST", "/api/v1/users", {"name": "eva", "role": role, "password": GOOD})
        self.addCleanup(self.admin.ask, "DELETE", "/api/v1/users/eva")
        client = self.client()
        client.sign_in("eva", GOOD)
        return client

    def test_who_has_taken_over_a_session_does_not_undo_the_admins_reset(self):
        new = GOOD + " by the admin"
        thief = self.eva("operator")
        self.keep_hashing()
        connection, _ = thief.begin("PUT", "/api/v1/me/password", {"old": GOOD, "new": GOOD + " by the thief"})
        self.addCleanup(connection.close)
        self.assertEqual(self.admin.ask("PUT", "/api/v1/users/eva/password", {"password": new}).status, 204)
        self.assertEqual(connection.getresponse().status, 401)
        self.assertEqual(self.client().sign_in("eva", new).status, 201)

    def test_an_admin_who_is_disabled_adds_nobody_with_what_he_has_sent_before(self):
        eva = self.eva("admin")
        self.keep_hashing()
        connection, _ = eva.begin("POST", "/api/v1/users", {"name": "door", "role": "admin", "password": GOOD})
        self.addCleanup(connection.close)
        self.assertEqual(self.admin.ask("PATCH", "/api/v1/users/eva", {"disabled": True}).status, 200)
        self.assertEqual(connection.getresponse().status, 401)
        self.assert_problem(self.admin.ask("GET", "/api/v1/users/door"), 404)

    def test_a_session_that_was_taken_over_does_not_tell_the_password(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "max", "role": "viewer", "password": GOOD})
        client = self.client()
        client.sign_in("max", GOOD)
        wrong = {"old": "wrong wrong wrong", "new": GOOD + "!"}
        self.wait_refused(lambda _: client.ask("PUT", "/api/v1/me/password", wrong), 403)

    def test_the_last_admin_stays(self):
        self.assert_problem(self.admin.ask("DELETE", "/api/v1/users/admin"), 409)
        self.assert_problem(self.admin.ask("PATCH", "/api/v1/users/admin", {"role": "viewer"}), 409)

    # ---- rights

    def test_nobody_without_a_session(self):
        stranger = self.client()
        for path in ("/api/v1/robots", "/api/v1/users", "/metrics", "/api/v1/audit"):
            self.assert_problem(stranger.ask("GET", path), 401, "not_signed_in")
        self.assertEqual(stranger.live().status, 401)
        self.assertEqual(stranger.ask("GET", "/api/v1/health").status, 200)

    def test_each_role_has_its_own(self):
        self.assert_problem(self.viewer.ask("POST", f"/api/v1/robots/{ROBOT}/stop"), 403, "role_too_low")
        self.assert_problem(self.operator.ask("GET", "/api/v1/users"), 403, "role_too_low")
        self.assertEqual(self.viewer.ask("GET", "/api/v1/robots").status, 200)

    def test_another_page_changes_nothing(self):
        stop = f"/api/v1/robots/{ROBOT}/stop"
        self.assert_problem(self.operator.ask("POST", stop, Origin="https://evil.example"), 403, "wrong_origin")
        self.assert_problem(self.operator.ask("POST", stop, X_CSRF_Token=None), 403, "wrong_csrf")
        self.assert_problem(self.operator.ask("POST", stop, X_CSRF_Token="0" * 64), 403, "wrong_csrf")
        self.assert_problem(self.operator.ask("POST", stop, Host="evil.example"), 403, "wrong_host")
        self.assertEqual(self.operator.live(Origin="https://evil.example").status, 403)

    def test_a_token(self):
        made = self.admin.ask("POST", "/api/v1/tokens", {"name": "exporter", "role": "operator", "read_only": True, "days": 1})
        self.assertEqual(made.status, 201)
        program = self.client(made.json["secret"])
        self.secrets.append(made.json["secret"])
        self.assertIn("trb_gateway_rows{kind=\"robot\"} 1", program.ask("GET", "/metrics").bytes.decode())
        self.assert_problem(program.ask("POST", "/api/v1/stop"), 403, "read_only_token")
        self.assertNotIn("secret", self.admin.ask("GET", "/api/v1/tokens").json["tokens"][0])
        self.assertEqual(self.admin.ask("DELETE", "/api/v1/tokens/exporter").status, 204)
        self.assertEqual(program.ask("GET", "/metrics").status, 401)

    # ---- requests that are wrong

    def test_wrong_requests_are_told_what_is_wrong(self):
        ask = self.admin.ask
        self.assert_problem(ask("GET", "/api/v1/robots/nobody"), 404)
        self.assert_problem(ask("GET", "/api/v1/none"), 404, "not_found")
        refused = ask("DELETE", "/api/v1/robots")
        self.assert_problem(refused, 405, "method_not_allowed")
        self.assertEqual(refused.headers["Allow"], "GET")
        for path in ("/api/v1/robots/../users", "/api/v1/robots/%2e%2e/users", "/api/v1//robots", "/api/v1/robots/%00"):
            self.assert_problem(ask("GET", path), 400, "bad_path")
        users = "/api/v1/users"
        self.assert_problem(ask("POST", users, b"{", Content_Type="application/json"), 400)
        self.assert_problem(ask("POST", users, b"{}", Content_Type="text/plain"), 415)
        self.assert_problem(ask("POST", users, {"name": "x", "role": "king", "password": GOOD}), 422)
        self.assert_problem(ask("POST", users, {"name": "x", "role": "viewer", "password": GOOD, "more": 1}), 422)
        self.assert_problem(ask("POST", users, {"name": "';drop table users--", "role": "viewer", "password": GOOD}), 422)
        self.assert_problem(ask("GET", "/api/v1/robots?limit=0"), 422)
        self.assert_problem(ask("GET", "/api/v1/robots?cursor=zz"), 400)

    def test_ten_megabytes_are_refused_before_they_are_read(self):
        try:
            self.assert_problem(self.admin.ask("POST", "/api/v1/users", b"x" * 10_000_000), 413)
        except (BrokenPipeError, ConnectionResetError):
            pass  # it was closed while this still sent
        self.assertEqual(self.admin.ask("GET", "/api/v1/me").status, 200)

    def test_every_answer_is_safe_to_show(self):
        answer = self.admin.ask("GET", "/api/v1/robots")
        self.assertIn("default-src 'self'", answer.headers["Content-Security-Policy"])
        self.assertNotIn("unsafe", answer.headers["Content-Security-Policy"])
        self.assertEqual(answer.headers["X-Content-Type-Options"], "nosniff")
        self.assertIsNone(answer.headers["Server"])

    def test_the_description_is_served(self):
        answer = self.client().ask("GET", "/api/v1/openapi.json")
        self.assertEqual((answer.status, answer.json), (200, self.contract.document))
        again = self.client().ask("GET", "/api/v1/openapi.json", If_None_Match=answer.headers["ETag"])
        self.assertEqual((again.status, again.bytes), (304, b""))

    # ---- the page

    def test_anyone_may_load_the_page_and_a_browser_asks_before_it_takes_the_old_one(self):
        stranger = self.client()
        page = stranger.ask("GET", "/")
        self.assertEqual((page.status, page.bytes), (200, (DIST / "index.html").read_bytes()))
        self.assertEqual(page.headers["Content-Type"], "text/html; charset=utf-8")
        self.assertEqual(page.headers["Cache-Control"], "no-cache")
        self.assertNotIn("unsafe", page.headers["Content-Security-Policy"])
        again = stranger.ask("GET", "/", If_None_Match=page.headers["ETag"])
        self.assertEqual((again.status, again.bytes), (304, b""))
        head = stranger.ask("HEAD", "/")
        self.assertEqual((head.status, head.bytes, head.headers["ETag"]), (200, b"", page.headers["ETag"]))

    def test_each_file_of_the_page_is_served_as_it_is_or_gzipped(self):
        for file in (path for path in DIST.rglob("*") if path.is_file() and path.name != "index.html"):
            path = "/" + str(file.relative_to(DIST))
            plain = self.client().ask("GET", path)
            self.assertEqual((plain.status, plain.bytes), (200, file.read_bytes()), path)
            self.assertIsNone(plain.headers["Content-Encoding"])
            packed = self.client().ask("GET", path, Accept_Encoding="gzip, deflate, br")
            self.assertEqual(packed.headers["Content-Encoding"], "gzip")
            self.assertEqual(gzip.decompress(packed.bytes), file.read_bytes(), path)
            self.assertNotEqual(packed.headers["ETag"], plain.headers["ETag"])
            self.assertEqual(packed.headers["Vary"], "Accept-Encoding")
            self.assertEqual("immutable" in packed.headers["Cache-Control"], path.startswith("/assets/"))

    def test_nothing_else_is_served_as_a_file(self):
        for path in ("/index.html", "/assets", "/assets/none.js", "/assets/index.js.map", "/keys/gateway.key", "/favicon.ico"):
            self.assert_problem(self.client().ask("GET", path), 404)
        for path in ("/assets/../keys/gateway.key", "/assets/..%2f..%2fkeys", "/assets/%2e%2e", "//", "/assets/", "/assets/a%00.js"):
            self.assert_problem(self.client().ask("GET", path), 400, "bad_path")
        for method in ("POST", "PUT", "DELETE"):
            refused = self.admin.ask(method, "/")
            self.assert_problem(refused, 405, "method_not_allowed")
            self.assertEqual(refused.headers["Allow"], "GET")

    # ---- the fleet

    def test_the_walls_are_those_that_the_hall_s_people_have_drawn(self):
        picture = self.fleet.dir("cloud") / "hall.svg"
        self.addCleanup(picture.unlink, missing_ok=True)
        self.assertNotIn("picture", self.viewer.ask("GET", "/api/v1/places").json)
        self.assert_problem(self.viewer.ask("GET", "/api/v1/places/picture"), 404)
        drawn = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-1 -20 31 25"><path d="M0 0H30"/></svg>'
        picture.write_bytes(drawn)
        self.assertEqual(self.viewer.ask("GET", "/api/v1/places").json["picture"], {"west": -1, "south": -5, "east": 30, "north": 20})
        walls = self.viewer.ask("GET", "/api/v1/places/picture")
        self.assertEqual((walls.status, walls.bytes, walls.headers["Content-Type"]), (200, drawn, "image/svg+xml"))
        self.assertNotIn("unsafe", walls.headers["Content-Security-Policy"])
        self.assertEqual(self.viewer.ask("GET", "/api/v1/places/picture", If_None_Match=walls.headers["ETag"]).status, 304)
        self.assert_problem(self.client().ask("GET", "/api/v1/places/picture"), 401)
        picture.write_bytes(b"<svg>no metres</svg>")
        self.assertNotIn("picture", self.viewer.ask("GET", "/api/v1/places").json)
        self.assertIn("viewBox", self.viewer.ask("GET", "/api/v1/places/picture").bytes.decode())
        checked = self.fleet.trb("check", self.fleet.dir("cloud"), check=False)
        self.assertIn("hall.svg: viewBox: is missing", checked.stdout + checked.stderr)

    def test_a_robot_and_what_has_not_changed(self):
        listed = self.viewer.ask("GET", "/api/v1/robots").json
        self.assertEqual([row["node"] for row in listed["items"]], [ROBOT])
        self.assertEqual(listed["items"][0]["content"]["connection"], "ONLINE")
        skills = self.viewer.ask("GET", f"/api/v1/robots/{ROBOT}/skills")
        self.assertIn("go_to", [skill["name"] for skill in skills.json["content"]["skills"]])
        schema = skills.json["schemas"]["go_to"]
        jsonschema.Draft202012Validator.check_schema(schema)
        jsonschema.validate({"place": "dock"}, schema)
        for wrong in ({}, {"place": "nowhere"}, {"place": "dock", "speed": 1}):
            with self.assertRaises(jsonschema.ValidationError):
                jsonschema.validate(wrong, schema)
        again = self.viewer.ask("GET", f"/api/v1/robots/{ROBOT}/skills", If_None_Match=skills.headers["ETag"])
        self.assertEqual((again.status, again.bytes), (304, b""))
        self.assertEqual({row["node"] for row in self.viewer.ask("GET", "/api/v1/nodes").json["items"]}, {ROBOT, CLOUD})
        places = self.viewer.ask("GET", "/api/v1/places").json
        self.assertIn("dock", places["places"])
        self.assertIn({"name": "table1", "x": 2.0, "y": 1.0, "z": 0.0, "yaw": 0.0}, places["poses"])

    def test_stop_and_release(self):
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        stopped = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/stop", {"reason": "a box on the way"})
        self.assertEqual([row["state"] for row in stopped.json["robots"]], ["confirmed"])
        self.fleet.wait("it is shown as stopped", lambda: self.viewer.ask(
            "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)
        self.assertEqual(self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release").json["robots"][0]["state"], "confirmed")
        self.assertEqual(self.operator.ask("POST", "/api/v1/stop").json["robots"][0]["robot"], ROBOT)

    def test_a_run_is_started_once_whatever_is_killed(self):
        checked = self.viewer.ask("POST", "/api/v1/scenarios/check", SCENARIO).json
        self.assertEqual((checked["good"], checked["faults"]), (True, []))
        wrong = {"name": "wrong", "tasks": [{"id": "go", "robot": ROBOT, "skill": "dance"}]}
        self.assertFalse(self.viewer.ask("POST", "/api/v1/scenarios/check", wrong).json["good"])
        self.assert_problem(self.operator.ask("POST", "/api/v1/runs", {"scenario": wrong}), 422)
        start = {"scenario": SCENARIO, "priority": 3}
        first = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key="one")
        self.assertEqual(first.status, 201, first.bytes)
        run = first.json["run"]
        self.kill_gateway()
        again = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key="one")
        self.assertEqual((again.status, again.json["run"]), (201, run))
        other = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO}, Idempotency_Key="one")
        self.assert_problem(other, 409)
        self.fleet.wait("the run is over", lambda: self.viewer.ask("GET", f"/api/v1/runs/{run}").json["state"] == "FINISHED", WAIT_S)
        archive = self.viewer.ask("GET", "/api/v1/archive").json["runs"]
        self.assertEqual([one["run"] for one in archive].count(run), 1)

    def write_store(self, sql, rows):
        """Between two gateways: the one that runs stands still, and is killed."""
        os.kill(self.fleet.pid(CLOUD, "cloud-gateway"), signal.SIGSTOP)
        with contextlib.closing(sqlite3.connect(self.fleet.dir(CLOUD) / "state/gateway.db")) as store, store:
            store.executemany(sql, rows)
        self.kill_gateway()
        self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)

    def test_a_stop_is_ordered_though_no_further_key_is_kept(self):
        kept = [(who, f"filler-{i}") for who, count in (("a", 5000), ("b", 5000), ("c", 5000), ("d", 4980), ("olga", 20))
                for i in range(count)]
        self.addCleanup(self.operator.ask, "POST", f"/api/v1/robots/{ROBOT}/release")
        self.addCleanup(self.write_store, "DELETE FROM requests WHERE key LIKE ?", [("filler-%",)])
        self.write_store("INSERT INTO requests(user, key, digest, effect, since, status, body) VALUES(?, ?, x'00', '', ?, 200, x'7b7d')",
                         [(*one, time.time_ns()) for one in kept])
        refused = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release", Idempotency_Key="no-room")
        self.assert_problem(refused, 429, "queue_full")
        for key in ("no-room", "filler-0"):  # the other one was used for something else
            stopped = self.operator.ask("POST", "/api/v1/stop", Idempotency_Key=key)
            self.assertEqual(stopped.status, 200, stopped.bytes)
            self.assertEqual([one["state"] for one in stopped.json["robots"]], ["confirmed"])

    def test_a_stop_of_one_robot_waits_for_no_list_of_the_fleet(self):
        stop, pid = f"/api/v1/robots/{ROBOT}/stop", self.fleet.pid(CLOUD, "cloud-gateway")
        self.addCleanup(self.operator.ask, "POST", f"/api/v1/robots/{ROBOT}/release")

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
        stop, release = (f"/api/v1/robots/{ROBOT}/{word}" for word in ("stop", "release"))
        self.addCleanup(self.operator.ask, "POST", release)
        for _ in range(2):
            stopped = self.operator.ask("POST", stop, Idempotency_Key="stop-again")
            self.assertEqual((stopped.status, stopped.json["robots"][0]["state"]), (200, "confirmed"), stopped.bytes)
            self.assertNotIn("Idempotent-Replay", stopped.headers)
            self.fleet.wait("it is shown as stopped", lambda: self.viewer.ask(
                "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)
            self.assertEqual(self.operator.ask("POST", release).status, 200)
            self.fleet.wait("it is shown as released", lambda: not self.viewer.ask(
                "GET", f"/api/v1/robots/{ROBOT}").json["content"]["fenced"], WAIT_S)

    def test_a_stop_that_the_robot_does_not_confirm_is_on_record_as_that(self):
        go_on, answer = self.under_way("stop")
        told = answer()
        self.assertEqual((told.status, told.json["robots"][0]["state"]), (200, "sent"), told.bytes)
        go_on()
        self.assertEqual(self.orders("stop")[:2], [f"not confirmed by 1 of 1: {ROBOT} sent", "begins"])
        # In the moment after its stall it takes what is as old as that for late.
        self.fleet.wait("it is released", lambda: self.operator.ask(
            "POST", f"/api/v1/robots/{ROBOT}/release").json["robots"][0]["state"] == "confirmed", WAIT_S)
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
        self.fleet.wait("that it begins is on record", lambda: self.newest() > before, 2)
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

    def test_what_is_under_way_when_the_gateway_is_told_to_end_is_answered_and_on_record(self):
        for word in ("stop", "release"):
            go_on, answer = self.under_way(word)
            pid = self.fleet.pid(CLOUD, "cloud-gateway")
            os.kill(pid, signal.SIGTERM)
            self.fleet.wait("it is not there for others any more", lambda: not self.is_ready(), 2)
            go_on()
            told = answer()
            self.assertIsNotNone(told, "the connection was cut")
            self.assertEqual((told.status, told.json["robots"][0]["state"]), (200, "confirmed"), told.bytes)
            self.fleet.wait("another gateway", lambda: self.fleet.pid(CLOUD, "cloud-gateway") not in (None, pid) and
                            self.is_ready(), WAIT_S)
            self.assertEqual(self.orders(word)[:2], ["done", "begins"])
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)

    def test_what_is_under_way_when_the_gateway_is_killed_is_on_record(self):
        for word, again in (("stop", 200), ("release", 503)):
            more = {"Idempotency_Key": f"killed-{word}"}
            go_on, answer = self.under_way(word, **more)
            self.kill_gateway()
            go_on()
            self.assertIsNone(answer())
            self.assertEqual(self.orders(word)[:2], ["not confirmed", "begins"])
            self.fleet.wait("the robot is shown online", self.is_online, WAIT_S)
            repeated = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/{word}", **more)
            self.assertEqual(repeated.status, again, "of a stop alone nothing has to be known")
        self.assertEqual(self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release").status, 200)

    def test_who_looks_whether_it_was_done_is_told_what_to_look_for(self):
        for service, path, body, effect in (
                ("scheduler", "/api/v1/runs", {"scenario": SCENARIO}, "start of a run of scenario 'short'"),
                ("resilience", "/api/v1/alerts/0123456789abcdef/decision", {"verdict": "skip"},
                 "decision on alert 0123456789abcdef: skip")):
            more = {"Idempotency_Key": f"look-{service}"}
            go_on, answer = self.held(CLOUD, service, path, body, **more)
            self.kill_gateway()
            go_on()
            self.assertIsNone(answer())
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

    # ---- the live stream

    def test_a_snapshot_then_what_changes(self):
        live = self.viewer.live()
        self.assertEqual(live.status, 101)
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})
        frame = live.until(lambda heard: heard.get("blocks"))
        block = frame["blocks"][0]
        self.assertTrue(block["begins"] and block["snapshot"])
        self.assertIn(("robot", ROBOT), [(row["kind"], row["node"]) for row in block["rows"]])
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        self.fleet.trb("stop", ROBOT, node=CLOUD)

        def shows_the_stop(heard):
            return any(row["kind"] == "robot" and row["content"]["fenced"]
                       for part in heard.get("blocks", []) for row in part["rows"])
        live.until(shows_the_stop)

    def test_who_looks_at_the_fleet_sees_where_its_robots_are(self):
        live = self.viewer.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})

        def shows_the_place(heard):
            return any(value["name"] == "position" for part in heard.get("blocks", []) for row in part["rows"]
                       if row["kind"] == "robot" for value in row["content"]["values"])
        live.until(shows_the_place)

    def test_wrong_words_are_refused_and_too_many_end_it(self):
        live = self.viewer.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "secrets"})
        self.assertIn("error", live.until(lambda heard: "error" in heard))
        for _ in range(21):
            live.say(b"{")
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 1008)

    def test_who_is_signed_out_sees_nothing_more(self):
        client = self.client()
        client.sign_in("vic", GOOD)
        live = client.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})
        client.ask("DELETE", "/api/v1/session")
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 4401)

    # ---- the audit log

    def test_what_was_done_is_on_record_and_signed(self):
        self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release")
        records = self.admin.ask("GET", "/api/v1/audit?limit=1000").json["records"]
        newest = records[0]
        self.assertEqual((newest["who"], newest["action"], newest["about"], newest["outcome"]),
                         ("olga", "POST /api/v1/robots/{robot}/release", ROBOT, "done"))
        self.assertEqual([one["number"] for one in records], list(range(len(records), 0, -1)))
        self.viewer.ask("POST", f"/api/v1/robots/{ROBOT}/stop")
        refused = self.admin.ask("GET", "/api/v1/audit?limit=1").json["records"][0]
        self.assertEqual((refused["who"], refused["outcome"]), ("vic", "refused: 403"))
        self.fleet.wait("a signed head", lambda: self.admin.ask("GET", "/api/v1/audit/head").json["signed_to"] > 0, WAIT_S)

    def test_a_third_party_verifies_the_exported_log_with_the_fleets_public_key(self):
        self.assertEqual(self.viewer.ask("GET", "/api/v1/audit/export").status, 403)
        self.assert_problem(self.admin.ask("GET", "/api/v1/audit/export?from=x"), 422, "bad_value")
        self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release")
        self.fleet.wait("a signed head", lambda: self.admin.ask("GET", "/api/v1/audit/head").json["signed_to"] > 0, WAIT_S)
        export = self.admin.ask("GET", "/api/v1/audit/export")
        self.assertEqual(export.headers["Content-Type"], "application/x-ndjson")
        file = self.fleet.root / "audit.jsonl"
        file.write_bytes(export.bytes)
        report = self.fleet.json("audit", "verify", file, "--fleet", self.fleet.authority_dir())
        self.assertEqual((report["node"], report["good"], report.get("fault")), (CLOUD, report["records"], None))
        self.assertGreater(report["covered"], 0)
        file.write_bytes(export.bytes.replace(b'"olga"', b'"gulo"', 1))
        forged = self.fleet.trb("audit", "verify", file, "--fleet", self.fleet.authority_dir(), check=False)
        self.assertEqual(forged.returncode, 1)
        self.assertIn("FAULT altered, record ", forged.stdout)

    def test_no_secret_is_written_anywhere(self):
        self.secrets += [GOOD, self.admin.cookie, self.operator.cookie, self.admin.csrf]
        for path in self.fleet.dir(CLOUD).rglob("*"):
            if path.is_file():
                kept = path.read_bytes()
                for secret in self.secrets:
                    self.assertNotIn(secret.encode(), kept, path)
        self.assertEqual((self.fleet.dir(CLOUD) / "keys/gateway.key").stat().st_mode & 0o777, 0o600)
        self.assertEqual((self.fleet.dir(CLOUD) / "state/gateway.db").stat().st_mode & 0o777, 0o600)


if __name__ == "__main__":
    support.main()
