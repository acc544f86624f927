"""What each service of a node has counted, read by the command line.

Addresses 127.0.86.x, 127.0.87.x.
"""
import json
import unittest

import support
import trb_fleet
from trb_fleet import CLOUD

ROBOT = "pioneer1"


class Counters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, block=86, udp_port=50086, robots={ROBOT: trb_fleet.ROBOTS[ROBOT]}, speed=100)
        cls.fleet.start()
        cls.fleet.wait_formed()

    def counters(self, service, node):
        answer = self.fleet.json("service", "counters", service, node=node)
        self.assertEqual((answer["node"], answer["service"]), (node, service))
        return {row["name"]: int(row["value"]) for row in answer["values"]}

    def refusal(self, service, node):
        done = self.fleet.trb("service", "counters", service, "--json", node=node, check=False)
        self.assertEqual(done.returncode, 1)
        return json.loads(done.stdout)["error"]

    def test_every_service_of_every_node_answers(self):
        for node in (CLOUD, ROBOT):
            services = self.fleet.services(node)
            self.assertIn("scheduler", services)
            for service in services:
                with self.subTest(node=node, service=service):
                    self.counters(service, node)

    def test_after_a_run_nothing_was_done_or_chosen_twice(self):
        path = support.temporary_folder(self) / "s.json"
        path.write_text(json.dumps({"name": "short", "tasks": [
            {"id": "go", "robot": ROBOT, "skill": "go_to", "data": {"place": "dock"}}]}))
        self.fleet.json("scenario", "run", path, node=CLOUD)
        self.fleet.wait("the run is over", lambda: not self.fleet.json("run", "list", node=CLOUD)["runs"], 100)
        for node in (CLOUD, ROBOT):
            counted = self.counters("scheduler", node)
            self.assertFalse({"double_execution", "double_choice"} & counted.keys())

    def test_what_a_service_refuses_is_counted_and_told(self):
        before = self.counters("resilience", CLOUD).get("refused.alert_decide.unknown_alert", 0)
        self.fleet.trb("alert", "decide", "ffff", "--skip", "--reason", "a test", node=CLOUD, check=False)
        after = self.counters("resilience", CLOUD)
        refused = {name: value for name, value in after.items() if name.startswith("refused.alert_decide.")}
        self.assertEqual(sum(refused.values()), before + 1, after)

    def test_a_service_that_is_not_there(self):
        for service in ("mode-adapter", "scheduler2", "trb", "x" * 64):
            error = self.refusal(service, CLOUD)
            self.assertEqual(error["code"], "no_service", error)
            self.assertIn(f"'{service}'", error["what"])
            self.assertIn("trb service list", error["cure"])


if __name__ == "__main__":
    support.main()
