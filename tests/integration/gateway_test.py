"""The cloud's gateway over HTTPS: a real fleet, its page's requests, and those of people who mean harm.

Addresses 127.0.242.x, 127.0.243.x.
"""
import gzip

import jsonschema
import support
from gateway_case import CLOUD, GOOD, ROBOT, WAIT_S, GatewayCase

DIST = support.REPO / "services/cloud-gateway/web/dist"


class Gateway(GatewayCase):
    block, udp_port = 242, 50242

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
        for media in ("application/jsonp", "application/json-seq", "text/json"):
            self.assert_problem(ask("POST", users, b"{}", Content_Type=media), 415, "media_type")
        for media in ("Application/JSON", "application/json ; charset=utf-8", "application/json;charset=utf-8"):
            self.assert_problem(ask("POST", users, b"{}", Content_Type=media), 400, "missing")
        self.assert_problem(ask("POST", users, {"name": "x", "role": "king", "password": GOOD}), 422)
        self.assert_problem(ask("POST", users, {"name": "x", "role": "viewer", "password": GOOD, "more": 1}), 422)
        self.assert_problem(ask("POST", users, {"name": "';drop table users--", "role": "viewer", "password": GOOD}), 422)
        self.assert_problem(ask("GET", "/api/v1/robots?limit=0"), 422)
        for query in ("robots?cursor=zz", "robots?limit=many", "archive?limit=0", "audit?before=x", "messages?type=x"):
            refused = ask("GET", f"/api/v1/{query}")
            self.assertIn(refused.status, (400, 422), query)
            (fault,) = refused.json["errors"]
            self.assertEqual(fault["pointer"], "", query)
            self.assertIn(query.split("?")[1].split("=")[0] + ": ", fault["detail"])

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

    # ---- the audit log

    def test_what_was_done_is_on_record_and_signed(self):
        self.order("release")
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
        self.order("release")
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


if __name__ == "__main__":
    support.main()
