"""A robot by HTTPS: a node, and a virtual ABB behind a server of TLS by Python, with certificates by openssl. Addresses 127.0.234.x,
127.0.235.x."""
import json
import selectors
import socket
import ssl
import subprocess
import threading
import unittest

import support
from rws_test import PASSWORD, RwsFleet

BLOCK = 234


def openssl(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)


class Certificates:
    """A folder of them."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        self.key = folder / "robot.key"
        openssl("genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256", "-out", self.key)

    def own(self, name):
        path = self.folder / f"{name}.crt"
        openssl("req", "-x509", "-new", "-key", self.key, "-subj", f"/CN={name}", "-days", 30, "-out", path)
        return path

    def by_authority(self, address):
        authority, request, path = (self.folder / name for name in ("ca.crt", "robot.csr", "signed.crt"))
        names = self.folder / "names"
        names.write_text(f"subjectAltName=IP:{address}\n")
        openssl("req", "-x509", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-subj", "/CN=Hall CA",
                "-keyout", self.folder / "ca.key", "-days", 30, "-out", authority)
        openssl("req", "-new", "-key", self.key, "-subj", "/CN=robot", "-out", request)
        openssl("x509", "-req", "-in", request, "-CA", authority, "-CAkey", self.folder / "ca.key", "-CAcreateserial", "-days", 30,
                "-extfile", names, "-out", path)
        return authority, path

    @staticmethod
    def sha256(path):
        shown = subprocess.run(["openssl", "x509", "-in", path, "-noout", "-fingerprint", "-sha256"], check=True, capture_output=True,
                               text=True).stdout
        return shown.strip().split("=")[1]


class TlsServer:
    """In front of a port: each connection has a thread of its own."""

    def __init__(self, address, target, certificate, key):
        self.address, self.target, self.key = address, target, key
        self.show(certificate)
        self.listener = socket.create_server((address, 0))
        self.port = self.listener.getsockname()[1]
        self.open = set()
        self.seen = b""  # what the node has sent, in plain
        threading.Thread(target=self.accept, daemon=True).start()

    def show(self, certificate):
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.context.load_cert_chain(certificate, self.key)

    def cut(self):
        for one in list(self.open):
            try:
                one.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.carry, args=(client,), daemon=True).start()

    def carry(self, client):
        try:
            with self.context.wrap_socket(client, server_side=True) as inner, socket.create_connection(
                    (self.address, self.target)) as outer:
                self.open.add(inner)
                self.pass_on(inner, outer)
                self.open.discard(inner)
        except OSError:
            client.close()

    def pass_on(self, inner, outer):
        with selectors.DefaultSelector() as both:
            both.register(inner, selectors.EVENT_READ)
            both.register(outer, selectors.EVENT_READ)
            while True:
                for event, _ in both.select():
                    came = event.fileobj
                    data = came.recv(65536)
                    if not data:
                        return
                    if came is inner:
                        self.seen += data
                    (outer if came is inner else inner).sendall(data)


class SecureFleet(RwsFleet):
    def __init__(self, root, programs):
        super().__init__(root, programs, block=BLOCK)

    def start_robot(self, node, *more):
        self.certificates = Certificates(self.root / "certificates")
        first = self.certificates.own("first")
        plain = self.start_virtual("auto", 100000)
        self.server = TlsServer(self.robot_address("abb"), plain, first, self.certificates.key)
        self.words = json.loads((self.dir(node) / "commands.json").read_text())
        self.trust({"fingerprint": Certificates.sha256(first)})

    def trust(self, tls):
        self.words["abb-rws"].update(port=self.server.port, tls=tls)
        (self.dir("abb") / "commands.json").write_text(json.dumps(self.words))


class RobotTls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, SecureFleet)
        cls.fleet.start()
        cls.wait_online()

    @classmethod
    def wait_online(cls):
        cls.fleet.wait("the robot is ONLINE", lambda: cls.fleet.profile()["robot"] == "ONLINE", 60)

    def trust(self, tls):
        self.fleet.trust(tls)
        self.fleet.trb("reload", self.fleet.dir("abb"))
        self.wait_online()

    def look(self):
        return self.fleet.trb("robot", "certificate", self.fleet.dir("abb"), check=False)

    def test_a_a_robot_is_commanded_and_stopped_by_https(self):
        fleet = self.fleet
        fleet.trb("send", "abb", "command", "move", "[20, 0, 0, 0, 30, 0]", "--take", node="abb")
        fleet.wait("it is there", lambda: fleet.ask("joints") == [20, 0, 0, 0, 30, 0], 60)
        self.assertIn("confirmed", fleet.trb("stop", "abb", node="abb").stdout)
        fleet.trb("release", "abb", node="abb")
        self.assertIn(b"POST /rw/rapid/execution?action=stop", fleet.server.seen)
        shown = self.look()
        self.assertEqual(shown.returncode, 0, shown.stdout + shown.stderr)
        self.assertIn("The node takes it.", shown.stdout)
        self.assertIn("CN=first", shown.stdout)

    def test_b_a_renewed_certificate_is_told_and_gets_no_password_until_it_is_pinned(self):
        fleet = self.fleet
        renewed = fleet.certificates.own("renewed")
        fleet.server.show(renewed)
        fleet.server.cut()
        fleet.wait("the robot is gone", lambda: fleet.profile()["robot"] != "ONLINE", 60)
        before = len(fleet.server.seen)

        def doctor():
            done = fleet.trb("doctor", "abb", node="abb", check=False)
            return done.stdout + done.stderr
        pin = Certificates.sha256(renewed)
        fleet.wait("the doctor names it", lambda: "tls.fingerprint (commands.json), it has " + pin in doctor(), 60)
        self.assertIn("trb robot certificate NODE_DIR", doctor())
        shown = self.look()
        self.assertNotEqual(shown.returncode, 0)
        self.assertIn('"tls": {"fingerprint": "' + pin + '"}', shown.stdout)
        self.assertEqual(len(fleet.server.seen), before)
        self.trust({"fingerprint": pin.replace(":", "").lower()})
        for path in fleet.root.rglob("*.log"):
            self.assertNotIn(PASSWORD.encode(), path.read_bytes(), path)

    def test_c_an_authority_vouches_for_the_robot_s_address(self):
        fleet = self.fleet
        authority, signed = fleet.certificates.by_authority(fleet.robot_address("abb"))
        keys = fleet.dir("abb") / "keys" / "robot-ca.pem"
        keys.write_bytes(authority.read_bytes())
        fleet.server.show(signed)
        fleet.server.cut()
        self.trust({"authority": "keys/robot-ca.pem"})
        self.assertEqual(self.look().returncode, 0)
        fleet.trust({"authority": "keys/robot-ca.pem", "name": "other.hall"})
        shown = self.look()
        self.assertIn(f"is for {fleet.robot_address('abb')}, not for other.hall", shown.stdout)


if __name__ == "__main__":
    support.main()
