"""A fleet of three nodes and two members that a test plays, each with its certificate."""
import itertools
import time
import unittest

import zmq

import authority
import support
import wire
from router_client import Client, Member

WAIT = 20  # a deadline, not a measurement: for a starved machine
TARGET = "ant"
NODES = ("ant", "bee", "cat")
SPARE = ("dog", "elk")  # have keys and certificates, but do not run: the test plays them


class Life(unittest.TestCase):
    """A fleet of three that are up, new for each test: what a revocation does cannot be undone. `block`: of addresses, the
    class's own."""

    def setUp(self):
        self.boots = itertools.count(time.time_ns() // 1_000_000_000)  # a member's next link is of its next start
        self.context = zmq.Context()
        self.addCleanup(self.context.term)
        services = {node: ["router"] for node in NODES + SPARE}
        self.fleet = support.make_fleet(self, support.RouterFleet, services=services, block=self.block,
                                        udp_port=50000 + self.block)
        self.fleet.bring_up(*NODES)
        self.fleet.wait("the three are linked", lambda: all(self.online(n) == set(NODES) - {n} for n in NODES), 60)
        self.pids = {node: self.fleet.pid(node, "router") for node in NODES}
        self.watches = {node: support.Watch(self.fleet, node) for node in NODES}
        self.watch = self.watches[TARGET]

    def routes(self, node=TARGET):
        return {row["id"]: row for row in self.fleet.json("route", "list", node=node)["routes"]}

    def online(self, node=TARGET):
        return {name for name, row in self.routes(node).items() if row["state"] == "ONLINE"}

    def authority(self):
        return authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())

    def assert_same_processes(self):
        self.assertEqual({node: self.fleet.pid(node, "router") for node in NODES}, self.pids)

    def client(self, member=None, node=TARGET, keys=None):
        server = Member(self.fleet, node).public
        if member is not None:
            keys = (member.public, member.secret)
        client = Client(self.context, self.fleet.address(node), server_key=server, keys=keys)
        self.addCleanup(client.close)
        return client

    def send(self, client, subtype, source, **more):
        return client.send(subtype, source, target=TARGET, **more)

    def hello(self, client, member, certificate=None, boot=None):
        boot = boot or next(self.boots)
        self.send(client, "hello", member.id,
                  data=wire.hello(certificate or member.certificate, boot, f"127.0.{self.block}.99:45000"))

    def linked(self, member):
        client = self.client(member)
        self.hello(client, member)
        self.assertEqual(client.receive().subtype, "hello")
        return client

    def assert_alive(self, client, member):
        ident = self.send(client, "route_list", member.id, type=wire.REQUEST, data=wire.pack([]))
        self.assertEqual(client.answer_to(ident).subtype, "route_table")
