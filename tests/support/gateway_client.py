"""A browser's and a program's side of the gateway: HTTPS with a cookie jar of one, and the live stream."""
import base64
import gzip
import http.client
import json
import os
import select
import socket
import ssl
import struct
import threading


class Answer:
    def __init__(self, response):
        self.status = response.status
        self.headers = response.headers
        self.bytes = response.read()

    @property
    def json(self):
        packed = self.headers["Content-Encoding"] == "gzip"
        return json.loads(gzip.decompress(self.bytes) if packed else self.bytes)


class Client:
    """One browser, or one program with a token. Keeps cookie and CSRF value as a page does."""

    def __init__(self, port, certificate, token=None, contract=None):
        """`contract` (gateway_contract) sees every answer."""
        self.port = port
        self.tls = ssl.create_default_context(cafile=certificate)
        self.token = token
        self.contract = contract
        self.cookie = None
        self.csrf = None

    @property
    def origin(self):
        return f"https://localhost:{self.port}"

    def headers(self, changes):
        out = {}
        if self.token:
            out["Authorization"] = f"Bearer {self.token}"
        if self.cookie:
            out["Cookie"] = f"__Host-trb={self.cookie}"
        if changes and not self.token:
            out["Origin"] = self.origin
            if self.csrf:
                out["X-CSRF-Token"] = self.csrf
        return out

    def connect(self):
        """A connection on which nothing was sent yet."""
        connection = http.client.HTTPSConnection("localhost", self.port, context=self.tls, timeout=60)
        connection.connect()
        return connection

    def begin(self, method, path, body=None, connection=None, **more):
        """Sends, and returns the connection and the body that were used. `more`: headers with '_' for '-'; None takes one
        away."""
        headers = self.headers(method not in ("GET", "HEAD"))
        data = body
        if body is not None and not isinstance(body, bytes):
            data = json.dumps(body).encode()
            headers["Content-Type"] = "application/json"
        for name, value in more.items():
            name = name.replace("_", "-")
            headers = {known: had for known, had in headers.items() if known.lower() != name.lower()}
            if value is not None:
                headers[name] = value
        connection = connection or http.client.HTTPSConnection("localhost", self.port, context=self.tls, timeout=60)
        try:
            connection.request(method, path, data, headers)
        except OSError:
            connection.close()
            raise
        return connection, data

    def ask(self, method, path, body=None, **more):
        """As begin(), with the answer."""
        connection, data = self.begin(method, path, body, **more)
        try:
            answer = Answer(connection.getresponse())
        finally:
            connection.close()
        if self.contract:
            self.contract.check(method, path, data, answer)
        return answer

    def sign_in(self, user, password):
        answer = self.ask("POST", "/api/v1/session", {"user": user, "password": password})
        if answer.status == 201:
            self.set_cookie = answer.headers["Set-Cookie"]
            self.cookie = self.set_cookie.split(";")[0].split("=", 1)[1]
            self.csrf = answer.json["csrf"]
        return answer

    def live(self, **more):
        return Live(self, more)


class Live:
    """The live stream: RFC 6455, as much of it as this needs. One thread may hear while another one says something."""

    def __init__(self, client, more):
        self.lock = threading.Lock()  # OpenSSL takes one thread at a time
        self.contract = client.contract
        raw = socket.create_connection(("localhost", client.port), timeout=60)
        self.socket = client.tls.wrap_socket(raw, server_hostname="localhost")
        self.buffer = b""
        headers = {"Host": f"localhost:{client.port}", "Upgrade": "websocket", "Connection": "Upgrade",
                   "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
                   "Origin": client.origin, **client.headers(False), **more}
        text = "GET /api/v1/live HTTP/1.1\r\n" + "".join(f"{name}: {value}\r\n" for name, value in headers.items())
        self.socket.sendall((text + "\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            self.receive()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        self.status = int(head.split(b" ")[1])

    def say(self, word):
        data = word if isinstance(word, bytes) else json.dumps(word).encode()
        mask = os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
        self.send(b"\x81" + size + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)))

    def send(self, data):
        with self.lock:
            self.socket.sendall(data)

    def receive(self):
        """Some more bytes. It is waited for them without the lock: something may be said meanwhile."""
        while True:
            with self.lock:
                timeout = self.socket.gettimeout()
                self.socket.settimeout(0)
                try:
                    got = self.socket.recv(1 << 20)
                    break
                except ssl.SSLWantReadError:
                    pass
                finally:
                    self.socket.settimeout(timeout)
            ready = select.poll()
            ready.register(self.socket, select.POLLIN)
            if not ready.poll(None if timeout is None else timeout * 1000):
                raise TimeoutError("the gateway says nothing")
        if not got:
            raise EOFError("the gateway has closed the connection")
        self.buffer += got

    def take(self, count):
        while len(self.buffer) < count:
            self.receive()
        out, self.buffer = self.buffer[:count], self.buffer[count:]
        return out

    def frame(self):
        """(opcode, bytes) of the next frame."""
        first, second = self.take(2)
        size = second & 0x7F
        if size == 126:
            size = struct.unpack(">H", self.take(2))[0]
        elif size == 127:
            size = struct.unpack(">Q", self.take(8))[0]
        return first & 0x0F, self.take(size)

    def hear(self):
        """The next message; a close as {"closed": CODE}."""
        while True:
            kind, data = self.frame()
            if kind == 8:
                return {"closed": struct.unpack(">H", data[:2])[0]}
            if kind == 9:
                self.send(b"\x8a" + bytes([0x80 | len(data)]) + b"\0\0\0\0" + data)
            elif kind in (0, 1):
                return self.checked(json.loads(data))

    def checked(self, message):
        if self.contract:
            self.contract.check_live(message)
        return message

    def until(self, found, most=200):
        """The first message for which that is true."""
        for _ in range(most):
            message = self.hear()
            if found(message):
                return message
        raise TimeoutError("not heard")

    def close(self):
        self.socket.close()

    def abort(self, *threads):
        """As a program that is killed: nothing more is said, and threads that use it are woken and end. Only then it is
        closed: a thread of it would read what the next connection with the same descriptor is sent."""
        try:
            socket.socket.shutdown(self.socket, socket.SHUT_RDWR)
        except OSError:
            pass  # the other side was quicker
        for thread in threads:
            thread.join(5)
            assert not thread.is_alive(), thread
        self.socket.close()
