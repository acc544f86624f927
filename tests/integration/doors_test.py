"""A router's door under pressure: crowds, floods, slow and silent clients. The fleet's own messages go on meanwhile,
memory and descriptors stay bounded, no link drops, and afterwards everything is as before.
"""
import contextlib
import itertools
import os
import select
import socket
import threading
import time

import zmq

import support
import wire
from pressure import MOST_UNPROVEN, PORT, TARGET, Flood, Pressure, sources
from router_client import WAIT

HOME = "127.0.40.99"  # the address in the Hello of strangers_test.Client


class Dribble(threading.Thread):
    """A proxy to the door that, once told to, lets one byte pass every 20 ms."""

    def __init__(self, address):
        super().__init__(daemon=True)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.address = address
        self.slow = threading.Event()
        self.ended = threading.Event()
        self.passed = 0

    def run(self):
        client, _ = self.server.accept()
        door = socket.create_connection((self.address, PORT))
        try:
            while True:
                ready, _, _ = select.select([client, door], [], [])
                for one in ready:
                    slow = self.slow.is_set() and one is client
                    data = one.recv(1 if slow else 4096)
                    if not data:
                        return
                    if slow:
                        self.ended.wait(0.02)
                        self.passed += 1
                    (door if one is client else client).sendall(data)
        except OSError:
            pass
        finally:
            self.ended.set()
            for one in (client, door, self.server):
                one.close()


class Doors(Pressure):
    # ---- crowds

    def test_10_000_candidates(self):
        """Each with a key of its own, from 250 addresses, 250 at a time; every other one with the Hello of a made-up node."""
        came = 0
        kind, signer, payload, signature = self.belt.certificate
        made_up = [kind, signer, payload.replace(b"belt", b"bolt"), signature]
        hello = wire.Frame("hello", "bolt", TARGET, link=7, sequence=1, id=1, data=wire.hello(made_up, 1, "")).encode()
        known = self.rows()

        def knock(stopped):
            nonlocal came
            for _ in range(40):
                crowd = []
                for source in sources(250):
                    one = self.context.socket(zmq.DEALER)
                    one.setsockopt(zmq.LINGER, 0)
                    one.setsockopt(zmq.RECONNECT_IVL, -1)
                    one.curve_serverkey = self.server_key
                    one.curve_publickey, one.curve_secretkey = zmq.curve_keypair()
                    one.connect(f"tcp://{source}:0;{self.address}:{PORT}")
                    crowd.append(one)
                    if len(crowd) % 2:
                        with contextlib.suppress(zmq.Again):  # refused already: it has nowhere to send to, for ever
                            one.send(hello, zmq.DONTWAIT)
                came += len(crowd)
                stopped.wait(0.2)
                for one in crowd:
                    one.close()

        self.under("10,000 candidates", knock)
        self.assertEqual(came, 10_000)
        self.watch.wait_counted("refused.too_many_candidates", 1000)
        self.watch.wait_counted("refused.bad_signature", 30)
        self.watch.wait_logged("too_many_candidates no room for the unknown key")
        self.watch.wait_logged("candidate_refused bad_signature")
        self.assertEqual(self.rows(), known)

    def test_candidates_of_one_source(self):
        """More at a time than one source may have: it is kept out, other sources are not."""
        crowd = [self.plain("127.0.138.1") for _ in range(300)]
        self.watch.wait_counted("refused.source_blocked")
        self.watch.wait_logged("source_blocked 127.0.138.1 has too many connections that prove nothing")
        late = self.plain("127.0.138.1")
        client = self.client(server_key=self.server_key, keys=(self.belt.public, self.belt.secret))
        client.hello(self.belt.certificate, "belt")
        self.assertEqual(client.receive().subtype, "hello")
        self.assertEqual(select.select([], [late], [], 0.3)[1], [], "a blocked source came in")
        for one in [*crowd, late]:
            one.close()

    # ---- floods of TCP

    def test_thousands_of_connections_held_open(self):
        def hold(stopped):
            held = []
            for source in sources(50):
                held += [self.plain(source) for _ in range(100)]
                stopped.wait(0.02)
            stopped.wait(3)
            for one in held:
                one.close()

        most = self.under("5,000 connections held open", hold)
        self.assertGreater(most, self.fds + 500, "the flood did not reach the door")

    def test_a_node_that_was_linked_comes_back_through_the_crowd(self):
        """The door is closed to everybody else by then."""
        self.assertTrue(self.comes_in(self.belt))  # its Hello has its address, HOME

        def hold(stopped):
            held = []
            for source in sources(100):
                held += [self.plain(source) for _ in range(40)]
                stopped.wait(0.01)
            stopped.wait()
            for one in held:
                one.close()

        flood = Flood(hold)
        flood.start()
        try:
            self.fleet.wait("the door is closed", lambda: self.descriptors() >= self.fds + MOST_UNPROVEN, 60)
            for _ in range(3):  # who holds a place is cut after 2 s, and on a stalled machine another one may come in then
                shut_out = self.plain("127.0.138.77")
                self.addCleanup(shut_out.close)
                client = self.client(f"{HOME}:0;{self.address}:{PORT}", server_key=self.server_key,
                                     keys=(self.belt.public, self.belt.secret))
                client.hello(self.belt.certificate, "belt")
                self.assertEqual(client.receive(WAIT).subtype, "hello")
                poll = select.poll()  # of descriptors beyond select()'s
                poll.register(shut_out, select.POLLOUT)
                came = poll.poll(0)
                if not came:
                    break
            self.assertEqual(came, [], "anybody came in")
        finally:
            flood.stopped.set()
            flood.join(20)
        self.assertIsNone(flood.error)

    def test_connections_opened_and_closed_quickly(self):
        def hammer(stopped):
            from_one = sources(3)
            for count in itertools.count():
                if stopped.is_set():
                    return
                one = self.plain(from_one[count % 3])
                select.select([], [one], [], 0.01)
                one.close()

        self.under("connections opened and closed", hammer, seconds=3,
                   enough=lambda: self.watch.rise().get("refused.source_blocked", 0) >= 3)
        self.watch.wait_counted("refused.source_blocked", 3)

    def test_garbage_and_silence_from_many(self):
        def noise(stopped):
            held = []
            for number, source in enumerate(sources(100)):
                for kind in range(5):
                    one = self.plain(source)
                    select.select([], [one], [], 0.1)
                    try:
                        one.send((b"", b"GET / HTTP/1.1\r\n\r\n", os.urandom(500), b"\xff" * 12, b"\0")[kind])
                    except OSError:
                        pass
                    held.append(one)
            stopped.wait(3)
            for one in held:
                one.close()

        self.under("garbage and half-open connections", noise)
        self.watch.wait_counted("refused.no_zmtp", 100)

    # ---- slow and silent ones

    def test_silent_after_the_handshake(self):
        """A stranger and a member: neither may keep a connection that is not a link."""
        self.assertTrue(self.comes_in(self.belt))
        clients = [self.client(server_key=self.server_key, keys=keys) for keys in (None, (self.belt.public, self.belt.secret))]
        for client in clients:
            client.wait_event(zmq.EVENT_HANDSHAKE_SUCCEEDED)
        self.watch.wait_counted("refused.no_hello")
        for client in clients:
            client.wait_event(zmq.EVENT_DISCONNECTED, timeout=20)
        self.watch.wait_logged("no_link the connection of 127.0.0.1:")
        self.assertEqual(self.watch.rise(("cut.",)), {"cut.no_link": 2})

    def test_a_slow_hello(self):
        proxy = Dribble(self.address)
        proxy.start()
        client = self.client(f"127.0.0.1:{proxy.port}", server_key=self.server_key)
        client.wait_event(zmq.EVENT_HANDSHAKE_SUCCEEDED)
        proxy.slow.set()
        client.hello(self.belt.certificate, "belt")
        self.watch.wait_counted("refused.no_hello")
        self.assertTrue(proxy.ended.wait(20), "the slow connection was not cut")
        self.assertGreater(proxy.passed, 20)
        self.watch.wait_counted("cut.no_link", prefixes=("cut.",))

    def test_a_slow_greeting(self):
        plain = socket.create_connection((self.address, PORT))
        self.addCleanup(plain.close)
        plain.settimeout(0.1)
        began = time.monotonic()
        for byte in b"\xff" + bytes(7) + b"\x01\x7f\x03\x00" + b"CURVE".ljust(20, b"\0") + bytes(32):
            try:
                plain.send(bytes([byte]))
                if plain.recv(4096) == b"":
                    break
            except socket.timeout:
                pass
            except OSError:
                break
            self.assertLess(time.monotonic() - began, 20, "the slow connection was not cut")
        self.watch.wait_counted("refused.no_zmtp")

    # ---- another's name

    def test_the_routing_id_of_another_connection(self):
        victim = self.client(server_key=self.server_key, keys=(self.belt.public, self.belt.secret), routing_id=b"belt's own")
        victim.hello(self.belt.certificate, "belt")
        self.assertEqual(victim.receive().subtype, "hello")
        self.assertTrue(self.comes_in(self.crane))  # so that its key is a member's
        for keys in ((self.crane.public, self.crane.secret), None):
            thief = self.client(server_key=self.server_key, keys=keys, routing_id=b"belt's own")
            thief.hello(self.crane.certificate, "crane")
            for _ in range(3):
                ident = victim.send("route_list", "belt", type=wire.REQUEST, data=wire.pack([]))
                self.assertEqual(victim.answer_to(ident).subtype, "route_table")
            thief.wait_event(zmq.EVENT_DISCONNECTED, timeout=20)
            self.assertFalse(thief.socket.poll(0), "the thief was told something")
        self.watch.wait_counted("cut.no_link", 2, prefixes=("cut.",))

if __name__ == "__main__":
    support.main()
