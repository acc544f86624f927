"""A fleet with the gateway on its cloud node, and an admin, an operator and a viewer who are signed in: what the gateway's
tests share."""
import os
import pathlib
import signal
import sys
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import gateway_client  # noqa: E402
import gateway_contract  # noqa: E402

ROBOT = "pioneer1"
SCENARIO = {"name": "short", "tasks": [{"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}]}
GOOD = "a good long password"
ADMIN = "another good long password"
WAIT_S = 60  # where no figure applies: a deadline, not a measurement


class GatewayCase(unittest.TestCase):
    block, udp_port = 0, 0  # each test file has its own
    fleet_kind = trb_fleet.Fleet
    robots = (ROBOT,)
    kinds = trb_fleet.ROBOTS  # what each of them is
    robot = ROBOT  # that is waited for
    speed = 20
    contract = gateway_contract.Contract()

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, cls.fleet_kind, block=cls.block, udp_port=cls.udp_port,
                                       robots={name: cls.kinds[name] for name in cls.robots}, speed=cls.speed,
                                       gateway_port=trb_fleet.free_port())
        cls.port = cls.fleet.gateway_port
        cls.fleet.start()
        cls.fleet.wait_formed()
        cls.certificate = cls.fleet.dir(CLOUD) / "keys/gateway.crt"
        cls.fleet.wait("the gateway is ready", cls.is_ready, WAIT_S)
        made = cls.fleet.json("cloud", "password", cls.fleet.dir(CLOUD))
        cls.secrets = [made["password"]]
        cls.admin = cls.client()
        assert cls.admin.sign_in("admin", made["password"]).status == 201
        changed = cls.admin.ask("PUT", "/api/v1/me/password", {"old": made["password"], "new": ADMIN})
        assert changed.status == 204, changed.bytes
        assert cls.admin.sign_in("admin", ADMIN).status == 201
        cls.fleet.wait("the robot is shown online", cls.is_online, WAIT_S)
        for name, role in (("vic", "viewer"), ("olga", "operator")):
            answer = cls.admin.ask("POST", "/api/v1/users", {"name": name, "role": role, "password": GOOD})
            assert answer.status == 201, answer.bytes
        cls.viewer, cls.operator = cls.client(), cls.client()
        assert cls.viewer.sign_in("vic", GOOD).status == 201
        assert cls.operator.sign_in("olga", GOOD).status == 201

    @classmethod
    def client(cls, token=None):
        return gateway_client.Client(cls.port, cls.certificate, token, cls.contract)

    @classmethod
    def is_online(cls):
        answer = cls.admin.ask("GET", f"/api/v1/robots/{cls.robot}")
        # A row that is not live has what was heard last: ONLINE, long after its node fell silent.
        return answer.status == 200 and answer.json["live"] == "live" and answer.json["content"]["connection"] == "ONLINE"

    @classmethod
    def is_ready(cls):
        try:
            return cls.client().ask("GET", "/api/v1/ready").status == 200
        except (OSError, FileNotFoundError):
            return False

    def kill_gateway(self):
        pid = self.fleet.pid(CLOUD, "cloud-gateway")
        os.kill(pid, signal.SIGKILL)
        self.fleet.wait("another gateway", lambda: self.fleet.pid(CLOUD, "cloud-gateway") not in (None, pid) and
                        self.is_ready(), WAIT_S)

    def post(self, path, body=None, client=None, good=lambda answer: answer.status < 429, **more):
        """As ask(): again, until the answer is good. A router or a robot's node that stalls is 429, 503 or 504."""
        answers = []

        def is_good():
            answers.append((client or self.operator).ask("POST", path, body, **more))
            return good(answers[-1])
        self.fleet.wait(path, is_good, WAIT_S)
        return answers[-1]

    def wait_service(self, name):
        """The cloud's, up: one that a stalled machine has kept silent for 3 s is not."""
        self.fleet.wait(f"{name} is up", lambda: (name, "up") in [(one["service"], one["state"]) for one in self.admin.ask(
            "GET", "/api/v1/services").json.get("services", [])], WAIT_S)

    def order(self, word, body=None, path=f"/api/v1/robots/{ROBOT}/", **more):
        """A stop or a release that the robot has confirmed: the gateway waits 3 s for that, a machine may stall for longer."""
        return self.post(path + word, body, good=lambda answer: answer.status == 200 and
                         answer.json["robots"][0]["state"] == "confirmed", **more)

    def assert_problem(self, answer, status, code=None):
        self.assertEqual(answer.status, status, answer.bytes)
        self.assertEqual(answer.headers["Content-Type"], "application/problem+json")
        self.assertTrue(answer.json["errors"][0]["hint"], answer.bytes)
        if code:
            self.assertTrue(answer.json["type"].endswith(code), answer.bytes)
