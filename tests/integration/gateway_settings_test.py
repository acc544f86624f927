"""Who decides, what counts, who is no candidate: changed in the gateway, kept in resilience.json, in force at the answer.

Addresses 127.0.212.x, 127.0.213.x.
"""
import json
import os
import select
import signal

import support
from gateway_case import CLOUD, WAIT_S, GatewayCase

FILE = '{\n  "_comment": "ask the shift leader",\n  "policy": {"mode": "ask"},\n  "_comment": "ten minutes",\n  "expires_s": 600\n}\n'
POLICY = {"mode": "automatic", "bind": "ask", "max_moves": 3, "expires_s": 120,
          "conditions": {"min_score": 0.5, "min_lead": 0.1, "max_severity": "CRITICAL"}}


class Settings(GatewayCase):
    block, udp_port = 212, 50212

    def setUp(self):
        self.path = self.fleet.dir(CLOUD) / "resilience.json"
        self.path.write_text(FILE)
        self.path.chmod(0o640)

    def tag(self, part):
        return self.admin.ask("GET", f"/api/v1/{part}").headers["ETag"]

    def put(self, part, body, tag=None, client=None, **more):
        return (client or self.admin).ask("PUT", f"/api/v1/{part}", body, If_Match=tag or self.tag(part), **more)

    def resilience_pid(self):
        return self.fleet.pid(CLOUD, "resilience")

    def test_a_policy_is_in_force_when_it_is_answered(self):
        before = self.resilience_pid()
        changed = self.put("policy", POLICY)
        self.assertEqual((changed.status, changed.json), (200, POLICY), changed.bytes)
        self.assertNotEqual(self.resilience_pid(), before)
        self.assertEqual(changed.headers["ETag"], self.tag("policy"))
        text = self.path.read_text()
        self.assertIn("ask the shift leader", text)
        self.assertIn("ten minutes", text)
        self.assertEqual(json.loads(text)["policy"]["max_moves"], 3)
        self.assertEqual(self.path.stat().st_mode & 0o777, 0o640)
        self.assertEqual(self.fleet.json("check", self.fleet.dir(CLOUD))["faults"], [])
        self.wait_service("resilience")

    def test_criteria_and_minimums_keep_each_other(self):
        criteria = {"criteria": {"battery": {"weight": 3}, "distance": {"weight": 1},
                                 "payload": {"weight": 4, "from": "description", "unit": "kg", "best": 10, "worst": 0}}}
        changed = self.put("criteria", criteria)
        self.assertEqual(changed.status, 200, changed.bytes)
        weights = {name: one["weight"] for name, one in changed.json["criteria"].items()}
        self.assertEqual(weights, {"battery": 0.375, "distance": 0.125, "availability": 0, "payload": 0.5})
        minimums = {"battery": {"at_least": 20}, "payload": {"at_least": 1, "at_most": 8}}
        changed = self.put("minimums", minimums)
        self.assertEqual((changed.status, changed.json), (200, minimums), changed.bytes)
        shown = self.admin.ask("GET", "/api/v1/criteria").json["criteria"]
        self.assertEqual({name: one["weight"] for name, one in shown.items()}, weights)
        self.assertEqual(shown["payload"]["at_most"], 8)
        self.assertEqual(self.put("minimums", {}).json, {})

    def test_what_is_read_can_be_written_back(self):
        for part in ("policy", "minimums"):
            with self.subTest(part):
                read = self.admin.ask("GET", f"/api/v1/{part}")
                again = self.put(part, read.json)
                self.assertEqual((again.status, again.json), (200, read.json))
        read = self.admin.ask("GET", "/api/v1/criteria").json["criteria"]
        again = self.put("criteria", {"criteria": read}).json["criteria"]
        self.assertEqual(again.keys(), read.keys())
        for name, one in again.items():
            self.assertAlmostEqual(one["weight"], read[name]["weight"])  # only their ratio counts

    def test_judgments_say_what_counts(self):
        changed = self.put("criteria", {"criteria": {"battery": {}, "distance": {}}, "judgments": [["battery", "distance", 3]]})
        self.assertEqual(changed.status, 200, changed.bytes)
        self.assertAlmostEqual(changed.json["criteria"]["battery"]["weight"], 0.75)

    def test_every_fault_is_told_with_its_place_and_nothing_is_changed(self):
        for part, wrong, places in (
                ("policy", {"mode": "never", "max_moves": 99, "conditions": {"min_score": 2}, "expires_s": -1, "more": 1},
                 {"/mode", "/max_moves", "/conditions/min_score", "/expires_s", "/more"}),
                ("policy", {}, {"/mode"}),
                ("criteria", {"criteria": {"battery": -1, "payload": {"from": "hearsay", "best": 1}}},
                 {"/criteria/battery", "/criteria/payload/from", "/criteria/payload/worst"}),
                ("criteria", {"criteria": {"battery": 0}}, {"/criteria"}),
                ("minimums", {"battery": {"at_least": 9, "at_most": 1}, "payload": {"at_least": 1}}, {"/payload"}),
                ("minimums", {"battery": {"at_least": 9, "at_most": 1}}, {"/battery/at_least"}),
                ("minimums", {"battery": {"at_least": "much"}}, {"/battery/at_least"})):
            with self.subTest(part=part, wrong=wrong):
                refused = self.put(part, wrong)
                self.assert_problem(refused, 422)
                self.assertEqual({one["pointer"] for one in refused.json["errors"]}, places)
                self.assertTrue(all(one["hint"] for one in refused.json["errors"]))
        for hostile in (b"", b"{", b"[]", b'"x"', b'{"mode": "ask", "mode": "automatic"}', b"[" * 5000, b'{"mode": "\xff"}'):
            answer = self.put("policy", hostile, Content_Type="application/json")
            self.assertIn(answer.status, (400, 409, 413, 422), hostile)
        self.assertEqual(self.path.read_text(), FILE)

    def test_only_an_admin_who_has_read_the_newest(self):
        for part in ("policy", "criteria", "minimums"):
            for client in (self.viewer, self.operator):
                self.assert_problem(self.put(part, POLICY, client=client), 403, "role_too_low")
            self.assert_problem(self.admin.ask("PUT", f"/api/v1/{part}", {}), 428, "if_match_missing")
        tag = self.tag("policy")
        self.path.write_text(FILE.replace("600", "601"))
        self.assert_problem(self.put("policy", POLICY, tag), 412, "changed")
        self.assertIn("601", self.path.read_text())

    def test_a_file_with_faults_is_repaired_by_hand(self):
        self.path.write_text('{"policy": {}}')
        self.assert_problem(self.put("policy", POLICY, "*"), 500, "file_faulty")
        self.assertEqual(self.path.read_text(), '{"policy": {}}')

    def test_it_is_on_record_before_it_is_done(self):
        self.put("policy", POLICY)
        self.put("policy", {"mode": "x"})
        newest = self.admin.ask("GET", "/api/v1/audit?limit=3").json["records"]
        self.assertEqual([(one["who"], one["action"], one["outcome"]) for one in newest],
                         [("admin", "PUT /api/v1/policy", "refused: 422"), ("admin", "PUT /api/v1/policy", "done"),
                          ("admin", "PUT /api/v1/policy", "begins")])

    def test_a_kill_leaves_the_old_file_or_the_new_one(self):
        """The gateway is killed at any moment of a change: the file is whole, and a repeat puts it in force."""
        for i in range(5):
            self.path.write_text(FILE)
            tag = self.tag("policy")
            pid = self.fleet.pid(CLOUD, "cloud-gateway")
            connection, _ = self.admin.begin("PUT", "/api/v1/policy", POLICY, If_Match=tag)
            select.select([], [], [], 0.002 * i)  # another moment each time
            os.kill(pid, signal.SIGKILL)
            connection.close()
            text = self.path.read_text()
            self.assertIn(json.loads(text)["policy"]["mode"], ("ask", "automatic"))
            self.assertEqual(json.loads(text)["expires_s"] == 600, json.loads(text)["policy"]["mode"] == "ask")
            self.fleet.wait("another gateway", lambda p=pid: self.fleet.pid(CLOUD, "cloud-gateway") not in (None, p) and
                            self.is_ready(), WAIT_S)
        self.assertEqual(self.put("policy", POLICY).json, POLICY)

    def test_a_service_that_does_not_come_back_is_said_so(self):
        program = self.resilience_pid()
        os.kill(program, signal.SIGSTOP)
        try:
            answer = self.put("policy", POLICY)
        finally:
            os.kill(program, signal.SIGCONT)
        self.assert_problem(answer, 503, "not_in_force")
        self.assertEqual(json.loads(self.path.read_text())["policy"]["mode"], "automatic")
        self.fleet.wait("the change is in force at last", lambda: self.resilience_pid() not in (None, program), WAIT_S)
        self.assertEqual(self.put("policy", POLICY).status, 200)


if __name__ == "__main__":
    support.main()
