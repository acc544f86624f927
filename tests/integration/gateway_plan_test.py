"""Simulations as jobs of the gateway: started, watched, read, cancelled, and what must not be.

Addresses 127.0.232.x, 127.0.233.x.
"""
import json
import os
import pathlib
import signal
import time
import unittest

import support
from gateway_case import CLOUD, ROBOT, WAIT_S, GatewayCase

SIMULATIONS = "/api/v1/simulations"
SMALL = {"protocol": "talkrobots", "robots": 5, "tasks": 9, "link": "wifi", "seed": 3}
COUNTED = {"robots": 5, "tasks": 9, "interpreted": 5, "sensors": 1, "seconds": 180, "remote_requests": 1, "faulty": 1}
#: Takes more than its minute.
LARGE = {"protocol": "talkrobots", "robots": 100, "tasks": 1000}
THERE = {"id": "there", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}
SCENARIO = {"name": "there and back", "tasks": [THERE, {**THERE, "id": "look"}, {**THERE, "id": "back", "after": ["there"]}]}
TRIED = {"protocol": "talkrobots", "scenario": SCENARIO, "link": "wifi", "seed": 3, "times": {"go_to": {"mean": 2, "deviation": 0.1}}}
OVER = ("done", "failed", "cancelled")
MOST_ENDED = 3
GIBIBYTE = 1 << 30


class Simulations(GatewayCase):
    block, udp_port = 232, 50232

    def tearDown(self):
        """None runs and none is kept, so that no test has another one's."""
        for _ in range(2):
            for one in self.operator.ask("GET", SIMULATIONS).json["items"]:
                self.operator.ask("DELETE", f"{SIMULATIONS}/{one['id']}")
        self.fleet.wait("the simulator's end", lambda: self.simulator() is None, WAIT_S)

    def start(self, job, client=None, **more):
        return (client or self.operator).ask("POST", SIMULATIONS, job, **more)

    def started(self, job):
        answer = self.start(job)
        self.assertEqual(answer.status, 202, answer.bytes)
        return answer.headers["Location"]

    def read(self, place):
        answer = self.viewer.ask("GET", place)
        self.assertEqual(answer.status, 200, answer.bytes)
        return answer.json

    def wait_until(self, place, what, fits):
        self.fleet.wait(what, lambda: fits(self.read(place)), 5 * WAIT_S)
        return self.read(place)

    def result(self, job):
        for _ in range(2):  # it runs behind all others, and may not have its minute on a starved machine
            one = self.wait_until(self.started(job), "the simulation's end", lambda one: one["state"] in OVER)
            if one.get("failure", {}).get("code") != "timeout":
                break
        return one

    def simulator(self):
        """The process that plays, a child of the gateway: for a moment it is the gateway's own program."""
        return self.fleet.pid_of_child(self.fleet.pid(CLOUD, "cloud-gateway"), "simulator")

    def wait_simulator(self):
        """Its pid, once it plays."""
        pids = []
        self.fleet.wait("the simulator", lambda: pids.append(self.simulator()) or pids[-1], WAIT_S)
        return pids[-1]

    # ---- what is right

    def test_the_real_cores_are_played_and_the_answer_is_the_one_of_trb(self):
        one = self.result(SMALL)
        self.assertEqual((one["state"], one["by"], one["job"]), ("done", "olga", SMALL))
        self.assertLessEqual(one["asked"], one["began"])
        self.assertLessEqual(one["began"], one["ended"])
        answer = one["answer"]
        self.assertEqual(answer, self.fleet.json("simulate", "--protocol", "talkrobots", "--robots", 5, "--tasks", 9, "--link", "wifi",
                                                 "--seed", 3))
        self.assertEqual((answer["world"]["state"], answer["world"]["broken"]), ("FINISHED", []))
        self.assertEqual([(task["id"], task["robot"]) for task in answer["tasks"]], [(f"t{i}", f"r{i % 5}") for i in range(9)])
        for before, after in zip(answer["tasks"], answer["tasks"][1:]):
            self.assertLessEqual(before["end_s"], after["begin_s"])

    def test_the_paper_s_protocol_is_counted_beside_its_equations(self):
        answer = self.result(COUNTED)["answer"]
        self.assertEqual((answer["messages"], answer["model"]["messages"]), (299, 299))
        for phase, messages in answer["model"]["phases"].items():
            self.assertEqual(answer["phases"][phase]["messages"], messages, phase)
        self.assertEqual(len(answer["tasks"]), 9)

    def test_a_scenario_is_played_with_the_fleet_s_own_robots(self):
        one = self.result(TRIED)
        self.assertEqual((one["state"], one["job"], one["scenario"], one["robots"], one["tasks"]),
                         ("done", TRIED, "there and back", 1, 3), one.get("failure"))
        answer = one["answer"]
        self.assertEqual((answer["world"]["state"], answer["world"]["broken"]), ("FINISHED", []))
        self.assertEqual({task["robot"] for task in answer["tasks"]}, {ROBOT})
        listed = self.viewer.ask("GET", SIMULATIONS).json["items"][0]
        self.assertEqual(listed["job"], {key: value for key, value in TRIED.items() if key not in ("scenario", "times")})
        self.assertEqual(listed["scenario"], "there and back")

    def test_what_its_tasks_waited_for_is_what_trb_says(self):
        files = {name: self.fleet.root / f"{name}.json" for name in ("scenario", "times")}
        for name, file in files.items():
            file.write_text(json.dumps(TRIED[name]))
        answer = self.result(TRIED)["answer"]
        told = self.fleet.json("simulate", "--fleet", self.fleet.dir(CLOUD).parent, "--scenario", files["scenario"],
                               "--times", files["times"], "--link", "wifi", "--seed", 3)
        self.assertEqual(answer["waits"], told["waits"])
        self.assertEqual([one["critical"] for one in answer["waits"]], [True] * 3, "one robot does one after the other")
        self.assertEqual([one["waited_for"] != "" for one in answer["waits"]], [False, True, True])

    def test_a_scenario_longer_than_an_argument_may_be_is_played(self):
        one = self.result({**TRIED, "scenario": {**SCENARIO, "_comment": "x" * 200_000}})
        self.assertEqual((one["state"], len(one["answer"]["waits"])), ("done", 3), one.get("failure"))

    def test_the_list_has_the_newest_first_without_answers(self):
        places = [self.started({"robots": 2, "tasks": count}) for count in (1, 2)]
        for place in places:
            self.wait_until(place, "its end", lambda one: one["state"] == "done")
        items = self.viewer.ask("GET", SIMULATIONS).json["items"]
        self.assertEqual([f"{SIMULATIONS}/{one['id']}" for one in items], places[::-1])
        self.assertFalse(any("answer" in one for one in items))

    def test_the_newest_twenty_that_are_over_are_kept(self):
        places = []
        for _ in range(22):
            places.append(self.started({"robots": 1, "tasks": 1}))
            self.wait_until(places[-1], "its end", lambda one: one["state"] == "done")
        self.assertEqual(len(self.viewer.ask("GET", SIMULATIONS).json["items"]), 20)
        self.assert_problem(self.viewer.ask("GET", places[0]), 404, "missing")
        self.assertEqual(self.viewer.ask("GET", places[2]).status, 200)

    def test_a_start_with_a_key_is_done_once(self):
        first = self.start(SMALL, Idempotency_Key="plan-0001")
        again = self.start(SMALL, Idempotency_Key="plan-0001")
        self.assertEqual((first.status, again.status, again.json), (202, 202, first.json))
        self.assertEqual(len(self.viewer.ask("GET", SIMULATIONS).json["items"]), 1)
        self.assert_problem(self.start(COUNTED, Idempotency_Key="plan-0001"), 409)

    def test_a_long_one_that_is_started_again_is_told_the_same_simulation(self):
        job = {**TRIED, "scenario": {**SCENARIO, "_comment": "x" * 100_000}}
        first, again = (self.start(job, Idempotency_Key="plan-long") for _ in range(2))
        self.assertEqual((first.status, list(first.json)), (202, ["id"]), first.bytes)
        self.assertEqual((again.status, again.json, again.headers["Idempotent-Replay"]), (202, first.json, "true"))
        self.assertEqual(first.headers["Location"], f"{SIMULATIONS}/{first.json['id']}")
        self.assertEqual(again.headers["Location"], first.headers["Location"])

    # ---- under way

    def test_one_runs_behind_everything_else_and_says_how_far_it_is(self):
        place = self.started(LARGE)
        self.wait_until(place, "progress", lambda one: one["state"] == "running" and one["progress"]["seconds"] > 0)
        pid = self.simulator()
        self.assertEqual(os.getpriority(os.PRIO_PROCESS, pid), 19)
        self.assertEqual(os.getpgid(pid), pid)
        opened = sorted(int(one.name) for one in pathlib.Path(f"/proc/{pid}/fd").iterdir())
        self.assertEqual(opened, [0, 1, 2], "it has descriptors of the gateway")
        self.assertEqual(self.viewer.ask("GET", "/api/v1/health").status, 200)

    @unittest.skipIf(support.is_sanitized(), "a sanitizer reserves more addresses than any bound")
    def test_one_may_have_a_gibibyte_of_addresses(self):
        self.started(LARGE)
        def bound():
            pid = self.simulator()
            is_it = pid and os.readlink(f"/proc/{pid}/exe").endswith("trb-simulator")
            rows = pathlib.Path(f"/proc/{pid}/limits").read_text().splitlines() if is_it else []
            return next((row.split()[3:5] for row in rows if row.startswith("Max address space")), None)
        self.fleet.wait("the simulator", bound, WAIT_S)
        self.assertEqual(bound(), [str(GIBIBYTE)] * 2)

    def test_one_that_runs_is_cancelled_and_the_next_one_begins(self):
        first, second = self.started(LARGE), self.started(SMALL)
        self.assertEqual(self.read(second)["state"], "queued")
        pid = self.wait_simulator()
        cancelled = self.operator.ask("DELETE", first)
        self.assertEqual((cancelled.status, cancelled.json["state"]), (200, "cancelled"))
        self.assertEqual(self.wait_until(second, "its end", lambda one: one["state"] in OVER)["state"], "done")
        self.assertFalse(pathlib.Path(f"/proc/{pid}").exists())
        self.assertNotIn("answer", self.read(first))
        self.assertEqual(self.operator.ask("DELETE", first).status, 204)
        self.assert_problem(self.viewer.ask("GET", first), 404, "missing")
        self.assert_problem(self.operator.ask("DELETE", first), 404, "missing")

    def test_four_wait_and_a_fifth_is_refused_with_a_cure(self):
        for _ in range(5):
            self.started(LARGE)
        self.assert_problem(self.start(SMALL, Idempotency_Key="plan-0005"), 429, "queue_full")
        waits = next(one for one in self.viewer.ask("GET", SIMULATIONS).json["items"] if one["state"] == "queued")
        self.assertEqual(self.operator.ask("DELETE", f"{SIMULATIONS}/{waits['id']}").json["state"], "cancelled")
        self.assertEqual(self.start(SMALL, Idempotency_Key="plan-0005").status, 202, "what was refused for now is tried anew")

    def test_a_simulator_that_is_killed_has_failed_and_the_next_one_begins(self):
        first, second = self.started(LARGE), self.started(SMALL)
        os.kill(self.wait_simulator(), signal.SIGKILL)
        failed = self.wait_until(first, "its end", lambda one: one["state"] in OVER)
        self.assertEqual((failed["state"], failed["failure"]["code"]), ("failed", "io_error"))
        self.assertTrue(failed["failure"]["hint"])
        self.assertEqual(self.wait_until(second, "its end", lambda one: one["state"] in OVER)["state"], "done")

    def test_what_only_the_simulator_can_refuse_has_failed_with_its_words(self):
        failed = self.result({"robots": 5, "tasks": 9, "local_requests": 1})
        self.assertEqual((failed["state"], failed["failure"]["code"]), ("failed", "bad_value"))
        self.assertIn("sensors", failed["failure"]["detail"])
        self.assertTrue(failed["failure"]["hint"])

    def test_a_condition_on_a_sensor_is_decided_by_the_job_s_values(self):
        when = {"sensor": "thermometer", "of": ROBOT, "op": ">", "value": 20, "unit": "degC"}
        tasks = [THERE, {**THERE, "id": "back", "after": ["there"], "when": when}]
        told = {"node": ROBOT, "name": "thermometer", "unit": "degC"}
        for course, done in (({"value": 25}, ["there", "back"]), ({"value": 5}, ["there"]),
                             ({"steps": [{"at": 0, "value": None}, {"at": 9, "value": 25}]}, ["there", "back"])):
            one = self.result({**TRIED, "scenario": {"name": "warm", "tasks": tasks}, "sensor_values": [{**told, **course}]})
            self.assertEqual(one["state"], "done", one.get("failure"))
            self.assertEqual([task["id"] for task in one["answer"]["tasks"]], done, course)
        refused = self.start({**TRIED, "scenario": {"name": "warm", "tasks": tasks}})
        self.assert_problem(refused, 422)
        self.assertEqual([one["pointer"] for one in refused.json["errors"]], ["/scenario"])
        self.assertIn("task 'back' waits for thermometer", refused.json["errors"][0]["detail"])

    def test_a_condition_on_a_sensor_of_the_cloud_is_decided_too_and_a_time_needs_a_skill(self):
        when = {"sensor": "humidity", "of": "cloud", "op": "<", "value": 60, "unit": "percent"}
        job = {**TRIED, "scenario": {"name": "dry", "tasks": [{**THERE, "when": when}]}}
        for percent, done in ((40, ["there"]), (80, [])):
            told = {"node": "cloud", "name": "humidity", "unit": "percent", "value": percent}
            one = self.result({**job, "sensor_values": [told]})
            self.assertEqual(one["state"], "done", one.get("failure"))
            self.assertEqual([task["id"] for task in one["answer"]["tasks"]], done)
        refused = self.start({**TRIED, "times": {"goto": 2}})
        self.assert_problem(refused, 422)
        self.assertEqual([(one["pointer"], one["hint"]) for one in refused.json["errors"]], [("/times/goto", "did you mean 'go_to'?")])

    def test_every_kind_of_fault_and_a_described_link_are_played_as_trb_plays_their_files(self):
        faults = [{"kind": "clock", "node": "r0", "ahead_s": -30, "drift_ppm": 200}, {"kind": "clock", "node": "r2", "is_1970": True},
                  {"kind": "disk", "node": "cloud", "commit_s": 0.05}, {"kind": "battery", "node": "r1", "percent": 90, "per_second": 1},
                  {"at": 1, "kind": "cut", "node": "r0", "other": "r1", "way": "there"}, {"at": 2, "kind": "heal", "node": "r0", "other": "r1"},
                  {"at": 4, "kind": "partition", "nodes": ["r0", "cloud"]}, {"at": 6, "kind": "heal", "nodes": ["r0", "cloud"]},
                  {"at": 7, "kind": "fail", "node": "r2"}, {"at": 9, "kind": "repair", "node": "r2"},
                  {"at": 10, "kind": "kill", "node": "r1"}, {"at": 12, "kind": "start", "node": "r1"},
                  {"kind": "rate", "node": "r0", "between_s": 1000, "repair_s": 5}]
        link = {"delays_s": [0.01, 0.02, 0.2], "loss": 0.001, "bytes_a_second": 500000}
        one = self.result({"protocol": "talkrobots", "robots": 3, "tasks": 6, "seed": 5, "link": link, "faults": faults, "relays": ["cloud"]})
        self.assertEqual(one["state"], "done", one.get("failure"))
        self.assertEqual(one["answer"]["world"]["broken"], [])
        files = {name: self.fleet.root / f"{name}.json" for name in ("faults", "link")}
        files["faults"].write_text(json.dumps(faults))
        files["link"].write_text(json.dumps(link))
        self.assertEqual(one["answer"], self.fleet.json("simulate", "--protocol", "talkrobots", "--robots", 3, "--tasks", 6, "--seed", 5,
                                                        "--link", files["link"], "--faults", files["faults"], "--relays", "cloud"))

    def test_a_run_that_is_not_over_says_why_and_what_was_not_reached(self):
        faults = [{"kind": "cut", "node": "r1"}, {"at": 2, "kind": "fail", "node": "r0"}, {"at": 400, "kind": "heal", "node": "r1"}]
        job = {"protocol": "talkrobots", "robots": 2, "tasks": 2, "seconds": 300, "faults": faults}
        world = self.result(job)["answer"]["world"]
        self.assertEqual((world["state"], world["cut_off"], world["all_linked"], world["finished_at_cloud"]), ("OPEN", True, False, False))
        self.assertEqual({alert["robot"] for alert in world["alerts"]}, {"r0", "r1"})
        self.assertEqual(world["not_reached"], [{"fault": 2, "at": 400}])

    def test_scenarios_at_the_same_time_are_told_each_and_what_they_cost_each_other(self):
        other = {"name": "once more", "tasks": [THERE]}
        one = self.result({**TRIED, "beside": [{"scenario": other}, {"scenario": other, "after": 30}]})
        self.assertEqual(one["state"], "done", one.get("failure"))
        self.assertEqual((one["scenario"], one["beside"], one["tasks"]), ("there and back", ["once more"] * 2, 5))
        answer = one["answer"]
        self.assertNotIn("model", answer)
        self.assertEqual([run["state"] for run in (answer["world"], *answer["beside"])], ["FINISHED"] * 3)
        self.assertEqual([run["broken"] for run in (answer["world"], *answer["beside"])], [[]] * 3)
        self.assertAlmostEqual(answer["beside"][1]["submitted_s"] - answer["world"]["submitted_s"], 30, delta=0.2)
        self.assertAlmostEqual(answer["alone_s"], 6, delta=1)
        self.assertAlmostEqual(answer["beside"][0]["alone_s"], 2, delta=0.5)
        # One robot does all: the first two runs cost each other the time of a task at least.
        kept = [row for run in (answer, answer["beside"][0]) for row in run["waits"] if row.get("kept_s", 0) > 0.5]
        self.assertTrue(kept)
        self.assertFalse([row for row in answer["beside"][1]["waits"] if "kept_s" in row])
        listed = self.viewer.ask("GET", SIMULATIONS).json["items"][0]
        self.assertEqual((listed["beside"], "beside" in listed["job"]), (["once more"] * 2, False))

    def test_what_is_wrong_with_a_scenario_at_the_same_time_is_named_by_its_place(self):
        other = {"name": "once more", "tasks": [THERE]}
        for beside, pointer in (([{"scenario": {"name": "n", "tasks": [{**THERE, "robot": "nobody"}]}}], "/beside/0/scenario/tasks/0/robot"),
                                ([{"scenario": other}, {"scenario": other, "after": -1}], "/beside/1/after"),
                                ([{"after": 2}], "/beside/0/scenario"), ([{"scenario": other}] * 10, "/beside"),
                                ([{"scenario": other, "trace": "x"}], "/beside/0/trace")):
            with self.subTest(pointer):
                answer = self.start({**TRIED, "beside": beside})
                self.assertEqual(answer.status, 422, answer.bytes)
                self.assertEqual([fault["pointer"] for fault in answer.json["errors"]], [pointer])

    def test_a_gateway_that_is_killed_leaves_no_child(self):
        self.started(LARGE)
        pid = self.wait_simulator()
        self.kill_gateway()
        self.fleet.wait("the simulator's end", lambda: not is_alive(pid), WAIT_S)
        self.assertEqual(self.viewer.ask("GET", SIMULATIONS).json["items"], [])

    def test_a_gateway_that_is_told_to_end_ends_its_child_and_waits_for_nothing(self):
        """What the machine adds comes and goes; what the gateway waits for comes each time."""
        for _ in range(MOST_ENDED):
            took = self.ended()
            if took < 2:
                return
        self.fail(f"it has waited for the simulation: {took:.1f} s, as {MOST_ENDED - 1} times before")

    def ended(self):
        """How long a gateway takes to end, and its child with it."""
        self.started(LARGE)
        gateway, pid = self.fleet.pid(CLOUD, "cloud-gateway"), self.wait_simulator()
        began = time.monotonic()
        os.kill(gateway, signal.SIGTERM)
        self.fleet.wait("the simulator's end", lambda: not is_alive(pid), WAIT_S)
        self.fleet.wait("the gateway's end", lambda: not is_alive(gateway), WAIT_S)
        took = time.monotonic() - began
        self.fleet.wait("another gateway", lambda: self.fleet.pid(CLOUD, "cloud-gateway") not in (None, gateway) and self.is_ready(), WAIT_S)
        return took

    # ---- what is wrong

    def test_a_viewer_reads_and_starts_nothing(self):
        self.assert_problem(self.start(SMALL, client=self.viewer), 403, "role_too_low")
        place = self.started({"robots": 1, "tasks": 1})
        self.assert_problem(self.viewer.ask("DELETE", place), 403, "role_too_low")
        self.assertEqual(self.viewer.ask("GET", place).status, 200)
        self.assertEqual(self.client().ask("GET", SIMULATIONS).status, 401)

    def test_a_wrong_job_is_refused_with_the_place_and_a_cure(self):
        def pointers(job):
            plain = self.client()  # what it sends is not as described
            plain.contract, plain.cookie, plain.csrf = None, self.operator.cookie, self.operator.csrf
            refused = self.start(job, client=plain)
            self.assert_problem(refused, 422)
            return {one["pointer"] for one in refused.json["errors"]}
        self.assertEqual(pointers({}), {"/robots", "/tasks"})
        self.assertEqual(pointers({**SMALL, "robots": 101, "seed": -1}), {"/robots", "/seed"})
        self.assertEqual(pointers({**SMALL, "faults": [{"at": 1, "kind": "burn", "node": "r0"}]}), {"/faults/0/kind"})
        self.assertEqual(pointers({**SMALL, "faults": [{"at": 1, "kind": "kill", "node": "r5"}]}), {"/faults/0/node"})
        self.assertEqual(pointers({**SMALL, "link": {"delay_s": 20}}), {"/link/delay_s"})
        self.assertEqual(pointers({**SMALL, "link": "/etc/passwd"}), {"/link"})
        self.assertEqual(pointers({**SMALL, "sensor_values": [{"node": "r0", "name": "t"}]}), {"/sensor_values/0/value"})
        self.assertEqual(pointers({**COUNTED, "trace": "/tmp/written-by-nobody"}), {"/trace"})
        self.assertFalse(pathlib.Path("/tmp/written-by-nobody").exists())
        self.assertEqual(self.viewer.ask("GET", SIMULATIONS).json["items"], [])

    def test_a_wrong_scenario_is_refused_before_it_waits(self):
        def pointers(change, **more):
            plain = self.client()  # what it sends is not as described
            plain.contract, plain.cookie, plain.csrf = None, self.operator.cookie, self.operator.csrf
            refused = self.start({**TRIED, "scenario": {"name": "n", "tasks": [{**THERE, **change}]}, **more}, client=plain)
            self.assert_problem(refused, 422)
            return [one["pointer"] for one in refused.json["errors"]]
        self.assertEqual(pointers({"robot": "nobody"}), ["/scenario/tasks/0/robot"])
        self.assertEqual(pointers({"skill": "fly"}), ["/scenario/tasks/0/skill"])
        self.assertEqual(pointers({"data": {"place": "nowhere"}}), ["/scenario/tasks/0/data/place"])
        self.assertEqual(pointers({"after": ["n"]}), ["/scenario/tasks/0/after"])
        self.assertEqual(pointers({}, fleet=[{"id": "r", "profile": {}}]), ["/fleet"])
        self.assertEqual(pointers({}, protocol="paper"), ["/protocol"])
        self.assertEqual(pointers({}, robots=5), ["/robots"])
        self.assertEqual(pointers({}, times={"go_to": 0}), ["/times/go_to"])
        self.assertEqual(pointers({}, trace="/tmp/written-by-nobody"), ["/trace"])
        self.assertEqual(self.viewer.ask("GET", SIMULATIONS).json["items"], [])

    def test_what_is_no_job_is_refused(self):
        for wrong, status in ((b"", 400), (b"{", 400), (b"[]", 422), (b'{"robots": 1, "robots": 2}', 409), (b'{"robots": "\xff"}', 400),
                              (b'{"robots": 1, "tasks": 1, "x": "' + b"x" * 300_000 + b'"}', 413),
                              (b'{"protocol": "talkrobots", "scenario": 7}', 422), (b'{"protocol": "talkrobots", "scenario": {}}', 422),
                              (b'{"scenario": {"name": "' + b"x" * 300_000 + b'"}}', 413)):
            with self.subTest(wrong[:40]):
                self.assert_problem(self.operator.ask("POST", SIMULATIONS, wrong, Content_Type="application/json"), status)

    def test_the_audit_log_has_starts_and_ends(self):
        place = self.started({"robots": 3, "tasks": 4})
        self.wait_until(place, "its end", lambda one: one["state"] == "done")
        self.operator.ask("DELETE", place)
        rows = self.admin.ask("GET", "/api/v1/audit?limit=20").json["records"]
        said = [(one["who"], one["action"], one["about"], one["outcome"]) for one in rows]
        self.assertIn(("olga", f"POST {SIMULATIONS}", "paper, 3 robots, 4 tasks", "done"), said)
        self.assertIn(("olga", f"DELETE {SIMULATIONS}/{{simulation}}", place.rsplit("/", 1)[1], "done"), said)


def is_alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1][0] != "Z"
    except OSError:
        return False


if __name__ == "__main__":
    support.main()
