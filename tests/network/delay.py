"""delay.py SPACE_A TAP_A SPACE_B TAP_B MS: two taps in two network namespaces, joined; each frame is held for MS.

"""
import collections
import ctypes
import fcntl
import os
import select
import struct
import sys
import time

TUNSETIFF, IFF_TAP, IFF_NO_PI, CLONE_NEWNET = 0x400454CA, 0x0002, 0x1000, 0x40000000
MOST_WAITING = 5000  # frames: further ones are lost, as in a full queue


def open_tap(space, name):
    libc = ctypes.CDLL(None, use_errno=True)
    with open(f"/var/run/netns/{space}") as file:
        if libc.setns(file.fileno(), CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), f"setns {space}")
    tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH", name.encode(), IFF_TAP | IFF_NO_PI))
    return tap


def read_all(tap, waiting, due):
    while len(waiting) < MOST_WAITING:
        try:
            waiting.append((due, os.read(tap, 65536)))
        except OSError:  # nothing more, or the interface is down
            return


def write_due(tap, waiting):
    while waiting and waiting[0][0] <= time.monotonic():
        try:
            os.write(tap, waiting.popleft()[1])
        except OSError:
            continue


def main():
    ctypes.CDLL(None).prctl(1, 15)  # ends with its parent
    space_a, name_a, space_b, name_b, ms = sys.argv[1:6]
    taps = open_tap(space_a, name_a), open_tap(space_b, name_b)
    delay = float(ms) / 1000
    queues = {taps[0]: (taps[1], collections.deque()), taps[1]: (taps[0], collections.deque())}
    print("ready", flush=True)
    while True:
        dues = [waiting[0][0] for _, waiting in queues.values() if waiting]
        left = max(0.0, min(dues) - time.monotonic()) if dues else None
        readable, _, _ = select.select(taps, [], [], left)
        for tap in readable:
            read_all(tap, queues[tap][1], time.monotonic() + delay)
        for other, waiting in queues.values():
            write_due(other, waiting)


if __name__ == "__main__":
    main()
