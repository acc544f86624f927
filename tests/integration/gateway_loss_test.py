"""Nothing that the gateway has acknowledged is lost: not by a full disk, a killed router, a cut link.

Addresses 127.0.222.x, 127.0.223.x, in a network of the test's own.
"""
import http.client
import os
import signal
import time

import own_world
import support
import trb_fleet
from gateway_case import CLOUD, GOOD, ROBOT, SCENARIO, WAIT_S, GatewayCase

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

    def stop(self, client=None):
        return (client or self.operator).ask("POST", f"/api/v1/robots/{ROBOT}/stop")

    def records(self):
        return self.admin.ask("GET", "/api/v1/audit?limit=1000").json["records"]

    def note(self):
        return self.fleet.services(CLOUD)["cloud-gateway"]["note"]

    def fill_to_the_last_record(self):
        """Also what is free within the database's files: until nothing is taken for some of the gateway's own tries."""
        refused = 0
        end = time.monotonic() + WAIT_S
        while refused < 4 and time.monotonic() < end:
            self.fleet.disk.fill()
            taken = [size for size in (60_000, 10_000, 1_000, 1) if self.operator.ask(
                "POST", SCENARIOS, {"name": f"full {size}", "tasks": [], "notes": "x" * size}).status == 201]
            refused = 0 if taken else refused + 1
            time.sleep(1.2 if not taken else 0)  # it tries each second
        self.assertEqual(refused, 4, "the disk was not full")

    def check_goes_on_without_room(self, client):
        """Robots are stopped, each time; who may stop them signs in; all can be read; all else is refused."""
        for _ in range(2):
            stopped = self.stop(client)
            self.assertEqual((stopped.status, stopped.headers["Audit-Record"]), (200, "owed"), stopped.bytes)
            self.assertEqual(stopped.json["robots"][0]["state"], "confirmed", stopped.bytes)
        late = self.client()
        signed = late.sign_in("olga", GOOD)
        self.assertEqual((signed.status, signed.headers["Audit-Record"]), (201, "owed"), signed.bytes)
        self.assertEqual(self.stop(late).headers["Audit-Record"], "owed")
        self.assertEqual(late.sign_in("olga", "a wrong long password").status, 401)
        for refused in (late.ask("POST", SCENARIOS, {"name": "no room", "tasks": []}),
                        late.ask("POST", f"/api/v1/robots/{ROBOT}/release"),
                        late.ask("POST", "/api/v1/runs", {"scenario": SCENARIO}, Idempotency_Key="no-room"),
                        self.client().ask("GET", "/api/v1/ready")):
            self.assert_problem(refused, 503, "disk_full")
        for path in f"/api/v1/robots/{ROBOT}", SCENARIOS, "/api/v1/runs", "/metrics":
            self.assertEqual(late.ask("GET", path).status, 200)
        self.fleet.wait("the service has a note of it", lambda: "nothing can be put on record" in self.note(), WAIT_S)
        return late

    def test_on_a_full_disk_the_page_and_its_stop_stay_also_after_a_kill(self):
        disk = self.fleet.disk
        self.addCleanup(disk.room)
        self.fleet.wait("the robot is online", self.is_online, WAIT_S)
        before = self.records()
        pid = self.fleet.pid(CLOUD, "cloud-gateway")
        disk.fill()
        self.fill_to_the_last_record()
        late = self.check_goes_on_without_room(self.operator)
        self.assertEqual(self.fleet.pid(CLOUD, "cloud-gateway"), pid)
        # Who has signed in meanwhile has to do so again after a kill; who was signed in before has not.
        os.kill(pid, signal.SIGKILL)
        self.fleet.wait("it is there again", lambda: self.tried("GET", "/api/v1/health") is not None, WAIT_S)
        self.assertEqual(late.ask("GET", "/api/v1/me").status, 401)
        self.fleet.wait("the robot is online", self.is_online, WAIT_S)
        self.check_goes_on_without_room(self.operator)
        disk.room()
        self.fleet.wait("it goes on by itself", lambda: self.is_ready() and not self.note(), WAIT_S)
        after = self.records()
        new = [one["action"] for one in after[:len(after) - len(before)]]
        self.assertEqual([one["number"] for one in after], list(range(len(after), 0, -1)))
        # Of this process alone: each stop has a begin and an end. What the killed one owed is in its log.
        self.assertGreaterEqual(new.count("POST /api/v1/robots/{robot}/stop"), 6, new)
        self.assertIn("POST /api/v1/session", new)
        self.assertEqual(self.operator.ask("POST", f"/api/v1/robots/{ROBOT}/release").status, 200)
        self.assertEqual(self.operator.ask("POST", SCENARIOS, {"name": "room", "tasks": []}).status, 201)

    def with_history(self, change):
        """The gateway is killed, and started again once its history is another one."""
        supervisor = self.fleet.nodes[CLOUD].child
        supervisor.send_signal(signal.SIGSTOP)
        try:
            os.kill(self.fleet.pid(CLOUD, "cloud-gateway"), signal.SIGKILL)
            for name in "history.db", "history.db-wal", "history.db-shm":
                (self.fleet.dir(CLOUD) / "state" / name).unlink(missing_ok=True)
            change(self.fleet.dir(CLOUD) / "state" / "history.db")
        finally:
            supervisor.send_signal(signal.SIGCONT)
        self.fleet.wait("the gateway is there again", self.is_ready, WAIT_S)

    def test_a_history_that_cannot_be_kept_is_a_note_and_no_fault_of_who_asks(self):
        path = f"/api/v1/robots/{ROBOT}/history"
        self.with_history(lambda file: file.write_bytes(b"x" * 8192))
        self.fleet.wait("it is noted", lambda: "the history cannot be kept" in self.note(), WAIT_S)
        self.assertIn("move it away", self.note())
        self.assert_problem(self.viewer.ask("GET", path), 503, "no_history")
        self.assertIn("service_note", self.fleet.trb("doctor", node=CLOUD, check=False).stdout)
        (self.fleet.dir(CLOUD) / "state" / "history.db").unlink()
        self.fleet.wait("it goes on by itself", lambda: not self.note(), WAIT_S)
        self.assertEqual(self.viewer.ask("GET", path).status, 200)

    @staticmethod
    def start_of(name):
        return {"scenario": {**SCENARIO, "name": name}}

    def start_taken(self, name):
        """The answer to a start that is sent with one key until a router takes it, and that key, which is its name, too. What a
        router refuses (429, 503) was not done, and frees the key; of a time-out nobody knows, and its answer stays."""
        tries, keys = [], [f"{name}-0"]

        def is_taken():
            answer = self.operator.ask("POST", "/api/v1/runs", self.start_of(keys[-1]), Idempotency_Key=keys[-1])
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
        start = self.start_of("again-0")
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
        taken, key = self.start_taken("again")
        again = self.operator.ask("POST", "/api/v1/runs", self.start_of(key), Idempotency_Key=key)
        self.assertEqual((again.status, again.json, again.headers["Idempotent-Replay"]), (201, taken.json, "true"))

    def test_a_killed_router_starts_no_run_twice_and_loses_none(self):
        started = []
        for i in range(3):
            answer, key = self.start_taken(f"router-{i}")
            os.kill(self.fleet.pid(CLOUD, "router"), signal.SIGKILL)
            started.append((key, answer.json["run"]))
            again = self.operator.ask("POST", "/api/v1/runs", self.start_of(key), Idempotency_Key=key)
            self.assertEqual((again.status, again.json), (201, answer.json))
            key = f"meanwhile-{i}"
            refused = self.tried("POST", "/api/v1/runs", self.start_of(key), Idempotency_Key=key)
            if refused is not None and refused.status == 201:
                started.append((key, refused.json["run"]))
            self.fleet.wait("the fleet is whole", self.is_online, WAIT_S)
        for _, run in started:
            self.fleet.wait("the run is over", lambda r=run: self.viewer.ask("GET", f"/api/v1/runs/{r}").json.get("state") == "FINISHED", WAIT_S)
        # The archive has a run a minute after its end, the list of open ones until then: of a router's last start after some seconds.
        def known():
            return self.viewer.ask("GET", "/api/v1/archive").json["runs"] + [
                row["content"] for row in self.viewer.ask("GET", "/api/v1/runs").json["items"]
            ]

        acknowledged = set(run for _, run in started)
        self.fleet.wait("the runs are known", lambda: acknowledged <= {one["run"] for one in known()}, WAIT_S)
        names = {name for name, _ in started}
        self.assertEqual({one["run"] for one in known() if one["name"] in names}, acknowledged)

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
        self.order("release")
        run = started.json["run"]
        self.fleet.wait("the run goes on and ends", lambda: self.viewer.ask("GET", f"/api/v1/runs/{run}").json.get("state") in
                        ("FINISHED", "PAUSED"), WAIT_S)


if __name__ == "__main__":
    own_world.enter()
    support.main()
