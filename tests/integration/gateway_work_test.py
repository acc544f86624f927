"""What operators work with in the gateway: stored scenarios, preflight, rankings.

Addresses 127.0.236.x, 127.0.237.x.
"""
import json
import pathlib

import support
from gateway_case import CLOUD, ROBOT, SCENARIO, WAIT_S, GatewayCase

SPARE = "pioneer2"
SCENARIOS = "/api/v1/scenarios"
FILES = pathlib.Path(support.REPO) / "config/scenarios"
RANKING = json.loads((pathlib.Path(support.REPO) / "config/rank/paper-figure-8.json").read_text())
HOSTILE_NAME = "<script>alert(1)</script>\"; filename=\"../x\r\n'); DROP TABLE scenarios--"


class Work(GatewayCase):
    block, udp_port = 236, 50236
    robots = (ROBOT, SPARE, "turtlebot")

    # ---- stored scenarios

    def store(self, scenario=None, client=None, **more):
        return (client or self.operator).ask("POST", SCENARIOS, scenario or SCENARIO, **more)

    def tearDown(self):
        for one in self.operator.ask("GET", f"{SCENARIOS}?limit=500").json["items"]:
            self.operator.ask("DELETE", f"{SCENARIOS}/{one['id']}", If_Match="*")

    def test_a_scenario_is_stored_read_changed_and_deleted(self):
        stored = self.store()
        self.assertEqual((stored.status, stored.json["name"], stored.json["by"]), (201, "short", "olga"))
        place = stored.headers["Location"]
        read = self.viewer.ask("GET", place)
        self.assertEqual((read.json["scenario"], read.headers["ETag"]), (SCENARIO, stored.headers["ETag"]))
        self.assertEqual(self.viewer.ask("GET", place, If_None_Match=read.headers["ETag"]).status, 304)
        changed = self.operator.ask("PUT", place, {**SCENARIO, "name": "longer"}, If_Match=read.headers["ETag"])
        self.assertEqual((changed.status, changed.json["version"], changed.json["name"]), (200, 2, "longer"))
        listed = self.viewer.ask("GET", SCENARIOS).json["items"]
        self.assertIn((stored.json["id"], "longer"), [(one["id"], one["name"]) for one in listed])
        self.assertEqual(self.operator.ask("DELETE", place, If_Match=changed.headers["ETag"]).status, 204)
        self.assert_problem(self.viewer.ask("GET", place), 404, "missing")
        self.assert_problem(self.operator.ask("DELETE", place, If_Match="*"), 404, "missing")

    def test_of_two_who_edit_one_is_told(self):
        place = self.store().headers["Location"]
        tag = self.viewer.ask("GET", place).headers["ETag"]
        self.assertEqual(self.operator.ask("PUT", place, {**SCENARIO, "name": "first"}, If_Match=tag).status, 200)
        self.assert_problem(self.operator.ask("PUT", place, {**SCENARIO, "name": "second"}, If_Match=tag), 412, "changed")
        self.assert_problem(self.operator.ask("PUT", place, SCENARIO), 428, "if_match_missing")
        self.assert_problem(self.operator.ask("DELETE", place, If_Match=tag), 412, "changed")
        self.assert_problem(self.operator.ask("DELETE", place), 428, "if_match_missing")
        self.assert_problem(self.operator.ask("PUT", place, SCENARIO, If_Match="2"), 400)
        self.assertEqual(self.viewer.ask("GET", place).json["name"], "first")

    def test_a_draft_may_have_faults_a_file_may_not(self):
        draft = {"name": "half done", "tasks": [{"id": "go", "skill": 5}], "notes": ["mine"]}
        place = self.store(draft).headers["Location"]
        self.assertEqual(self.viewer.ask("GET", place).json["scenario"], draft)
        refused = self.operator.ask("POST", f"{SCENARIOS}/import", draft)
        self.assert_problem(refused, 422)
        self.assertEqual({"/notes", "/tasks/0/skill"} & {one["pointer"] for one in refused.json["errors"]},
                         {"/notes", "/tasks/0/skill"})

    def test_a_file_of_trb_comes_back_byte_by_byte(self):
        for path in sorted(FILES.glob("*.json")):
            with self.subTest(path.name):
                sent = path.read_bytes()
                stored = self.operator.ask("POST", f"{SCENARIOS}/import", sent, Content_Type="application/json")
                self.assertEqual(stored.status, 201, stored.bytes)
                got = self.viewer.ask("GET", stored.headers["Location"] + "/export")
                self.assertEqual(got.bytes, sent)
                self.assertEqual(got.headers["Content-Disposition"], f'attachment; filename="{path.name}"')
                file = self.fleet.root / path.name
                file.write_bytes(got.bytes)
                self.assertEqual(self.fleet.trb("scenario", "check", file).returncode, 0)

    def test_what_was_stored_is_there_after_a_kill_and_stored_once(self):
        first = self.store(Idempotency_Key="keep")
        self.kill_gateway()
        again = self.operator.ask("POST", SCENARIOS, SCENARIO, Idempotency_Key="keep")
        self.assertEqual((again.status, again.json), (201, first.json))
        for name in ("Location", "ETag"):
            self.assertEqual(again.headers[name], first.headers[name], name)
        self.assertEqual(self.viewer.ask("GET", first.headers["Location"]).json["scenario"], SCENARIO)
        self.assertEqual(self.viewer.ask("GET", first.headers["Location"], If_None_Match=first.headers["ETag"]).status, 304)

    def test_the_list_comes_in_pages_by_name(self):
        for name in ("c", "a", "b", "a"):
            self.store({"name": name, "tasks": []})
        first = self.viewer.ask("GET", f"{SCENARIOS}?limit=3").json
        second = self.viewer.ask("GET", f"{SCENARIOS}?limit=3&cursor={first['next']}").json
        self.assertEqual([one["name"] for one in first["items"] + second["items"]], ["a", "a", "b", "c"])
        self.assertEqual(len({one["id"] for one in first["items"] + second["items"]}), 4)
        self.assertEqual(second["next"], "")
        self.assert_problem(self.viewer.ask("GET", f"{SCENARIOS}?limit=0"), 422)
        self.assert_problem(self.viewer.ask("GET", f"{SCENARIOS}?cursor=zz"), 400)

    def test_a_hostile_name_is_text_and_nothing_else(self):
        stored = self.store({"name": HOSTILE_NAME[:64], "tasks": []})
        self.assertEqual(stored.status, 201, stored.bytes)
        exported = self.viewer.ask("GET", stored.headers["Location"] + "/export")
        self.assertRegex(exported.headers["Content-Disposition"], r'^attachment; filename="[A-Za-z0-9_-]+\.json"$')
        self.assertIn(HOSTILE_NAME[:64], [one["name"] for one in self.viewer.ask("GET", SCENARIOS).json["items"]])

    def test_what_is_no_scenario_is_refused(self):
        for wrong, status in ((b"", 400), (b"{", 400), (b"[]", 422), (b'{"name": "a"}', 400), (b'{"tasks": []}', 400),
                              (b'{"name": "", "tasks": []}', 422), (b'{"name": "a", "tasks": [5]}', 422),
                              (b'{"name": "a", "tasks": {}}', 422), (b'{"name": "\xff", "tasks": []}', 400),
                              (b'{"name": "a", "tasks": ' + b"[" * 50 + b"]" * 50 + b"}", 413),
                              (b'{"name": "a", "tasks": [], "x": "' + b"x" * 300_000 + b'"}', 413)):
            with self.subTest(wrong[:40]):
                self.assert_problem(self.operator.ask("POST", SCENARIOS, wrong, Content_Type="application/json"), status)
        self.assert_problem(self.store(client=self.viewer), 403, "role_too_low")
        for path in ("0" * 16, "../users", "%27", "x" * 90):
            self.assertIn(self.viewer.ask("GET", f"{SCENARIOS}/{path}").status, (400, 404))

    # ---- rankings

    def test_a_ranking_is_the_one_of_trb(self):
        answer = self.viewer.ask("POST", "/api/v1/ahp", RANKING)
        self.assertEqual(answer.status, 200, answer.bytes)
        self.assertEqual(answer.json, self.fleet.json("rank", FILES.parent / "rank/paper-figure-8.json"))

    def test_a_ranking_that_is_wrong_is_refused_with_the_place(self):
        def ask(**changes):
            return self.viewer.ask("POST", "/api/v1/ahp", {**RANKING, **changes})
        self.assert_problem(ask(more=1), 400)
        self.assert_problem(ask(criteria="all"), 422)
        self.assert_problem(ask(criteria=[]), 400)
        self.assert_problem(ask(alternatives=[{"id": "a", "values": {"battery": -1}}]), 422)
        unlike = [["battery", "distance", 9], ["distance", "availability", 9], ["availability", "battery", 9]]
        self.assert_problem(ask(judgments={RANKING["goal"]: unlike}), 409, "conflict")
        self.assert_problem(self.viewer.ask("POST", "/api/v1/ahp", b"{", Content_Type="application/json"), 400)
        self.assert_problem(self.viewer.ask("POST", "/api/v1/ahp"), 400)
        many = [{"id": f"robot{i}", "values": {"battery": 1}} for i in range(5000)]
        self.assert_problem(ask(alternatives=many), 413)

    # ---- preflight

    def preflight(self, scenario=None, client=None):
        return (client or self.operator).ask("POST", f"{SCENARIOS}/preflight", scenario or SCENARIO)

    def test_a_preflight_asks_the_robots(self):
        # A robot has 3 s to answer, which a stalled machine uses up.
        done = self.post(f"{SCENARIOS}/preflight", SCENARIO, good=lambda answer: answer.json.get("ready"))
        self.assertEqual((done.status, done.json["faults"]), (200, []), done.bytes)
        robot, = done.json["robots"]
        self.assertEqual((robot["robot"], robot["tasks"], robot["answers"], robot["why"]), (ROBOT, ["go"], True, []))
        self.assertLess(robot["answer_ms"], 3000)

    def test_a_preflight_tells_what_would_keep_the_run_from_beginning(self):
        self.addCleanup(self.order, "release")
        self.order("stop")
        self.fleet.wait("the stop is told", lambda: any("stopped" in one for one in self.preflight().json["robots"][0]["why"]), WAIT_S)
        condition = {"sensor": "temperature", "of": SPARE, "op": ">", "value": 20, "unit": "degC"}
        guarded = {**SCENARIO, "tasks": [{**SCENARIO["tasks"][0], "robot": SPARE, "when": condition}]}
        sensor, = self.preflight(guarded).json["sensors"]
        self.assertEqual((sensor["task"], sensor["ready"]), ("go", False))
        self.assertTrue(sensor["why"])

    def test_a_preflight_of_what_has_faults_names_them_all_and_asks_nobody(self):
        wrong = {"name": "wrong", "tasks": [{"id": "a", "robot": "nobody", "skill": "go_to"},
                                            {"id": "b", "robot": ROBOT, "skill": "dance"}]}
        done = self.post(f"{SCENARIOS}/preflight", wrong).json  # 503 while the cloud's router gathers the fleet
        self.assertEqual((done["ready"], done["robots"]), (False, []))
        self.assertLessEqual({"/tasks/0/robot", "/tasks/1/skill"}, {one["pointer"] for one in done["faults"]})
        self.assertFalse(self.preflight({"name": "half", "tasks": []}).json["ready"])
        self.assert_problem(self.preflight(client=self.viewer), 403, "role_too_low")
        self.assert_problem(self.operator.ask("POST", f"{SCENARIOS}/preflight", b"[]", Content_Type="application/json"), 422)

    # ---- an alert's candidates

    def rank(self, alert, wish=None, client=None):
        return (client or self.operator).ask("POST", f"/api/v1/alerts/{alert}/ranking", wish)

    def open_alert(self):
        """The robot cannot drive any more, and a run needs it."""
        self.addCleanup(self.post, f"/api/v1/robots/{ROBOT}/repaired")
        self.fleet.trb("robot", "fault", ROBOT, "mobile", "--text", "wheel is off", node=CLOUD)
        run = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO})
        self.assertEqual(run.status, 201, run.bytes)
        self.addCleanup(self.post, f"/api/v1/runs/{run.json['run']}/abort")

        def of_run():
            return [row for row in self.viewer.ask("GET", "/api/v1/alerts").json["items"]
                    if row["content"]["run"] == run.json["run"] and len(row["content"]["proposals"]) == 2]
        self.fleet.wait("the alert with two candidates", of_run, WAIT_S)
        return of_run()[0]["content"]

    def test_an_alerts_candidates_by_other_weights(self):
        alert = self.open_alert()
        self.assertEqual({one["robot"] for one in alert["proposals"]}, {SPARE, "turtlebot"})
        # The robots have 2 s to answer, which a stalled machine uses up.
        by_place = self.post(f"/api/v1/alerts/{alert['id']}/ranking", {"weights": {"distance": 1}},
                             good=lambda answer: answer.json.get("complete"))
        self.assertEqual(by_place.status, 200, by_place.bytes)
        self.assertEqual([one["weight"] for one in by_place.json["weights"]], [0, 1, 0])
        self.assertAlmostEqual(sum(one["score"] for one in by_place.json["proposals"]), 1)
        self.assertEqual({one["robot"] for one in by_place.json["proposals"]}, {SPARE, "turtlebot"})
        judged = self.rank(alert["id"], {"judgments": [["battery", "distance", 9], ["distance", "availability", 9],
                                                       ["availability", "battery", 9]]}).json
        self.assertGreater(judged["consistency"]["cr"], 0.1)  # they contradict each other, and are ranked all the same
        for one in judged["weights"]:
            self.assertAlmostEqual(one["weight"], 1 / 3, places=3)
        same = self.rank(alert["id"]).json
        # What was shown at first may be from before the robots' answers.
        now = self.viewer.ask("GET", f"/api/v1/alerts/{alert['id']}").json["content"]
        self.assertEqual([one["robot"] for one in same["proposals"]], [one["robot"] for one in now["proposals"]])
        for wrong, status in (({"weights": {"colour": 1}}, 422), ({"weights": {"battery": -1}}, 422),
                              ({"weights": {"battery": 0}}, 422), ({"weights": {}}, 422), ({"weights": [1]}, 422),
                              ({"weights": {"battery": "1"}}, 422), ({"judgments": []}, 422), ({"more": 1}, 422),
                              ({"judgments": [["battery", "distance"]]}, 422), ({"judgments": [["a", "b", 3]]}, 422),
                              ({"judgments": [["battery", "distance", 0]]}, 422),
                              ({"weights": {"battery": 1}, "judgments": [["battery", "distance", 1]]}, 422)):
            with self.subTest(wrong):
                self.assert_problem(self.rank(alert["id"], wrong), status)
        self.assert_problem(self.rank(alert["id"], client=self.viewer), 403, "role_too_low")
        self.assert_problem(self.rank("f" * 16), 404)

    # ---- what a third party can verify

    def finished_run(self):
        run = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO}).json["run"]
        self.fleet.wait("the run is over", lambda: self.viewer.ask("GET", f"/api/v1/runs/{run}").json.get("state") == "FINISHED",
                        WAIT_S)
        return run

    def verify(self, proof):
        path = self.fleet.root / "proof.json"
        path.write_text(proof)
        done = self.fleet.trb("run", "verify", path, "--fleet", self.fleet.authority_dir(), "--json", check=False)
        return done.returncode, json.loads(done.stdout)

    def test_the_proof_of_a_run_convinces_a_third_party(self):
        run = self.finished_run()
        answer = self.viewer.ask("GET", f"/api/v1/runs/{run}/proof")
        self.assertEqual((answer.status, answer.json["run"], answer.json["complete"]), (200, run, True))
        kinds = [record["kind"] for record in answer.json["records"]]
        self.assertEqual((kinds[0], kinds[-1], kinds.count("result")), ("run_start", "run_end", len(SCENARIO["tasks"])))
        text = json.dumps(answer.json)
        code, report = self.verify(text)
        self.assertEqual((code, report["complete"], report["faults"]), (0, True, []))
        self.assertEqual(json.loads(self.fleet.trb("run", "proof", run, node=CLOUD).stdout), answer.json)
        signature = answer.json["records"][1]["signature"]
        code, report = self.verify(text.replace(signature, signature[:-1] + ("0" if signature[-1] != "0" else "1")))
        self.assertEqual((code, report["complete"], len(report["faults"])), (1, False, 1))

    def test_a_proof_of_what_is_no_run_is_refused(self):
        self.assert_problem(self.viewer.ask("GET", f"/api/v1/runs/{'b' * 32}/proof"), 404)
        self.assertEqual(self.client().ask("GET", f"/api/v1/runs/{'b' * 32}/proof").status, 401)

    # ---- who replaces a robot

    def resilience_file(self, text):
        """What the cloud node's resilience.json says until the test ends; None: there is none."""
        path = self.fleet.dir(CLOUD) / "resilience.json"
        before = path.read_bytes() if path.exists() else None
        self.addCleanup(lambda: path.unlink(missing_ok=True) if before is None else path.write_bytes(before))
        path.unlink(missing_ok=True)
        if text is not None:
            path.write_text(text)

    def settings(self):
        return [self.viewer.ask("GET", f"/api/v1/{name}") for name in ("policy", "criteria", "minimums")]

    def test_without_a_file_people_decide_and_the_weights_are_those_of_figure_8(self):
        self.resilience_file(None)
        policy, criteria, minimums = (answer.json for answer in self.settings())
        self.assertEqual((policy["mode"], policy["bind"], policy["max_moves"], policy["expires_s"]),
                         ("ask", "automatic", 2, 600))
        weights = {name: one["weight"] for name, one in criteria["criteria"].items()}
        self.assertAlmostEqual(sum(weights.values()), 1)
        self.assertGreater(weights["distance"], weights["battery"])
        self.assertGreater(weights["battery"], weights["availability"])
        self.assertEqual(minimums, {})

    def test_policy_criteria_and_minimums_are_those_of_the_file(self):
        self.resilience_file((FILES.parent / "resilience/payload.json").read_text())
        policy, criteria, minimums = (answer.json for answer in self.settings())
        self.assertEqual((policy["mode"], policy["conditions"]["min_score"]), ("automatic", 0.5))
        payload = criteria["criteria"]["payload"]
        self.assertEqual((payload["from"], payload["unit"], payload["best"], payload["worst"], payload["capabilities"]),
                         ("description", "kg", 10, 0, ["grab"]))
        self.assertAlmostEqual(payload["weight"], 1 / 3)
        self.assertEqual(minimums, {"battery": {"at_least": 20}})

    def test_a_version_that_is_known_is_not_sent_again_until_the_file_changes(self):
        self.resilience_file('{"policy": {"mode": "ask"}}')
        tag = self.viewer.ask("GET", "/api/v1/policy").headers["ETag"]
        self.assertEqual(self.viewer.ask("GET", "/api/v1/policy", If_None_Match=tag).status, 304)
        self.resilience_file('{"policy": {"mode": "automatic"}}')
        changed = self.viewer.ask("GET", "/api/v1/policy", If_None_Match=tag)
        self.assertEqual((changed.status, changed.json["mode"]), (200, "automatic"))

    def test_a_file_with_faults_is_reported_and_not_taken_for_the_default(self):
        for wrong in ("{", "[]", '{"policy": {}}', '{"criteria": {"battery": -1}}', '{"more": 1}', "[" * 5000,
                      '{"criteria": {"<script>": 1}}', '{"expires_s": "long"}'):
            with self.subTest(wrong[:40]):
                self.resilience_file(wrong)
                for answer in self.settings():
                    self.assert_problem(answer, 500, "file_faulty")
        self.assertEqual(self.client().ask("GET", "/api/v1/policy").status, 401)


if __name__ == "__main__":
    support.main()
