"""What a node's role lets it send and have signed. Addresses 127.0.114.x and 127.0.116.x."""
import itertools
import os

import zmq

import support
import trb_fleet
import wire
from certified import WAIT, Life
from router_client import Member


class Rights(Life):
    block = 114

    def robot_node(self):
        """ur3's node, and a probe on its bus that is this file's own: ask(subtype, body, type) returns the answer."""
        fleet = support.make_fleet(self, block=116, udp_port=50116, cloud=False,
                                   robots={"ur3": trb_fleet.ROBOTS["ur3"]})
        fleet.start_node("ur3")
        fleet.nodes["ur3"].wait_line("ready", 60)
        bus = self.context.socket(zmq.DEALER)
        self.addCleanup(bus.close, 0)
        bus.connect(f"ipc://{fleet.dir('ur3')}/bus/probe.ipc")
        hello = wire.Frame("service_hello", "", "", type=wire.COMMAND, id=1,
                           data=wire.pack(["scheduler", [], 1, os.getpid(), "independent"]))
        bus.send(hello.encode())
        self.assertTrue(bus.poll(WAIT * 1000))
        slot = wire.decode(bus.recv()).body()[2]
        ids = itertools.count((slot << 48) + 1)

        def ask(subtype, body, kind):
            frame = wire.Frame(subtype, "ur3", "ur3", type=kind, id=next(ids), data=wire.pack(body))
            bus.send(frame.encode())
            self.assertTrue(bus.poll(WAIT * 1000))
            answer = wire.decode(bus.recv())
            self.assertEqual(answer.reply_to, frame.id)
            return answer

        return support.Watch(fleet, "ur3"), ask

    def assert_not_permitted(self, answer):
        refusal = wire.nack(answer)
        self.assertEqual(refusal["code"], "not_permitted")
        self.assertIn("trb help rights", refusal["cure"])

    def test_a_robot_s_node_signs_no_decision(self):
        watch, ask = self.robot_node()
        for count, purpose in enumerate(("decision", "result", "certificate", "revocation_list", "seal"), 1):
            self.assert_not_permitted(ask("sign_request", [purpose, b"x"], wire.REQUEST))
            watch.wait_counted("refused.not_permitted", count)
            watch.wait_logged(f"of a robot node may not have a '{purpose}' signed")

    def test_a_probe_that_calls_itself_the_scheduler(self):
        """It cannot command a skill past the control lease, nor send the router's own subtypes."""
        watch, ask = self.robot_node()
        for count, subtype in enumerate(("execute", "cancel_execution", "adapter_state_request", "peer_expired", "hello"), 1):
            self.assert_not_permitted(ask(subtype, [], wire.COMMAND))
            watch.wait_counted("refused.not_permitted", count)
            watch.wait_logged(f"service 'scheduler' (pid {os.getpid()}) said {subtype}, which is not its word")
        self.assertEqual(ask("route_list", [], wire.REQUEST).subtype, "route_table")

    def test_a_role_without_the_right(self):
        """robot_fault is a robot's; the same member may send it once its certificate has that role."""
        key, dog = self.authority(), Member(self.fleet, "dog")
        client = self.linked(dog)
        self.send(client, "robot_fault", "dog", data=wire.pack([]))
        self.watch.wait_counted("refused.not_permitted")
        self.watch.wait_logged("not_permitted dog sent robot_fault, which a cloud node may not send")
        self.assert_alive(client, dog)
        robot = self.client(dog)
        self.hello(robot, dog, key.certificate(dog.certificate, serial=60, role=0))
        self.assertEqual(robot.receive().subtype, "hello")
        self.send(robot, "robot_fault", "dog", data=wire.pack([]))
        self.assert_alive(robot, dog)
        self.assertEqual(self.watch.rise(), {"refused.not_permitted": 1})

if __name__ == "__main__":
    support.main()
