"""The addresses of a demonstration: 127.0.BLOCK.x and the next block. Another one, of another clone, may hold them."""
import os
import pathlib
import socket
import struct

NODES = 12
BLOCKS = range(1, 40, 2)
INBOX = 45000


class Place:
    """A block of addresses; held until it is closed, or the process ends."""

    def __init__(self, block, udp_port, held):
        self.block, self.udp_port, self.held = block, udp_port, held

    def close(self):
        self.held.close()


def name_of(block):
    """An abstract socket: nothing is left behind, whatever becomes of its holder."""
    return f"\0trb-demo-{block}"


def hold(block):
    """The socket that holds the block; None: somebody else does."""
    held = socket.socket(socket.AF_UNIX)
    try:
        held.bind(name_of(block))
        held.listen(4096)  # nobody accepts: who asks goes away again, and stays in this queue
        return held
    except OSError:
        held.close()
        return None


def pid_of_holder(block):
    """Who holds it by name; 0: nobody says so."""
    with socket.socket(socket.AF_UNIX) as asked:
        asked.setblocking(False)
        if asked.connect_ex(name_of(block)) != 0:
            return 0
        return struct.unpack("3i", asked.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0]


def wait_for_end(block, seconds):
    """Until whoever holds the block by name ends, or has ended; False: it has not in that time."""
    with socket.socket(socket.AF_UNIX) as asked:
        if asked.connect_ex(name_of(block)) != 0:
            return True
        asked.settimeout(max(seconds, 0.001))
        try:
            asked.recv(1)  # nobody says anything: its end is the end of the connection
        except TimeoutError:
            return False
        except ConnectionError:
            pass
        return True


def taken_address(block):
    """An address of the block at which somebody listens; "" if there is none."""
    for i in range(1, NODES + 1):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((f"127.0.{block}.{i}", INBOX))
            except OSError:
                return f"127.0.{block}.{i}"
    return ""


def pid_at(address):
    """The process that listens there, if it is this user's; else 0."""
    wanted = "%08X:%04X" % (struct.unpack("<I", socket.inet_aton(address))[0], INBOX)
    rows = [line.split() for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]]
    inodes = {f"socket:[{row[9]}]" for row in rows if row[1] == wanted}
    for link in pathlib.Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if os.readlink(link) in inodes:
                return int(link.parts[2])
        except OSError:
            continue
    return 0


def in_words(pid):
    """A process, and the folder that it works in."""
    if not pid:
        return "a process of another user"
    try:
        return f"pid {pid} in {os.readlink(f'/proc/{pid}/cwd')}"
    except OSError:
        return f"pid {pid}"


def take(block, udp_port, root, say):
    """The block that is asked for, or else the first that is free. RuntimeError names who holds it."""
    told = []
    for one in [block] if block else BLOCKS:
        held, address = hold(one), taken_address(one)
        if held and not address:
            if told:
                say(f"== {told[0]}: this demonstration takes 127.0.{one}.x")
            # A beacon's port of its own: two fleets in one would hear each other's beacons, and refuse them.
            return Place(one, udp_port or 50000 + one - 1, held)
        who = in_words(pid_at(address) if held else pid_of_holder(one))
        if held:
            held.close()
        told.append(f"the addresses 127.0.{one}.x are held by {who}")
    raise RuntimeError("; ".join(told[:3]) + f"; stop that one first: no addresses are free for {root}")
