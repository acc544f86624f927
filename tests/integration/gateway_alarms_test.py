"""Alarms in the gateway by IEC 62682 and EEMUA 191: seen, shelved for a while, chattering, first cause; over a kill.

Addresses 127.0.214.x, 127.0.215.x.
"""
import os
import signal

import support
from gateway_case import CLOUD, ROBOT, WAIT_S, GatewayCase

OTHER = "pioneer2"  # whose alarms come again and again
TWICE = "ridgeback"  # which has two capabilities to lose


class Alarms(GatewayCase):
    block, udp_port = 214, 50214
    robots = (ROBOT, OTHER, TWICE)

    def rows(self, **wanted):
        items = self.viewer.ask("GET", "/api/v1/alerts?limit=500").json["items"]
        return [row for row in items if all(row["content"][key] == value for key, value in wanted.items())]

    def alert_of(self, robot, begin):
        """The row of the alert that `begin` leads to."""
        before = {row["name"] for row in self.rows()}
        begin()

        def new():
            return [row for row in self.rows(robot=robot, state="OPEN") if row["name"] not in before]
        self.fleet.wait("its alert", new, WAIT_S)
        return new()[0]

    def fault(self, robot=ROBOT, capability="mobile"):
        """A fault of the robot until the test ends; its alert's row."""
        self.addCleanup(self.repair, robot, capability)
        return self.alert_of(robot, lambda: self.fleet.trb("robot", "fault", robot, capability, "--text", "a wheel is off", node=CLOUD))

    def repair(self, robot=ROBOT, capability="mobile"):
        self.post(f"/api/v1/robots/{robot}/repaired", {"capability": capability})
        self.fleet.wait("the alert is closed", lambda: not self.rows(robot=robot, capability=capability, state="OPEN"), WAIT_S)

    def act(self, alert, what, body=None, client=None):
        return (client or self.operator).ask("POST", f"/api/v1/alerts/{alert}/{what}", body)

    def alarm(self, alert):
        return self.viewer.ask("GET", f"/api/v1/alerts/{alert}").json["alarm"]

    def test_without_the_resilience_services_table_nobody_is_told_that_there_is_no_alert(self):
        program = self.fleet.pid(CLOUD, "resilience")
        os.kill(program, signal.SIGSTOP)
        try:
            self.kill_gateway()
            live = self.viewer.live()
            self.addCleanup(live.close)
            live.say({"subscribe": "alerts"})
            frame = live.until(lambda heard: heard.get("blocks"))
            self.assertEqual(frame["blocks"][0]["rows"], [])
            self.assertIn("resilience", frame["silent"])
        finally:
            os.kill(program, signal.SIGCONT)
        live.until(lambda heard: "count" in heard and "resilience" not in heard.get("silent", []))

    def test_who_has_seen_an_alert_is_known_to_all_and_after_a_kill(self):
        alert = self.fault()
        self.assertEqual((alert["alarm"]["priority"], alert["alarm"]["first"], alert["alarm"]["chatters"]), (2, "", False))
        live = self.viewer.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "alerts"})
        live.until(lambda heard: heard.get("blocks"))
        seen = self.act(alert["name"], "acknowledge")
        self.assertEqual((seen.status, seen.json["acknowledged"]["by"]), (200, "olga"), seen.bytes)
        live.until(lambda heard: any(row["name"] == alert["name"] and row["alarm"].get("acknowledged", {}).get("by") == "olga"
                                     for part in heard.get("blocks", []) for row in part["rows"] if "alarm" in row))
        self.assertEqual(self.act(alert["name"], "acknowledge", client=self.admin).json["acknowledged"], seen.json["acknowledged"])
        self.kill_gateway()
        self.fleet.wait("the alert is shown again", lambda: self.rows(id=alert["name"]), WAIT_S)
        self.assertEqual(self.alarm(alert["name"])["acknowledged"], seen.json["acknowledged"])
        record = next(one for one in self.admin.ask("GET", "/api/v1/audit?limit=20&who=olga").json["records"]
                      if one["action"].endswith("/acknowledge"))
        self.assertEqual((record["about"], record["outcome"]), (alert["name"], "done"))

    def test_a_shelved_alarm_stays_shelved_when_it_comes_again_and_somebody_takes_it_back(self):
        alert = self.fault(OTHER)
        shelved = self.act(alert["name"], "shelve", {"minutes": 30, "reason": "the arm is looked at at noon"})
        self.assertEqual(shelved.status, 200, shelved.bytes)
        self.assertEqual((shelved.json["shelved"]["by"], shelved.json["shelved"]["reason"]), ("olga", "the arm is looked at at noon"))
        self.repair(OTHER)
        again = self.fault(OTHER)
        self.assertNotEqual(again["name"], alert["name"])
        self.assertEqual(again["alarm"]["shelved"], shelved.json["shelved"])
        self.kill_gateway()
        self.fleet.wait("the alert is shown again", lambda: self.rows(id=again["name"]), WAIT_S)
        self.assertEqual(self.alarm(again["name"])["shelved"], shelved.json["shelved"])
        back = self.act(again["name"], "unshelve")
        self.assertEqual((back.status, "shelved" in back.json), (200, False))
        self.assert_problem(self.act(again["name"], "unshelve"), 409, "conflict")
        record = next(one for one in self.admin.ask("GET", "/api/v1/audit?limit=20&who=olga").json["records"]
                      if one["action"].endswith("/shelve"))
        self.assertIn("the arm is looked at at noon", record["about"])

    def test_an_alarm_that_comes_and_goes_is_said_so_and_seen_once(self):
        for _ in range(6):  # three times within a minute: a stalled machine takes longer
            last = self.fault(OTHER)
            if self.alarm(last["name"])["chatters"]:
                break
            self.repair(OTHER)
        self.assertTrue(self.alarm(last["name"])["chatters"])
        self.assertGreaterEqual(self.alarm(last["name"])["times"], 3)
        self.act(last["name"], "acknowledge")
        self.repair(OTHER)
        again = self.fault(OTHER)
        self.assertEqual(self.alarm(again["name"])["acknowledged"]["by"], "olga")

    def test_what_follows_names_its_first_cause(self):
        first, second = self.fault(TWICE), self.fault(TWICE, "carry")
        self.assertEqual((self.alarm(first["name"])["first"], self.alarm(second["name"])["first"]), ("", first["name"]))

    def test_wrong_orders_are_refused_with_a_cure(self):
        alert = self.fault()["name"]
        for body in ({}, {"minutes": 30}, {"reason": "why"}, {"minutes": 0, "reason": "why"}, {"minutes": 481, "reason": "why"},
                     {"minutes": 1.5, "reason": "why"}, {"minutes": "30", "reason": "why"}, {"minutes": 30, "reason": ""},
                     {"minutes": 30, "reason": "x" * 256}, {"minutes": 30, "reason": 7}, {"minutes": 30, "reason": "why", "more": 1}):
            with self.subTest(body):
                refused = self.act(alert, "shelve", body)
                self.assertIn(refused.status, (400, 413, 422))
                self.assert_problem(refused, refused.status)
        for what in ("acknowledge", "shelve", "unshelve"):
            body = {"minutes": 30, "reason": "why"} if what == "shelve" else None
            self.assert_problem(self.act("f" * 16, what, body), 404)
            self.assert_problem(self.act(alert, what, body, self.viewer), 403, "role_too_low")
            self.assertEqual(self.act(alert, what, body, self.client()).status, 401)
        self.assertNotIn("shelved", self.alarm(alert))


if __name__ == "__main__":
    support.main()
