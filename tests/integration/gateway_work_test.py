"""What operators work with in the gateway: stored scenarios, rankings.

Addresses 127.0.236.x, 127.0.237.x.
"""
import json
import pathlib

import support
from gateway_case import CLOUD, ROBOT, SCENARIO, GatewayCase

SCENARIOS = "/api/v1/scenarios"
FILES = pathlib.Path(support.REPO) / "config/scenarios"
RANKING = json.loads((pathlib.Path(support.REPO) / "config/rank/paper-figure-8.json").read_text())
HOSTILE_NAME = "<script>alert(1)</script>\"; filename=\"../x\r\n'); DROP TABLE scenarios--"


class Work(GatewayCase):
    block, udp_port = 236, 50236

    # ---- stored scenarios

    def store(self, scenario=None, client=None, **more):
        stored = (client or self.operator).ask("POST", SCENARIOS, scenario or SCENARIO, **more)
        if stored.status == 201:
            self.addCleanup(self.remove, stored.json["id"])
        return stored

    def remove(self, scenario):
        self.operator.ask("DELETE", f"{SCENARIOS}/{scenario}", If_Match="*")

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
                self.addCleanup(self.remove, stored.json["id"])
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
        self.assertEqual(self.viewer.ask("GET", first.headers["Location"]).json["scenario"], SCENARIO)
        self.assertEqual(self.viewer.ask("GET", first.headers["Location"], If_None_Match=first.headers["ETag"]).status, 304)

    def test_the_list_comes_in_pages_by_name(self):
        for name in ("c", "a", "b", "a"):
            self.store({"name": name, "tasks": []})
        first = self.viewer.ask("GET", f"{SCENARIOS}?limit=3").json
        second = self.viewer.ask("GET", f"{SCENARIOS}?limit=3&cursor={first['next']}").json
        self.assertEqual([one["name"] for one in first["items"] + second["items"]], ["a", "a", "b", "c"])
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


if __name__ == "__main__":
    support.main()
