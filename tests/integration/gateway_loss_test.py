"""Nothing that the gateway has acknowledged is lost: not by a full disk, a killed router, a cut link.

Addresses 127.0.222.x, 127.0.223.x, in a network of the test's own.
"""
import http.client
import os
import signal

import own_world
import support
import trb_fleet
from gateway_case import CLOUD, ROBOT, SCENARIO, WAIT_S, GatewayCase

SCENARIOS = "/api/v1/scenarios"


class FullFleet(trb_fleet.Fleet):
    """The cloud node's folder is on a disk that can be filled."""

    def start(self):
        self.disk = own_world.SmallDisk(self.dir(CLOUD), "64m")
        super().start()


class Loss(GatewayCase):
    block, udp_port = 222, 50222
    fleet_kind = FullFleet

    @classmethod
    def tearDownClass(cls):
        cls.fleet.stop()
        cls.fleet.disk.gone()

    def tried(self, *request, **more):
        """The answer, or nothing: the connection was cut."""
        try:
            return self.operator.ask(*request, **more)
        except (OSError, http.client.HTTPException):
            return None

    def names(self):
        return [one["name"] for one in self.viewer.ask("GET", f"{SCENARIOS}?limit=500").json["items"]]

    def test_a_full_disk_takes_nothing_back_and_acknowledges_nothing_that_it_does_not_hold(self):
        self.addCleanup(self.fleet.disk.room)
        kept = [f"kept {i}" for i in range(3)]
        for name in kept:
            self.assertEqual(self.operator.ask("POST", SCENARIOS, {"name": name, "tasks": []}).status, 201)
        self.fleet.disk.fill()
        acknowledged = []
        refused = 0
        for i in range(20):
            answer = self.tried("POST", SCENARIOS, {"name": f"full {i}", "tasks": [], "notes": "x" * 20_000})
            if answer is not None and answer.status == 201:
                acknowledged.append(f"full {i}")
            else:
                refused += 1
                self.assertIn(answer and answer.status, (None, 503))
        self.assertGreater(refused, 0, "the disk was not full")
        self.fleet.disk.room()
        self.fleet.wait("the gateway is back by itself", self.is_ready, WAIT_S)
        self.assertLessEqual(set(kept + acknowledged), set(self.names()))
        self.assertEqual(self.operator.ask("POST", SCENARIOS, {"name": "room again", "tasks": []}).status, 201)
        records = self.admin.ask("GET", "/api/v1/audit?limit=1000").json["records"]
        self.assertEqual([one["number"] for one in records], list(range(len(records), 0, -1)))

    def start_taken(self, start, name):
        """The answer to a start that is sent with one key until a router takes it, and that key. What a router refuses (429, 503)
        was not done, and frees the key; of a time-out nobody knows, and its answer stays."""
        tries, keys = [], [f"{name}-0"]

        def is_taken():
            answer = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key=keys[-1])
            tries.append(answer)
            self.assertIn(answer.status, (201, 429, 503, 504), answer.bytes)
            self.assertNotIn("Idempotent-Replay", answer.headers)
            if answer.status == 504:
                keys.append(f"{name}-{len(keys)}")
            return answer.status == 201

        self.fleet.wait("the start is taken", is_taken, WAIT_S)
        return tries[-1], keys[-1]

    def test_a_start_that_is_refused_for_now_may_be_sent_again_with_its_key(self):
        self.fleet.wait("the robot is online", self.is_online, WAIT_S)
        start = {"scenario": {**SCENARIO, "name": "again"}}
        scheduler = self.fleet.pid(CLOUD, "scheduler")
        supervisor = self.fleet.nodes[CLOUD].child
        supervisor.send_signal(signal.SIGSTOP)  # so that nothing starts the scheduler again
        self.addCleanup(supervisor.send_signal, signal.SIGCONT)
        os.kill(scheduler, signal.SIGKILL)

        self.fleet.wait("the router has noticed", lambda: self.operator.ask("POST", "/api/v1/runs", start).status == 503, WAIT_S)
        for _ in range(2):
            refused = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key="again-0")
            self.assertEqual((refused.status, "Idempotent-Replay" in refused.headers), (503, False), refused.bytes)
        supervisor.send_signal(signal.SIGCONT)
        taken, key = self.start_taken(start, "again")
        again = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key=key)
        self.assertEqual((again.status, again.json, again.headers["Idempotent-Replay"]), (201, taken.json, "true"))

    def test_a_killed_router_starts_no_run_twice_and_loses_none(self):
        started = []
        for i in range(3):
            start = {"scenario": {**SCENARIO, "name": f"once {i}"}}
            answer, key = self.start_taken(start, f"router-{i}")
            os.kill(self.fleet.pid(CLOUD, "router"), signal.SIGKILL)
            started.append((start["scenario"]["name"], answer.json["run"]))
            again = self.operator.ask("POST", "/api/v1/runs", start, Idempotency_Key=key)
            self.assertEqual((again.status, again.json), (201, answer.json))
            refused = self.tried("POST", "/api/v1/runs", start, Idempotency_Key=f"meanwhile-{i}")
            if refused is not None and refused.status == 201:
                started.append((start["scenario"]["name"], refused.json["run"]))
            self.fleet.wait("the fleet is whole", self.is_online, WAIT_S)
        for _, run in started:
            self.fleet.wait("the run is over", lambda r=run: self.viewer.ask("GET", f"/api/v1/runs/{r}").json.get("state") == "FINISHED", WAIT_S)
        # The archive has a run a minute after its end, the list of open ones until then.
        known = self.viewer.ask("GET", "/api/v1/archive").json["runs"]
        known += [row["content"] for row in self.viewer.ask("GET", "/api/v1/runs").json["items"]]
        for name in {name for name, _ in started}:
            acknowledged = {run for of, run in started if of == name}
            self.assertEqual({one["run"] for one in known if one["name"] == name}, acknowledged)

    def test_a_cut_link_loses_no_run_that_was_acknowledged(self):
        self.fleet.wait("the robot is online", self.is_online, WAIT_S)
        started = self.operator.ask("POST", "/api/v1/runs", {"scenario": {**SCENARIO, "name": "cut"}})
        self.assertEqual(started.status, 201, started.bytes)
        router = self.fleet.pid(ROBOT, "router")
        os.kill(router, signal.SIGSTOP)
        self.addCleanup(os.kill, router, signal.SIGCONT)
        stopped = self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/stop")
        self.assertNotEqual(stopped.json["robots"][0]["state"], "confirmed", "nothing confirms over a link that is cut")
        os.kill(router, signal.SIGCONT)
        self.fleet.wait("the link is back", self.is_online, WAIT_S)
        # In the moment after its stall the router takes what is as old as that for late.
        self.fleet.wait("it is released", lambda: self.operator.ask(
            "POST", f"/api/v1/robots/{ROBOT}/release").json["robots"][0]["state"] == "confirmed", WAIT_S)
        run = started.json["run"]
        self.fleet.wait("the run goes on and ends", lambda: self.viewer.ask("GET", f"/api/v1/runs/{run}").json.get("state") in
                        ("FINISHED", "PAUSED"), WAIT_S)


if __name__ == "__main__":
    own_world.enter()
    support.main()
