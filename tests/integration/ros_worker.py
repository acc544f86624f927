"""Plays the bridge to a trb-ros-worker of its own (services/ros-bridge/core/worker_syntax.hpp)."""
import socket
import struct

import support  # noqa: F401: sets the path for the next import
import trb_fleet

LOOK_UP, PUBLISH, SUBSCRIBE = 1, 2, 3
ALIVE, TYPE, PUBLISHED, FAILED, MESSAGE, TOPIC_FAILED = 5, 6, 7, 8, 9, 12


class Worker:
    def __init__(self, program, log_path, master, env):
        self.socket, theirs = socket.socketpair()
        self.socket.settimeout(trb_fleet.LONG_S)
        with theirs:
            # The worker speaks through descriptor 3.
            self.process = trb_fleet.Process(["sh", "-c", 'exec "$0" "$@" 3<&0', program, master, "127.0.0.1", "trb_alone", "/"],
                                             log_path, stdin=theirs, env=env)

    def say(self, word, *parts):
        parts = [part if isinstance(part, bytes) else str(part).encode() for part in parts]
        body = bytes([word]) + b"".join(struct.pack("<I", len(part)) + part for part in parts)
        self.socket.sendall(struct.pack("<I", len(body)) + body)

    def read(self, size):
        data = b""
        while len(data) < size:
            more = self.socket.recv(size - len(data))
            if not more:
                raise EOFError("the worker has ended")
            data += more
        return data

    def hear(self):
        """The next word and its parts."""
        body = self.read(*struct.unpack("<I", self.read(4)))
        word, body, parts = body[0], body[1:], []
        while body:
            end = 4 + struct.unpack("<I", body[:4])[0]
            parts.append(body[4:end].decode(errors="replace"))
            body = body[end:]
        return word, parts

    def answer(self):
        """The next word but those that only tell that it lives."""
        while True:
            word, parts = self.hear()
            if word != ALIVE:
                return word, parts

    def wait_up(self):
        while self.hear() != (ALIVE, ["up", ""]):
            pass

    def stop(self):
        self.socket.close()
        self.process.stop()
