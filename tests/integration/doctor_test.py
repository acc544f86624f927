"""trb doctor on real nodes: each cause is made, named, and gone from the report once it is repaired."""
import json
import pathlib
import shutil
import tempfile
import time
import unittest

import support
import trb_fleet
import wire
from router_client import Client, Member, make_context

BLOCK = 44
UDP_PORT = 50044
HOUR_NS = 3_600_000_000_000
OF_THE_MACHINE = {"clock_not_set", "disk_low", "few_inodes"}  # that runs the test


class Doctor(unittest.TestCase):
    """Nodes without beacons, so that each meets only those that a test names as its seeds."""

    @classmethod
    def setUpClass(cls):
        make_context(cls)
        names = ("ant", "bee", "cat", "short", "last", "twin")
        cls.fleet = support.make_fleet(cls, support.RouterFleet, services={name: ["router"] for name in names},
                                       block=BLOCK, udp_port=UDP_PORT)
        cls.set_node("ant", beacon=False, seeds=[cls.seed("bee")])
        cls.set_node("bee", beacon=False)
        cls.fleet.bring_up("ant", "bee")

    @classmethod
    def set_node(cls, node, fleet=None, **keys):
        path = (fleet or cls.fleet).dir(node) / "node.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), **keys}))

    @classmethod
    def seed(cls, node, fleet=None, address=None, key=None):
        fleet = fleet or cls.fleet
        key = key or fleet.json("fleet", "show", fleet.dir(node))["link_key"]
        return {"address": address or f"{fleet.address(node)}:45000", "key": key}

    def reload_with_seeds(self, *seeds):
        """ant, started again with these seeds and bee's."""
        self.set_node("ant", seeds=[self.seed("bee"), *seeds])
        self.fleet.trb("reload", self.fleet.dir("ant"))
        self.addCleanup(self.set_node, "ant", seeds=[self.seed("bee")])

    def examine(self, *peer, node="ant", fleet=None):
        done = (fleet or self.fleet).trb("doctor", *peer, "--json", node=node, check=False, timeout=30)
        report = json.loads(done.stdout)
        self.assertEqual(done.returncode, 0 if report["well"] else 1)
        return [row for row in report["findings"] if row["cause"] not in OF_THE_MACHINE]

    def find(self, cause, subject, *peer, severity="problem", timeout=60, **more):
        """Runs the doctor until it names it; the cure is never empty."""
        seen = []

        def named():
            seen[:] = self.examine(*peer, **more)
            return any((row["cause"], row["subject"], row["severity"]) == (cause, subject, severity) for row in seen)
        try:
            self.fleet.wait(f"{cause} of {subject}", named, timeout)
        except TimeoutError:
            self.fail(f"no {severity} {cause} of {subject}: {json.dumps(seen, indent=1)}")
        row = next(row for row in seen if (row["cause"], row["subject"]) == (cause, subject))
        self.assertTrue(row["what"] and row["cure"], row)
        return row

    def member(self, name, **tail):
        """A member that this file plays, linked with ant; `tail` is told in its Hello."""
        member = Member(self.fleet, name)
        client = Client(self.context, self.fleet.address("ant"), server_key=Member(self.fleet, "ant").public,
                        keys=(member.public, member.secret))
        self.addCleanup(client.close)
        body = [member.certificate, next(Client.boots), f"127.0.{BLOCK}.99:45000", tail.get("version", "independent"),
                tail.get("utc", time.time_ns())]
        client.send("hello", name, "ant", data=wire.pack(body))
        self.assertEqual(client.receive().subtype, "hello")
        return client


class OfTheNode(Doctor):
    def test_all_is_well_and_said_so(self):
        self.fleet.wait("ant is well", lambda: not self.examine(), 60)
        logs = [self.fleet.dir(node) / "log/router.log" for node in ("ant", "bee")]
        before = [log.read_text().count("no_zmtp") for log in logs]
        done = []  # again, if a stalled machine was late with an echo
        self.fleet.wait("it is told so", lambda: done.append(self.fleet.trb("doctor", node="ant", check=False)) or
                        done[-1].returncode == 0, 60)
        self.assertIn("no problem found", done[-1].stdout)
        self.assertIn("linked with 1 node", done[-1].stdout)
        # Where one looks for intruders there is nothing of it.
        self.assertEqual([log.read_text().count("no_zmtp") for log in logs], before)

    def test_the_router_is_not_running(self):
        row = self.find("router_down", "cat", node="cat")
        self.assertIn("trb up", row["cure"])

    def test_a_socket_of_the_bus_is_gone(self):
        path = self.fleet.dir("bee") / "bus" / "probe.ipc"
        path.unlink()
        self.find("bus_socket_missing", "bus/probe.ipc", node="bee")
        self.fleet.nodes.pop("bee").stop()
        self.fleet.bring_up("bee")
        self.fleet.wait("it is there again", lambda: [row["cause"] for row in self.examine(node="bee")] == ["no_way"], 60)

    def test_neither_beacons_nor_seeds(self):
        self.find("no_way", "node.json", severity="note", node="bee")
        self.set_node("bee", seeds=[self.seed("ant")])
        self.addCleanup(self.set_node, "bee", seeds=[])
        self.fleet.wait("bee is well", lambda: not self.examine(node="bee"), 60)

    def test_a_certificate_that_ends_soon_and_one_that_has_ended(self):
        folder = self.fleet.dir("short")
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), folder / "keys/request.json", "--days", "12")
        self.find("cert_ends_soon", "short", node="short", severity="note")
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), folder / "keys/request.json", "--days", "0.00001")
        self.find("cert_expired", "short", node="short")

    def test_the_robot_does_not_answer(self):
        with tempfile.TemporaryDirectory(prefix="trb-") as root:
            support.hold_blocks(BLOCK + 1, BLOCK + 2)
            fleet = trb_fleet.Fleet(pathlib.Path(root) / "fleet", support.PROGRAMS, block=BLOCK + 1, udp_port=UDP_PORT + 1,
                                    robots={"ur3": trb_fleet.ROBOTS["ur3"]}, cloud=False)
            with fleet:
                fleet.make()
                fleet.start_node("ur3")
                fleet.nodes["ur3"].wait_line("ready", 60)
                row = self.find("robot_silent", "ur3", node="ur3", fleet=fleet)
                self.assertIn(f"nothing listens at {fleet.robot_address('ur3')}:30002", row["cure"])
                fleet.start_robot("ur3")
                fleet.wait("the robot is there", lambda: not any(r["cause"] == "robot_silent" for r in self.examine(
                    node="ur3", fleet=fleet)), 60)
                fleet.nodes.pop("ur3").stop()
                folder = fleet.dir("ur3")
                node = json.loads((folder / "node.json").read_text())
                (folder / "node.json").write_text(json.dumps({**node, "services": ["router", "scheduler"]}))
                notes = json.loads(fleet.trb("check", folder, "--json").stdout)["notes"]
                self.assertTrue(any('no "mode-adapter": nothing talks to the robot' in note for note in notes), notes)
                fleet.start_node("ur3")
                fleet.nodes["ur3"].wait_line("ready", 60)
                self.assertIn("mode-adapter", self.find("service_down", "mode-adapter", node="ur3", fleet=fleet)["cure"])


class OfPeers(Doctor):
    def test_a_wrong_key_in_a_seed(self):
        address = f"{self.fleet.address('bee')}:45000"
        self.set_node("ant", seeds=[self.seed("bee", key="ab" * 32)])
        self.addCleanup(self.set_node, "ant", seeds=[self.seed("bee")])
        self.fleet.nodes.pop("ant").stop()
        (self.fleet.dir("ant") / "state" / "peers").unlink(missing_ok=True)  # else it would know bee without a seed
        self.fleet.bring_up("ant")
        row = self.find("wrong_key", address)
        self.assertIn("trb fleet show", row["cure"])
        self.set_node("ant", seeds=[self.seed("bee")])
        self.fleet.trb("reload", self.fleet.dir("ant"))
        self.fleet.wait("ant is well", lambda: not self.examine(), 60)

    def test_a_closed_port(self):
        address = f"127.0.{BLOCK}.77:45000"
        self.reload_with_seeds(self.seed("cat", address=address))
        row = self.find("port_closed", address)
        self.assertIn("TCP_PORT_EXT", row["cure"])

    def test_another_fleet(self):
        foreign = support.make_fleet(self, support.RouterFleet, services={"intruder": ["router"]}, block=BLOCK + 1,
                                     udp_port=UDP_PORT, name="other")
        self.set_node("intruder", fleet=foreign, beacon=False)
        foreign.bring_up("intruder")
        seed = self.seed("intruder", fleet=foreign)
        self.reload_with_seeds(seed)
        self.find("foreign_fleet", seed["address"])

    def test_a_peer_whose_certificate_ends_while_it_is_linked(self):
        folder = self.fleet.dir("short")
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), folder / "keys/request.json", "--days",
                       str(20 / 86400))  # it has to be linked by then
        self.set_node("short", beacon=False, seeds=[self.seed("ant")])
        self.fleet.start_node("short")
        self.addCleanup(lambda: self.fleet.nodes.pop("short").stop())
        self.fleet.wait("short is linked", lambda: any(
            row["id"] == "short" and row["state"] == "ONLINE"
            for row in self.fleet.json("route", "list", node="ant")["routes"]), 60)
        self.find("cert_expired", "short", "short")

    def test_a_revoked_node(self):
        """Named by those that stay, with or without its name, and by itself."""
        self.set_node("last", beacon=False, seeds=[self.seed("ant")])
        self.fleet.bring_up("last")
        self.addCleanup(lambda: self.fleet.nodes.pop("last").stop())
        self.fleet.wait("last is linked", lambda: not self.examine(node="last"), 60)
        self.fleet.trb("fleet", "revoke", self.fleet.authority_dir(), "last", "--reason", "stolen", "--via",
                       self.fleet.dir("ant"))
        for words in ((), ("last",)):
            row = self.find("cert_revoked", "last", *words)
            self.assertIn("stolen", row["what"])
        row = self.find("cert_revoked", "last", node="last")
        self.assertEqual(row["what"], "this node's certificate is revoked: stolen")
        self.assertIn("trb fleet request", row["cure"])

    def test_a_copy_of_a_running_node(self):
        """Named by the node that the copy has taken, and by the one that is kept out."""
        self.set_node("twin", beacon=False, seeds=[self.seed("ant")])
        self.fleet.bring_up("twin")
        self.addCleanup(lambda: self.fleet.nodes.pop("twin").stop())
        self.fleet.wait("twin is linked", lambda: not self.examine(node="twin"), 60)
        copy = self.fleet.root / "twin-copy"
        shutil.copytree(self.fleet.dir("twin"), copy, ignore=shutil.ignore_patterns("bus", "log"))
        network = json.loads((copy / "network.json").read_text())
        (copy / "network.json").write_text(json.dumps({**network, "HOST_INT": f"127.0.{BLOCK}.98"}))
        log = self.fleet.root / "up-twin-copy.log"
        thief = trb_fleet.Process([self.fleet.programs / "trb", "up", copy, "--die-with-parent"], log)
        self.addCleanup(thief.stop)
        row = self.find("shared_keys", "twin")
        for address in (f"127.0.{BLOCK}.98:45000", f"{self.fleet.address('twin')}:45000"):
            self.assertIn(address, row["what"])
        self.assertIn("trb fleet revoke", row["cure"])
        self.assertEqual([one for one in self.examine() if one["cause"] == "old_start"], [])
        self.assertIn("linked at ant", self.find("shared_keys", "twin", node="twin")["what"])
        thief.stop()
        self.fleet.wait("twin is back", lambda: "ONLINE" in [row["state"] for row in self.fleet.json(
            "route", "list", node="ant")["routes"] if row["id"] == "twin"], 60)
        self.assertIn("twin", self.find("shared_keys", "twin")["what"])

    def test_a_clock_that_is_an_hour_off(self):
        self.member("cat", utc=time.time_ns() - HOUR_NS)
        row = self.find("clock_off", "cat", severity="note")
        self.assertIn("-3600 s", row["what"])

    def test_versions_apart(self):
        self.member("cat", version="0.0.1")
        row = self.find("versions_apart", "cat", severity="note")
        self.assertIn("0.0.1", row["what"])

    def test_another_subnet_without_a_seed(self):
        row = self.find("other_subnet", "198.51.100.7:45000", "198.51.100.7:45000")
        self.assertIn('{"address":"198.51.100.7:45000"', row["cure"])

    def test_a_peer_that_was_never_heard_of(self):
        self.find("never_heard", "nobody", "nobody")


if __name__ == "__main__":
    support.main()
