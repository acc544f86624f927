"""Those who mean harm, and those who only type wrong: every route of the API's description, and the doors around it.

Addresses 127.0.216.x, 127.0.217.x; strangers come from 127.0.218.x.
"""
import concurrent.futures
import os
import resource
import signal
import socket
import ssl
import threading
import time

import support
from gateway_case import ADMIN, CLOUD, GOOD, ROBOT, WAIT_S, GatewayCase

CONNECTIONS = 10_000
HOSTILE = ("..", "%2e%2e", "a%2fb", "%00", "x" * 300, "%0d%0aSet-Cookie:%20a=b", "'%3BDROP%20TABLE%20users--", "%22%3E%3Cscript%3E",
           "{robot}", "%F0%9F%A4%96", "%ff", "..%5c..", "nobody", "-1", "18446744073709551616")
BODIES = (b"", b"{", b"[]", b"null", b'"x"', b"7", b"{}", b'{"x": 1}', b'{"a": 1, "a": 2}', b"[" * 5000, b'{"name": "\xff"}',
          b'{"name": "a\\u0000b"}', b"{" + b'"k":' * 1 + b"9" * 400 + b"}", b"\x00" * 64, b'{"__proto__": {"admin": true}}')
#: They end the session that asks; other stories try them.
ENDS_SESSION = {("delete", "/api/v1/session"), ("delete", "/api/v1/me/sessions")}
#: They answer 200 with the faults of what was sent.
CHECKS = ("/api/v1/scenarios/check", "/api/v1/scenarios/preflight")
KNOWN = {"robot": ROBOT, "node": CLOUD, "user": "vic"}


class Hostile(GatewayCase):
    block, udp_port = 216, 50216

    def tearDown(self):
        self.order("release")

    def operations(self):
        for path, of_path in self.contract.document["paths"].items():
            for method, operation in of_path.items():
                if path != "/api/v1/live" and (method, path) not in ENDS_SESSION:
                    yield method.upper(), path, operation

    def assert_told(self, answer, what):
        """Done, or refused with a code and a cure; never a fault of the gateway."""
        self.assertLess(answer.status, 500 if answer.status not in (503, 504) else 600, (what, answer.bytes[:300]))
        if answer.status >= 400:
            self.assertTrue(answer.json["errors"][0]["hint"], (what, answer.bytes))

    # ---- every route of the description

    def test_every_list_is_as_described(self):
        walls = self.fleet.dir(CLOUD) / "hall.svg"  # a hall without walls has no picture of them
        self.addCleanup(walls.unlink)
        walls.write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="-1 -20 31 25"><path d="M0 0H30"/></svg>')
        for method, path, operation in self.operations():
            if method != "GET" or "{" in path:
                continue
            with self.subTest(path):
                answer = self.admin.ask(method, path)  # the contract holds it against the description
                self.assertIn(answer.status, (200, 429), answer.bytes[:300])
                self.assertEqual(self.client().ask(method, path).status, 200 if operation.get("security") == [] else 401)

    def test_hostile_paths_are_refused_and_change_nothing(self):
        for method, path, _ in self.operations():
            if "{" not in path:
                continue
            for hostile in HOSTILE:
                filled = "/".join(hostile if part.startswith("{") else part for part in path.split("/"))
                with self.subTest(method=method, path=filled[:80]):
                    answer = self.admin.ask(method, filled, None if method in ("GET", "DELETE") else {}, If_Match="*")
                    self.assert_told(answer, filled)
                    self.assertGreaterEqual(answer.status, 400)
                    self.assertIsNone(answer.headers["Set-Cookie"])
        self.assertEqual({one["name"] for one in self.admin.ask("GET", "/api/v1/users").json["users"]}, {"admin", "vic", "olga"})

    def test_hostile_bodies_are_refused_with_a_cure(self):
        plain = self.client()  # what it sends is not as described
        plain.contract, plain.cookie, plain.csrf = None, self.admin.cookie, self.admin.csrf
        for method, path, operation in self.operations():
            if "requestBody" not in operation or path == "/api/v1/session":
                continue
            filled = "/".join(KNOWN.get(part.strip("{}"), "f" * 16) if part.startswith("{") else part for part in path.split("/"))
            for body in BODIES:
                if body == b"{}" and (method == "PATCH" or path == "/api/v1/minimums"):
                    continue  # that is a right one: nothing changes, no bounds
                if body in (b"{}", b"") and not operation["requestBody"].get("required"):
                    continue
                with self.subTest(method=method, path=filled, body=body[:30]):
                    answer = plain.ask(method, filled, body, Content_Type="application/json", If_Match="*")
                    self.assert_told(answer, (filled, body[:60]))
                    if path in CHECKS and answer.status == 200:
                        self.assertTrue(answer.json["faults"])
                    else:
                        self.assertGreaterEqual(answer.status, 400)
        self.assertEqual(self.admin.ask("GET", "/api/v1/me").json["user"], "admin")

    def test_a_member_that_is_missing_or_of_another_kind_is_named(self):
        """Of each body that must be an object: what it must have."""
        for method, path, operation in self.operations():
            body = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema", {})
            schema = self.schema(body)
            if path == "/api/v1/session" or schema.get("type") != "object" or not schema.get("required"):
                continue
            filled = "/".join(KNOWN.get(part.strip("{}"), "f" * 16) if part.startswith("{") else part for part in path.split("/"))
            for wrong in ({}, {name: [] for name in schema["required"]}, {**{name: [] for name in schema["required"]}, "no_such": 1}):
                with self.subTest(method=method, path=filled, body=wrong):
                    answer = self.admin.ask(method, filled, wrong, If_Match="*")
                    self.assertIn(answer.status, (400, 404, 409, 413, 422), answer.bytes)
                    self.assert_told(answer, filled)

    def schema(self, of):
        while "$ref" in of:
            of = self.contract.document["components"]["schemas"][of["$ref"].rsplit("/", 1)[1]]
        return of

    def test_every_route_refuses_strangers_and_each_lower_role(self):
        clients = {"viewer": self.viewer, "operator": self.operator}
        ranks = {"anyone": 0, "viewer": 1, "operator": 2, "admin": 3}
        for method, path, operation in self.operations():
            least = ranks[operation["x-role"]]
            filled = "/".join("f" * 16 if part.startswith("{") else part for part in path.split("/"))
            if least > 0:
                self.assertEqual(self.client().ask(method, filled).status, 401, (method, path))
            for role, client in clients.items():
                if ranks[role] < least:
                    self.assert_problem(client.ask(method, filled), 403, "role_too_low")

    # ---- the first password

    def test_the_password_of_the_console_opens_nothing_but_its_change_and_stops(self):
        made = self.fleet.json("cloud", "password", self.fleet.dir(CLOUD), "--user", "root2")
        client = self.client()
        signed_in = client.sign_in("root2", made["password"])
        self.assertEqual((signed_in.status, signed_in.json["must_change_password"]), (201, True))
        self.assert_problem(client.ask("GET", "/api/v1/robots"), 403, "password_must_change")
        self.assert_problem(client.ask("POST", "/api/v1/robots/pioneer1/release"), 403, "password_must_change")
        self.assertEqual(client.live().status, 403)
        self.assertTrue(client.ask("GET", "/api/v1/session").json["must_change_password"])
        self.assert_problem(client.ask("PUT", "/api/v1/me/password", {"old": "wrong wrong wrong", "new": GOOD}), 403)
        same = client.ask("PUT", "/api/v1/me/password", {"old": made["password"], "new": made["password"]})
        self.assert_problem(same, 422, "bad_value")
        self.assertIn("new: is the old password", same.json["detail"])
        self.assertEqual(client.ask("PUT", "/api/v1/me/password", {"old": made["password"], "new": GOOD}).status, 204)
        self.assertFalse(client.sign_in("root2", GOOD).json["must_change_password"])
        self.assertEqual(client.ask("GET", "/api/v1/robots").status, 200)
        self.assertEqual(self.admin.ask("DELETE", "/api/v1/users/root2").status, 204)

    # ---- bytes

    def raw(self, source=None):
        plain = socket.create_connection(("127.0.0.1", self.port), timeout=30, source_address=source and (source, 0))
        return self.admin.tls.wrap_socket(plain, server_hostname="localhost")

    def told(self, data):
        """What comes back on one connection until it ends."""
        with self.raw() as door:
            door.sendall(data)
            out = b""
            try:
                while got := door.recv(65536):
                    out += got
            except (ConnectionResetError, ssl.SSLError):
                pass
            return out

    def test_two_ways_to_read_a_length_are_no_way_to_smuggle_a_request(self):
        head = f"POST /api/v1/session HTTP/1.1\r\nHost: localhost:{self.port}\r\nContent-Type: application/json\r\n"
        hidden = f"GET /api/v1/health HTTP/1.1\r\nHost: localhost:{self.port}\r\n\r\n"
        for lengths in ("Content-Length: 4\r\nTransfer-Encoding: chunked\r\n", "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n",
                        "Content-Length: 0\r\nContent-Length: 44\r\n", "Content-Length: 0, 44\r\n", "Content-Length: +4\r\n",
                        "Content-Length : 4\r\n", "Content-Length: 0x4\r\n", "Transfer-Encoding: xchunked\r\n",
                        "Transfer-Encoding: chunked, identity\r\n", "Transfer-Encoding:\x0bchunked\r\n", "Content-Length: -1\r\n",
                        "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"):
            with self.subTest(lengths):
                answer = self.told((head + lengths + "\r\n0\r\n\r\n" + hidden).encode("latin-1"))
                self.assertRegex(answer, rb"^HTTP/1\.1 (400|501|411) ")
                self.assertEqual(answer.count(b"HTTP/1.1 "), 1, answer)
                self.assertNotIn(b'"status":"ok"', answer)

    def test_nothing_that_a_client_sends_becomes_a_header(self):
        for path in ("/api/v1/robots/%0d%0aX-Evil:%201", "/api/v1/robots?cursor=%0d%0aX-Evil:%201", "/assets/a%0d%0aX-Evil:%201"):
            self.assertIsNone(self.admin.ask("GET", path).headers["X-Evil"])
        evil = "a\x0bX-Evil: 1"
        answer = self.told(f"GET /api/v1/health HTTP/1.1\r\nHost: localhost:{self.port}\r\nIdempotency-Key: {evil}\r\n\r\n"
                           "GET / HTTP/1.1\r\nConnection: close\r\n\r\n".encode())
        self.assertNotIn(b"\r\nX-Evil", answer)

    def test_slow_headers_end_in_time(self):
        with self.raw() as slow:
            begin = time.monotonic()
            slow.settimeout(0.5)
            answer = b""
            for byte in f"GET /api/v1/health HTTP/1.1\r\nHost: localhost:{self.port}\r\nX: {'a' * 100}":
                slow.sendall(byte.encode())
                try:
                    answer = slow.recv(4096)
                    break
                except TimeoutError:
                    pass
            self.assertIn(b" 408 ", answer)
            self.assertLess(time.monotonic() - begin, 25)

    def test_a_secret_in_the_wrong_place_is_in_no_file(self):
        token = self.admin.ask("POST", "/api/v1/tokens", {"name": "leak", "role": "viewer", "days": 1}).json["secret"]
        self.addCleanup(self.admin.ask, "DELETE", "/api/v1/tokens/leak")
        self.client().ask("GET", f"/api/v1/robots?access_token={token}")
        self.client().ask("GET", f"/api/v1/robots/{token}")
        self.client(token).ask("POST", "/api/v1/stop")
        self.told(f"GET /{token} HTTP/9.9\r\nAuthorization: Bearer {token}\r\n\r\n".encode())
        for path in self.fleet.root.rglob("*"):
            if path.is_file() and not path.is_symlink():
                kept = path.read_bytes()
                self.assertNotIn(token.encode(), kept, path)
                self.assertNotIn(ADMIN.encode(), kept, path)

    # ---- floods

    def test_ten_thousand_connections_keep_nobody_out_who_is_signed_in(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        if hard != resource.RLIM_INFINITY and hard < CONNECTIONS + 500:
            self.skipTest(f"this machine allows {hard} open files; {CONNECTIONS + 500} are needed")
        resource.setrlimit(resource.RLIMIT_NOFILE, (CONNECTIONS + 500, hard))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        pid = self.fleet.pid(CLOUD, "cloud-gateway")
        live = self.viewer.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})
        late = self.client()
        doors = []
        self.addCleanup(lambda: [door.close() for door in doors])
        for i in range(CONNECTIONS):
            door = socket.socket()
            door.setblocking(False)
            door.bind((f"127.0.218.{1 + i // 50}", 0))
            door.connect_ex(("127.0.0.1", self.port))
            doors.append(door)
            if i % 1000 == 999:
                self.assertEqual(self.viewer.ask("GET", "/api/v1/me").status, 200)
                live.until(lambda heard: "head" in heard)
        self.assertEqual(self.fleet.pid(CLOUD, "cloud-gateway"), pid)
        open_files = len(os.listdir(f"/proc/{pid}/fd"))
        self.assertLess(open_files, 1024 + 100)
        self.assertEqual(late.sign_in("vic", GOOD).status, 201)

    def test_who_opens_live_streams_and_closes_none_leaves_others_a_place(self):
        held = []
        self.addCleanup(lambda: [live.close() for live in held])
        for _ in range(50):
            held.append(self.viewer.live())
        self.assertEqual({live.status for live in held}, {101})
        refused = self.viewer.live()
        self.addCleanup(refused.close)
        self.assertEqual(refused.status, 429)
        other = self.operator.live()
        self.addCleanup(other.close)
        self.assertEqual(other.status, 101)
        held.pop().close()

        def opens():
            held.append(self.viewer.live())
            return held[-1].status == 101
        self.fleet.wait("there is room for another one", opens, 10)

    def test_a_flood_of_words_delays_nobody_else(self):
        flood = self.viewer.live()
        self.addCleanup(flood.close)
        stop = threading.Event()

        def send():
            try:
                while not stop.is_set():
                    flood.say({"subscribe": "fleet"})
                    flood.say({"unsubscribe": "fleet"})
            except OSError:
                pass  # it was let go
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            sending = pool.submit(send)
            took = []
            for _ in range(20):
                begin = time.monotonic()
                self.assertEqual(self.operator.ask("GET", "/api/v1/robots").status, 200)
                took.append(time.monotonic() - begin)
            stop.set()
            sending.result(WAIT_S)
        support.assert_quick(self, took, 2)
        print(f"slowest of 20 requests beside the flood: {max(took) * 1000:.0f} ms")

    def test_a_thousand_refusals_are_a_few_records(self):
        reads = self.admin.ask("POST", "/api/v1/tokens", {"name": "looks", "role": "operator", "days": 1, "read_only": True})
        self.assertEqual(reads.status, 201, reads.bytes)
        stranger, token = self.client(), self.client(reads.json["secret"])
        before, began = self.admin.ask("GET", "/api/v1/audit/head").json["number"], time.monotonic()
        statuses = [stranger.sign_in("nobody-there", f"wrong wrong {i}").status for i in range(1000)]
        self.assertEqual(set(statuses), {401, 429})
        for _ in range(200):
            self.assertEqual(token.ask("POST", "/api/v1/stop").status, 403)
        records = self.admin.ask("GET", "/api/v1/audit/head").json["number"] - before
        self.assertLess(records, 20 + 4 * ((time.monotonic() - began) // 60))  # each minute a few begin anew

        def numbers():
            return [one["outcome"] for one in self.admin.ask("GET", f"/api/v1/audit?limit=100&who=gateway").json["records"]
                    if one["action"] == "refusals" and one["number"] > before]
        pid = self.fleet.pid(CLOUD, "cloud-gateway")
        os.kill(pid, signal.SIGTERM)
        self.fleet.wait("another gateway", lambda: self.fleet.pid(CLOUD, "cloud-gateway") not in (None, pid) and self.is_ready(), WAIT_S)
        self.assertGreater(sum(int(one.split()[0]) for one in numbers()), 1150)

    # ---- gzip

    def test_lists_come_gzipped_and_secrets_do_not(self):
        plain = self.admin.ask("GET", "/api/v1/audit?limit=100&who=admin")
        packed = self.admin.ask("GET", "/api/v1/audit?limit=100&who=admin&", Accept_Encoding="gzip")
        self.assertEqual((packed.headers["Content-Encoding"], packed.headers["Vary"]), ("gzip", "Accept-Encoding"))
        self.assertEqual(packed.json["records"], plain.json["records"])
        self.assertLess(len(packed.bytes), len(plain.bytes) / 2)
        for path in ("/api/v1/session", "/api/v1/me", "/api/v1/tokens"):
            self.assertIsNone(self.admin.ask("GET", path, Accept_Encoding="gzip").headers["Content-Encoding"])


if __name__ == "__main__":
    support.main()
