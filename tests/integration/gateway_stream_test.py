"""What flows through the gateway: sensors that are watched, messages, histories.

Addresses 127.0.250.x, 127.0.251.x.
"""
import json
import os
import re
import signal
import socket
import time

import support
import sensor_side
import trb_fleet
from feeder import Feeder
from gateway_case import CLOUD, GOOD, ROBOT, SCENARIO, WAIT_S, GatewayCase, gateway_client

SENSOR = "humidity"
TOPIC = f"sensor/{ROBOT}/{SENSOR}"


class SensorFleet(trb_fleet.Fleet):
    """The robot's node has a sensor-bus; a program feeds it."""

    def __init__(self, *where, **more):
        super().__init__(*where, **more)
        self.side = sensor_side.SensorSide(self, ROBOT)


def rows_of(frame, kind):
    return [row for block in frame.get("blocks", []) for row in block["rows"] if row["kind"] == kind]


class Stream(GatewayCase):
    block, udp_port = 250, 50250
    fleet_kind = SensorFleet

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.feeder = Feeder(cls.fleet.side.bus, SENSOR, "double:$i", "string:percent")  # every value is another one
        cls.addClassCleanup(cls.feeder.stop)
        cls.fleet.wait("the sensor is listed", lambda: cls.viewer.ask(
            "GET", f"/api/v1/sensors/{ROBOT}/{SENSOR}").status == 200, WAIT_S)
        cls.tap = support.Tap(cls.fleet, ROBOT)
        cls.addClassCleanup(cls.tap.child.stop)

    # ---- helpers

    def leases(self):
        """The leases of the orders for this sensor's values that have passed the router of its node."""
        return [order["lease_s"] for order in self.tap.bodies("sensor_watch") if order["sensor"] == SENSOR]

    def wait_stream(self, running):
        """The last order on the bus starts the stream, or ends it."""
        self.fleet.wait(f"the stream runs: {running}", lambda: bool(self.leases()) and
                        (self.leases()[-1] > 0) == running, WAIT_S)

    def open_live(self, client=None):
        live = (client or self.viewer).live()
        self.addCleanup(live.close)
        self.assertEqual(live.status, 101)
        return live

    def watch(self, live, topic=TOPIC):
        live.say({"subscribe": topic})
        return rows_of(live.until(lambda heard: rows_of(heard, "reading")), "reading")[0]

    # ---- sensors

    def test_the_first_client_starts_a_sensors_stream_and_the_last_one_ends_it(self):
        one, two = self.open_live(), self.open_live(self.operator)
        row = self.watch(one)
        self.assertEqual((row["node"], row["name"], row["live"], row["content"]["unit"]),
                         (ROBOT, SENSOR, "live", "percent"))
        self.wait_stream(True)
        self.watch(two)
        one.say({"unsubscribe": TOPIC})
        two.until(lambda heard: rows_of(heard, "reading"))
        self.assertGreater(self.leases()[-1], 0)
        two.close()
        self.wait_stream(False)
        count = len(self.leases())
        self.watch(self.open_live())
        self.wait_stream(True)
        self.assertGreater(len(self.leases()), count)

    def test_a_sign_out_ends_the_stream(self):
        client = self.client()
        client.sign_in("vic", GOOD)
        live = self.open_live(client)
        self.watch(live)
        self.wait_stream(True)
        client.ask("DELETE", "/api/v1/session")
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 4401)
        self.wait_stream(False)

    def test_whose_rights_end_sees_nothing_more_within_a_second(self):
        for name in ("ina", "ron"):
            self.admin.ask("POST", "/api/v1/users", {"name": name, "role": "operator", "password": GOOD})
        token = self.admin.ask("POST", "/api/v1/tokens", {"name": "wall", "role": "viewer", "days": 1}).json["secret"]
        streams = []
        for name in ("ina", "ron", "vic"):
            client = self.client()
            client.sign_in(name, GOOD)
            streams.append((client, self.open_live(client)))
        screen = self.client()
        screen.token = token
        streams.append((screen, self.open_live(screen)))
        took = []
        for (client, live), end in zip(streams, (
                lambda _: self.admin.ask("PATCH", "/api/v1/users/ina", {"disabled": True}),
                lambda _: self.admin.ask("PATCH", "/api/v1/users/ron", {"role": "viewer"}),
                lambda client: client.ask("DELETE", "/api/v1/session"),
                lambda _: self.admin.ask("DELETE", "/api/v1/tokens/wall"))):
            live.until(lambda heard: "count" in heard)
            self.assertLess(end(client).status, 300)
            began = time.monotonic()  # the request has a handshake of its own
            self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 4401)
            took.append(time.monotonic() - began)
        # 0.4 s each time; what a stalled machine adds comes and goes.
        self.assertLess(sorted(took)[len(took) // 2], 1, took)
        self.assertLess(max(took), 20, took)

    def test_a_sensor_that_nobody_has_gives_an_empty_topic_and_no_stream(self):
        live = self.open_live()
        live.say({"subscribe": f"sensor/{ROBOT}/none"})
        frame = live.until(lambda heard: heard.get("blocks"))
        self.assertEqual(frame["blocks"][0]["rows"], [])
        live.say({"subscribe": "sensor/../secrets"})
        self.assertIn("error", live.until(lambda heard: "error" in heard))
        self.assertEqual([order for order in self.tap.bodies("sensor_watch") if order["sensor"] == "none"], [])

    # ---- messages

    def send(self, client=None, key=None, **body):
        more = {"Idempotency_Key": key} if key else {}
        return (client or self.operator).ask("POST", "/api/v1/messages", body, **more)

    def request(self, subtype, **more):
        return self.operator.ask("POST", "/api/v1/messages/requests", {"target": ROBOT, "subtype": subtype, **more})

    def messages(self, query=""):
        answer = self.viewer.ask("GET", f"/api/v1/messages{query}")
        self.assertEqual(answer.status, 200, answer.bytes)
        return answer.json

    def test_a_command_reaches_the_robot_and_is_seen_on_its_way(self):
        sent = self.send(target=ROBOT, type="command", subtype="move", data={"linear": {"x": 0.1}}, take=True)
        self.assertEqual(sent.status, 200, sent.bytes)
        self.assertEqual((sent.json["answer"]["source"], sent.json["answer"]["subtype"]), (ROBOT, "ack"))
        path = f"?robot={ROBOT}&subtype=move&type=command"
        self.fleet.wait("it is seen", lambda: self.messages(path)["items"], WAIT_S)
        seen = self.messages(path)["items"][0]
        self.assertEqual((seen["target"], seen["phase"], seen["data"]), (ROBOT, "task", '{"linear":{"x":0.1}}'))
        record = self.admin.ask("GET", "/api/v1/audit?limit=1").json["records"][0]
        self.assertEqual((record["who"], record["about"], record["outcome"]), ("olga", f"{ROBOT} command move", "done"))

    def test_a_robots_answer_comes_back_whatever_it_is(self):
        answer = self.request("battery")
        self.assertEqual(answer.status, 200, answer.bytes)
        self.assertEqual(answer.json["answer"]["source"], ROBOT)
        self.assertEqual(self.request("no_such_word", timeout_s=20).json["answer"]["data"], "unknown")

    def test_a_send_with_a_key_is_done_once(self):
        greeting = {"target": ROBOT, "type": "information", "subtype": "greeting", "data": "hello once"}
        before = len(self.messages("?subtype=greeting&limit=500")["items"])
        first, again = (self.send(key="greet", **greeting) for _ in range(2))
        self.assertEqual((first.status, again.status, again.headers["Idempotent-Replay"]), (200, 200, "true"))
        self.fleet.wait("it is seen", lambda: len(self.messages("?subtype=greeting&limit=500")["items"]) > before, WAIT_S)
        seen = {(row["id"]) for row in self.messages("?subtype=greeting&limit=500")["items"] if row["direction"] != "<"}
        self.assertEqual(len(seen) - before, 1)
        self.assert_problem(self.send(key="greet", **{**greeting, "data": "another"}), 409)

    def test_who_may_not_send_and_what_may_not_be_sent(self):
        good = {"target": ROBOT, "type": "information", "subtype": "greeting", "data": "hello"}
        self.assert_problem(self.send(self.viewer, **good), 403, "role_too_low")
        for wrong, status in (({"target": "nobody"}, 404), ({"target": 5}, 422), ({"type": "request"}, 422),
                              ({"type": "none"}, 422), ({"type": "shout"}, 422), ({"subtype": "two words"}, 422),
                              ({"subtype": "../../etc"}, 422), ({"subtype": "x" * 65}, 413), ({"timeout_s": 31}, 422),
                              ({"timeout_s": 0}, 422), ({"more": 1}, 422), ({"take": "yes"}, 422),
                              # The node would sign and decide in the name of anybody:
                              ({"subtype": "sign_request"}, 403), ({"subtype": "alert_decide"}, 403),
                              ({"subtype": "stop"}, 403), ({"subtype": "run_decision"}, 403)):
            with self.subTest(wrong):
                self.assert_problem(self.send(**{**good, **wrong}), status)
        for missing in ("target", "type", "subtype"):
            with self.subTest(missing):
                self.assert_problem(self.send(**{name: value for name, value in good.items() if name != missing}), 400)
        self.assert_problem(self.request("sign_request"), 403)

    def test_recent_messages_in_pages_and_by_filters(self):
        for i in range(5):
            self.send(target=ROBOT, type="information", subtype="paged", data=str(i))
        self.fleet.wait("all are seen", lambda: len(
            {row["data"] for row in self.messages("?subtype=paged&limit=500")["items"]}) == 5, WAIT_S)
        first = self.messages("?subtype=paged&limit=2")
        second = self.messages(f"?subtype=paged&limit=2&cursor={first['next']}")
        numbers = [row["number"] for row in first["items"] + second["items"]]
        self.assertEqual(numbers, sorted(numbers, reverse=True))
        self.assertEqual(len(set(numbers)), 4)
        self.assertEqual(self.messages("?subtype=<script>")["items"], [])
        self.assertEqual({row["phase"] for row in self.messages("?phase=upkeep")["items"]}, {"upkeep"})
        self.assertNotIn("upkeep", {row["phase"] for row in self.messages()["items"]})
        self.assertGreater(first["phases"]["upkeep"], 0)
        self.assertGreaterEqual(first["phases"]["task"], 5)
        for wrong in ("?phase=lunch", "?type=shout", "?limit=0", "?limit=501", "?cursor=x", "?limit=-1"):
            self.assert_problem(self.viewer.ask("GET", f"/api/v1/messages{wrong}"), 422)

    def test_messages_are_heard_live_with_the_count_of_each_phase(self):
        live = self.open_live()
        live.say({"subscribe": "messages"})
        live.until(lambda heard: "head" in heard)
        self.send(target=ROBOT, type="information", subtype="live_word", data="<b>&")

        def heard_it(frame):
            return any(one["subtype"] == "live_word" for one in frame.get("messages", []))
        frame = live.until(heard_it)
        word = next(one for one in frame["messages"] if one["subtype"] == "live_word")
        self.assertEqual((word["target"], word["data"], word["type"]), (ROBOT, "<b>&", "information"))
        self.assertGreater(frame["phases"]["task"], 0)

    # ---- histories

    def history(self, path, query="", status=200):
        answer = self.viewer.ask("GET", f"/api/v1/{path}/history{query}")
        self.assertEqual(answer.status, status, answer.bytes)
        return answer.json

    def wait_recorded(self, path, query, found):
        self.fleet.wait(f"{path} {query} in the history", lambda: any(
            found(one) for one in self.history(path, query)["items"]), WAIT_S)

    def test_a_robots_history_has_its_stops_and_survives_kill_9(self):
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        robot = f"robots/{ROBOT}"
        self.assertIn("ONLINE", [one["value"] for one in self.history(robot, "?kind=connection")["items"]])
        self.order("stop", {"reason": "a box"})
        self.wait_recorded(robot, "?kind=fence", lambda one: one["value"] is True)
        before = self.history(robot, "?kind=fence")["items"]
        # Half a second to the batch, and the time to write it: what is in a page is on disk.
        self.kill_gateway()
        after = self.history(robot, "?kind=fence")["items"]
        self.assertEqual(after[-len(before):], before)

    def test_a_robots_history_has_its_tasks(self):
        started = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO})
        self.assertEqual(started.status, 201, started.bytes)
        task = f"{started.json['run']}/go"
        self.wait_recorded(f"robots/{ROBOT}", "?kind=task",
                           lambda one: (one["about"], one["value"], one["detail"]) == (task, "FINISHED", "go_to"))

    def test_the_readings_of_a_watched_sensor_are_kept_and_given_as_csv(self):
        live = self.open_live()
        self.watch(live)
        sensor = f"sensors/{ROBOT}/{SENSOR}"
        self.fleet.wait("some readings", lambda: len(self.history(sensor)["items"]) >= 5, WAIT_S)
        live.close()
        self.wait_stream(False)
        page = self.history(sensor, "?limit=3")
        times = [one["time"] for one in page["items"]]
        self.assertEqual(times, sorted(times, reverse=True))
        self.assertEqual((page["items"][0]["unit"], page["items"][0]["quality"]), ("percent", "good"))
        older = self.history(sensor, f"?limit=3&cursor={page['next']}")["items"]
        self.assertLess(older[0]["time"], times[-1])
        since = self.history(sensor, f"?from={times[1]}&limit=5000")["items"]
        self.assertEqual([one["time"] for one in since][-1], times[1])
        csv = self.viewer.ask("GET", f"/api/v1/{sensor}/history.csv")
        self.assertEqual(csv.headers["Content-Type"], "text/csv; charset=utf-8")
        lines = csv.bytes.decode().split("\r\n")
        self.assertEqual(lines[0], "time,value,unit,quality")
        self.assertRegex(lines[1], r'^20\d\d-.*Z,[0-9.]+,"percent","good"$')
        self.assertIsNone(csv.headers["Link"])
        newest = self.viewer.ask("GET", f"/api/v1/{sensor}/history.csv?limit=1&from={times[-1]}")
        target = re.fullmatch(r'<(/api/v1/.*&limit=1&from=.*)>; rel="next"', newest.headers["Link"])[1]
        before = self.viewer.ask("GET", target).bytes.decode().split("\r\n")
        self.assertEqual(len(before), 3)
        self.assertLess(before[1].split(",")[0], newest.bytes.decode().split("\r\n")[1].split(",")[0])

    def test_wrong_questions_about_the_past(self):
        for path in ("robots/nobody", f"sensors/{ROBOT}/none", "sensors/nobody/none"):
            self.history(path, status=404)
        self.history("sensors/x'--/y", status=400)
        for query in ("?limit=0", "?limit=5001", "?kind=lunch", "?from=yesterday", "?to=2026-02-30T00:00:00Z"):
            self.history(f"robots/{ROBOT}", query, status=422)
        self.history(f"robots/{ROBOT}", "?cursor=zz", status=400)
        mine = self.history(f"robots/{ROBOT}", "?limit=1")["next"]
        self.history(f"sensors/{ROBOT}/{SENSOR}", f"?cursor={mine}", status=422)
        self.assertEqual(self.client().ask("GET", f"/api/v1/robots/{ROBOT}/history").status, 401)

    # ---- sign-ins

    def test_who_leaves_during_a_sign_in_leaves_no_place_taken(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "lea", "role": "viewer", "password": GOOD})
        for i in range(12):  # four of an address may wait for their turn, 70 ms of a core each
            body = json.dumps({"user": f"gone{i}", "password": "wrong wrong wrong"})
            raw = socket.create_connection(("localhost", self.port), timeout=WAIT_S)
            with self.viewer.tls.wrap_socket(raw, server_hostname="localhost") as client:
                client.sendall((f"POST /api/v1/session HTTP/1.1\r\nHost: localhost:{self.port}\r\n"
                                f"Origin: {self.viewer.origin}\r\nContent-Type: application/json\r\n"
                                f"Content-Length: {len(body)}\r\n\r\n{body}").encode())
        self.assertEqual(self.client().sign_in("lea", GOOD).status, 201)

    # ---- nodes

    def test_services_and_links(self):
        table = self.viewer.ask("GET", "/api/v1/services").json
        self.assertEqual(table["node"], CLOUD)
        self.wait_service("cloud-gateway")
        of_robot = self.viewer.ask("GET", f"/api/v1/services?node={ROBOT}").json
        self.assertIn("mode-adapter", [one["service"] for one in of_robot["services"]])
        links = self.viewer.ask("GET", "/api/v1/links").json
        self.assertEqual([(one["peer"], one["state"]) for one in links["links"]], [(ROBOT, "ONLINE")])
        self.assert_problem(self.viewer.ask("GET", "/api/v1/services?node=nobody"), 404)

    def test_the_doctor_connects_to_no_stranger(self):
        report = self.operator.ask("GET", "/api/v1/doctor").json
        problems = [one for one in report["findings"] if one["severity"] == "problem"]
        self.assertEqual((report["node"], report["well"]), (CLOUD, not problems))
        self.assertEqual(self.operator.ask("GET", f"/api/v1/doctor?peer={ROBOT}").status, 200)
        self.assert_problem(self.operator.ask("GET", "/api/v1/doctor?peer=127.0.0.1:22"), 404)
        self.assert_problem(self.viewer.ask("GET", "/api/v1/doctor"), 403, "role_too_low")

    def test_the_doctor_examines_for_one_at_a_time_and_names_who_hangs(self):
        hangs = self.fleet.pid(ROBOT, "router")
        both = [self.operator.connect() for _ in range(2)]  # before, for an echo is awaited for 2 s
        os.kill(hangs, signal.SIGSTOP)
        try:
            for one in both:
                self.addCleanup(one.close)
                self.operator.begin("GET", "/api/v1/doctor", connection=one)
            done, refused = sorted((gateway_client.Answer(one.getresponse()) for one in both), key=lambda answer: answer.status)
            self.contract.check("GET", "/api/v1/doctor", None, refused)
            self.contract.check("GET", "/api/v1/doctor", None, done)
        finally:
            os.kill(hangs, signal.SIGCONT)
        self.assert_problem(refused, 429, "busy")
        self.assertGreater(int(refused.headers["Retry-After"]), 0)
        self.assertIn(ROBOT, [one["subject"] for one in done.json["findings"]])
        self.assertFalse(done.json["well"])
        self.fleet.wait("the robot is back", self.is_online, WAIT_S)

    # ---- a decision

    def test_what_a_person_was_shown_is_a_list_of_tasks_with_their_robots(self):
        decision = "/api/v1/alerts/0123456789abcdef/decision"
        shown = {"task": "go", "robot": ROBOT}
        for wrong in ("go", ["go"], [{"task": "go"}], [{"task": "go", "robot": 1}], [{**shown, "x": 1}]):
            refused = self.operator.ask("POST", decision, {"verdict": "accept", "shown": wrong})
            self.assert_problem(refused, 422, "bad_value")
            self.assertIn("shown", refused.json["detail"])
        self.assert_problem(self.operator.ask("POST", decision, {"verdict": "accept", "shown": [shown]}), 404)

    # ---- a decision without an alert

    def test_a_person_skips_a_task_that_waits(self):
        self.addCleanup(self.fleet.trb, "release", ROBOT, node=CLOUD)
        self.order("stop")
        run = self.operator.ask("POST", "/api/v1/runs", {"scenario": SCENARIO}).json["run"]
        task = f"/api/v1/runs/{run}/tasks/go"
        decide = self.operator.ask
        self.assert_problem(self.viewer.ask("POST", f"{task}/skip"), 403, "role_too_low")
        self.assert_problem(decide("POST", f"{task}/move", {"robot": ROBOT}), 400)
        self.assert_problem(decide("POST", f"{task}/move", {"reason": "it is near"}), 400)
        self.assert_problem(decide("POST", f"/api/v1/runs/{'0' * 32}/tasks/go/skip"), 404)
        self.fleet.wait("who decides knows the run, and no such task", lambda: decide(
            "POST", f"/api/v1/runs/{run}/tasks/none/skip").status == 422, WAIT_S)
        self.assert_problem(decide("POST", f"{task}/skip", {"stands": "yes"}), 422)
        self.assert_problem(decide("POST", f"{task}/move", {"robot": "nobody", "reason": "it is near"}), 404)
        self.assert_problem(decide("POST", f"{task}/retry"), 409)
        skipped = decide("POST", f"{task}/skip", {"reason": "not today"}, Idempotency_Key="skip-it")
        self.assertEqual(skipped.status, 200, skipped.bytes)
        again = decide("POST", f"{task}/skip", {"reason": "not today"}, Idempotency_Key="skip-it")
        self.assertEqual((again.status, again.bytes), (200, skipped.bytes))
        self.fleet.wait("the run is over", lambda: self.viewer.ask(
            "GET", f"/api/v1/runs/{run}").json.get("state") == "FINISHED", WAIT_S)
        view = self.viewer.ask("GET", f"/api/v1/runs/{run}").json
        self.assertEqual([one["state"] for one in view["tasks"]], ["SKIPPED"])
        self.assertEqual([one["person"] for one in view["decisions"]], ["olga"])


if __name__ == "__main__":
    support.main()
