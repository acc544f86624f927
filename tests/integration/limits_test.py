"""What a router may cost at most: descriptors, processor, rows. The strangers here have more means than others: the
fleet's own key for beacons, as a node that was put out of it has, or a limit of open files that is set too low.
"""
import ctypes
import ctypes.util
import json
import os
import resource
import select
import socket
import subprocess
import time
import unittest

import support
import trb_fleet
import wire
from pressure import PORT, UDP_PORT, Pressure, sources
from router_client import Member

SODIUM = ctypes.CDLL(ctypes.util.find_library("sodium"))
FEW = 400


class BeaconKey:
    """The fleet's key for beacons, from a member's folder."""

    def __init__(self, fleet, node):
        keys = fleet.dir(node) / "keys"
        self.file = json.loads((keys / "certificate.json").read_text())
        secret = bytes.fromhex((keys / "link.key").read_text().strip())
        public = ctypes.create_string_buffer(32)
        SODIUM.crypto_scalarmult_base(public, secret)
        box = bytes.fromhex(self.file["sealed_beacon_key"])
        key = ctypes.create_string_buffer(32)
        if SODIUM.crypto_box_seal_open(key, box, ctypes.c_ulonglong(len(box)), public, secret) != 0:
            raise ValueError("the key does not open")
        self.secret = key.raw
        self.number = int(self.file["beacon_key_number"])

    def seal(self, fleet_id, plain):
        nonce = os.urandom(24)
        box = ctypes.create_string_buffer(len(plain) + 16)
        SODIUM.crypto_secretbox_easy(box, plain, ctypes.c_ulonglong(len(plain)), nonce, self.secret)
        return b"TRBB" + self.number.to_bytes(4, "big") + fleet_id[:4] + nonce + box.raw


CHECKS_TYPES = b"__ubsan_handle_dynamic_type_cache_miss" in (support.PROGRAMS / "trb-router").read_bytes()


class Limits(Pressure):
    def test_10_000_beacons_of_made_up_nodes(self):
        """The fleet's key opens them; their certificates are not signed by the authority."""
        key = BeaconKey(self.fleet, "belt")
        kind, signer, payload, _ = self.belt.certificate
        fleet_id = wire.unpack(payload)[0][0]
        known = self.rows()
        plain = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(plain.close)
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

        def shout(stopped):
            for number in range(10_000):
                name = f"m{number:03x}"[-4:]  # as long as "belt"
                made_up = [kind, signer, payload.replace(b"belt", name.encode()), os.urandom(64)]
                body = wire.pack([made_up, "127.0.139.1:45000", 1, time.time_ns(), number + 1])
                record = wire.pack(["beacon", name, body, os.urandom(64)])
                plain.sendto(key.seal(fleet_id, record), ("127.255.255.255", UDP_PORT))
                if number % 20 == 19:
                    stopped.wait(0.004)

        self.under("10,000 beacons", shout)
        risen = self.watch.rise(("beacon.",))
        self.assertLessEqual(set(risen), {"beacon.bad_signature", "beacon.too_many"})
        self.assertGreater(risen["beacon.bad_signature"], 500)
        self.assertGreater(risen["beacon.too_many"], 500)
        self.watch.wait_logged("beacon_refused bad_signature")
        self.assertEqual(self.rows(), known)

    def test_what_is_kept_out_costs_nothing(self):
        """The kernel drops what a blocked source sends, before the router notices."""
        def knock(seconds):
            end = time.monotonic() + seconds
            held = []
            while time.monotonic() < end:
                held.append(self.plain("127.0.138.2"))
                if len(held) > 200:
                    held.pop(0).close()
            for one in held:
                one.close()

        knock(0.5)
        self.watch.wait_counted("refused.source_blocked")
        before, began = self.processor_s(), time.monotonic()
        knock(3)
        share = (self.processor_s() - before) / (time.monotonic() - began)
        print(f"a blocked source that knocks on: processor {share:.3f}", end=" ")
        self.assertLess(share, 0.2)

    # ---- a limit of open files that is set too low

    def start_router(self, node, most):
        """The router of a node, alone, with a limit of open files."""
        def few():
            trb_fleet.end_with_parent()
            resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))

        child = subprocess.Popen([support.PROGRAMS / "trb-router", self.fleet.dir(node)], stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, text=True, preexec_fn=few)
        self.addCleanup(child.stderr.close)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        return child

    def comes_in_at(self, node):
        client = self.client(self.fleet.address(node), server_key=Member(self.fleet, node).public,
                             keys=(self.crane.public, self.crane.secret))
        client.send("hello", "crane", node, data=wire.hello(self.crane.certificate, int(time.time()), ""))
        try:
            return client.receive(timeout=0.5).subtype == "hello"
        except TimeoutError:
            return False

    def log(self, node):
        path = self.fleet.dir(node) / "log" / "router.log"
        return path.read_text() if path.exists() else ""

    def test_too_few_descriptors_to_start(self):
        child = self.start_router("belt", 200)
        self.assertEqual(child.wait(60), 1)
        words = child.stderr.read()
        self.assertIn("at most 200 open files are allowed, at least 256 are needed", words)
        self.assertIn("LimitNOFILE=", words)

    def test_few_descriptors(self):
        """Strangers get fewer of them, so that some are left for the fleet."""
        child = self.start_router("belt", FEW)
        self.fleet.wait("a member comes in", lambda: self.comes_in_at("belt"), 60)
        self.assertIn(f"few_descriptors at most {FEW} open files: strangers get 68 of them", self.log("belt"))
        held = []
        for source in sources(60):
            for _ in range(10):
                one = socket.socket()
                self.addCleanup(one.close)
                one.setblocking(False)
                one.bind((source, 0))
                one.connect_ex((self.fleet.address("belt"), PORT))
                held.append(one)
        most, begin = 0, time.monotonic()
        while time.monotonic() < begin + (20 if most <= 68 else 3):
            most = max(most, len(os.listdir(f"/proc/{child.pid}/fd")))
            select.select([], [], [], 0.01)
        self.assertGreater(most, 68)
        self.assertLess(most, FEW - 100)
        for one in held:
            one.close()
        self.fleet.wait("a member comes in again", lambda: self.comes_in_at("belt"), 60)
        self.assertNotIn("no_descriptor", self.log("belt"))
        self.assertIsNone(child.poll())

    @unittest.skipIf(CHECKS_TYPES, "UBSan's check of an exception's type needs a pipe, and here no descriptor is left for it")
    def test_more_seeds_than_descriptors(self):
        """Each is a port that accepts the connection and stays silent."""
        deaf = socket.create_server(("0.0.0.0", 0), backlog=500)
        self.addCleanup(deaf.close)
        port = deaf.getsockname()[1]
        path = self.fleet.dir("belt") / "node.json"
        before = path.read_text()
        self.addCleanup(path.write_text, before)
        seeds = [{"address": f"{one}:{port}", "key": os.urandom(32).hex()} for one in sources(200)]
        path.write_text(json.dumps(dict(json.loads(before), seeds=seeds)))
        child = self.start_router("belt", 256)
        self.fleet.wait("no descriptor is left", lambda: "no_descriptor" in self.log("belt"), 60)
        deaf.close()
        self.fleet.wait("a member comes in", lambda: self.comes_in_at("belt"), 60)
        self.assertIsNone(child.poll())


if __name__ == "__main__":
    support.main()
