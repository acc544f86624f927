"""How long a message waits for its seal, and how long the seal's check takes."""
import ctypes
import statistics
import sys
import threading
import time

import zmq

from tapped import REPO

sys.path.insert(0, str(REPO / "tests" / "integration"))
import authority  # noqa: E402  (found only with the line above)
import wire  # noqa: E402

CHECKS = 2000


class SealTimes(threading.Thread):
    """When messages and seals leave a node, by its tap."""

    def __init__(self, bus):
        super().__init__(daemon=True)
        self.times = []  # (seconds, is it a seal)
        self.over = threading.Event()
        self.context = zmq.Context()
        self.tap = self.context.socket(zmq.SUB)
        self.tap.setsockopt(zmq.SUBSCRIBE, b"")
        self.tap.connect(f"ipc://{bus}/tap.ipc")
        self.start()

    def run(self):
        while not self.over.is_set():
            if not self.tap.poll(50):
                continue
            direction, frame = self.tap.recv_multipart()
            subtype = wire.decode(frame).subtype
            if direction == b">" and subtype in ("move", "seal"):
                self.times.append((time.monotonic(), subtype == "seal"))
        self.context.destroy(0)

    def wait_seal(self, start, messages, patience_s=5):
        """Until so many messages have left after index `start`, and a seal behind them."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            new = self.times[start:]
            if sum(not seal for _, seal in new) >= messages and new[-1][1]:
                return new
            self.over.wait(0.005)
        raise TimeoutError("no seal has left behind the last message")

    def end(self):
        self.over.set()
        self.join()


def waits(times):
    """For each message the milliseconds until the next seal."""
    out, seal = [], None
    for at, is_seal in reversed(times):
        if is_seal:
            seal = at
        elif seal is not None:
            out.append(1000 * (seal - at))
    return out


def check_ms():
    """One check of an Ed25519 signature over as many bytes as a seal has."""
    sodium = authority.SODIUM
    public, secret, signature = (ctypes.create_string_buffer(size) for size in (32, 64, 64))
    sodium.crypto_sign_keypair(public, secret)
    text, size = bytes(160), ctypes.c_ulonglong(160)
    sodium.crypto_sign_detached(signature, None, text, size, secret)
    times = []
    for _ in range(CHECKS):
        began = time.perf_counter()
        if sodium.crypto_sign_verify_detached(signature, text, size, public) != 0:
            raise RuntimeError("a good signature was refused")
        times.append(time.perf_counter() - began)
    return 1000 * statistics.median(times)
