#!/usr/bin/env python3
"""A member with a valid, sealed link that says anything: mutated headers and bodies of every subtype, seals, relayed
messages, news. The sequences stay valid, so that each mutation is read; a link that is closed is made again.
Afterwards, and every five seconds: the honest nodes are the same processes, linked, small, and answer each other within
a second.

    fuzz_member.py [SECONDS] [--seed N] [--programs FOLDER]      by scripts/fuzz --member
"""
import argparse
import collections
import os
import pathlib
import random
import re
import sys
import time

REPO = pathlib.Path(__file__).resolve().parents[2]
BLOCK, UDP_PORT = 194, 50194
CHECK_S = 5
RELINKS_S = 4  # links in a second of one member: routers take 8 Hellos
SANITIZER = re.compile(r"(ERROR: \w+Sanitizer|runtime error:|WARNING: ThreadSanitizer|terminate called|Assertion)")
INTEGERS = (0, 1, 127, 128, 255, 256, 65535, 65536, 2**31 - 1, 2**32 - 1, 2**63 - 1, 2**63, 2**64 - 1, -1, -2**31, -2**63)
CLOSES = ("type", "flags", "target", "source", "subtype")  # a wrong one may end the link, and what follows is not read
TEXTS = ("", "ant", "bee", "cat", "*", "x" * 64, "x" * 65, "x" * 256, "\x1b[2J\x07", "\u009b31m", "../..", "127.0.0.1:45000", "é" * 40)


def programs(given):
    """A sanitized build if there is one, else what there is."""
    folders = [given] if given else [os.environ.get("TRB_BIN_DIR"), *(REPO / "build" / kind / "bin" for kind in ("asan", "release", "dev"))]
    for folder in folders:
        if folder and (pathlib.Path(folder) / "trb-router").exists() and (pathlib.Path(folder) / "trb").exists():
            return pathlib.Path(folder)
    sys.exit("fuzz_member: no trb-router is built: cmake --preset asan && cmake --build --preset asan")


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seconds", nargs="?", type=float, default=600)
    parser.add_argument("--seed", type=int, default=None, help="of the mutations; keys and moments differ from run to run")
    parser.add_argument("--programs", default=None)
    return parser.parse_args()


OPTIONS = options()
os.environ["TRB_BIN_DIR"] = str(programs(OPTIONS.programs))

import zmq  # noqa: E402

import authority  # noqa: E402
import support  # noqa: E402
import trb_fleet  # noqa: E402
import wire  # noqa: E402
from attack_fleet import FRIEND, SANITIZED, TARGET, Attacker, Honest, descriptors, resident  # noqa: E402
from sealer import Signer  # noqa: E402

MEMBERS = ("cat", "dog", "elk", "fox")
RELAYS = ("elk", "fox")
MEMORY_MIB = 700 if SANITIZED else 160  # what floods may take, by services/router/README.md
DESCRIPTORS = 128
ANSWER_S = 5.0 if SANITIZED else 1.0


def subtypes():
    """Every subtype of the rights table in proto/README.md."""
    text = (REPO / "proto" / "README.md").read_text().split("<!-- rights -->")[1]
    rows = re.findall(r"^\| (?:from node|between|on one node|never)[^|]*\|[^|]*\|[^|]*\| ([^|]*) \|", text, re.M)
    return sorted({word for row in rows if "," not in row for word in row.split()}) + ["greeting", "move"]


class Mutator:
    def __init__(self, seed, fleet):
        self.random = random.Random(seed)
        self.certificates = [Signer(fleet, name).certificate for name in (*MEMBERS, FRIEND, TARGET)]
        self.words = subtypes()

    def value(self, depth=0):
        """Any value of the grammar, the ends of ranges more often than not."""
        dice = self.random.random()
        if depth < 4 and dice < 0.25:
            return [self.value(depth + 1) for _ in range(self.random.choice((0, 1, 2, 3, 8)))]
        if dice < 0.45:
            return self.random.choice(INTEGERS)
        if dice < 0.65:
            return self.random.choice(TEXTS)
        if dice < 0.8:
            return self.random.randbytes(self.random.choice((0, 1, 16, 32, 64, 300)))
        if dice < 0.9:
            return self.random.choice((True, False, None, 0.0, -1e308, float("nan"), float("inf")))
        return self.random.choice(self.certificates)

    def seed(self, word, speaker):
        """A valid body, or nearly, for the subtypes that the router itself reads."""
        r, some = self.random, self.random.choice
        certificate = some(self.certificates)
        bodies = {
            "keep_alive": lambda: [some((speaker.heard, *INTEGERS[:13]))],
            "echo_request": lambda: [r.randbytes(some((0, 10, 60_000)))],
            "route_list": lambda: [some(TEXTS)],
            "node_profile": lambda: [some(TEXTS) for _ in range(5)] + [[some(TEXTS)] * some((0, 3, 300)), [], [], [], "ONLINE", "",
                                                                       False, "", []],
            "neighbours": lambda: [[certificate] * some((0, 1, 64)), [some(TEXTS)] * some((0, 2))],
            "relay_refused": lambda: [some(TEXTS), some(INTEGERS), "queue_full"],
            "fleet_news": lambda: [some((["", "", b"", b""], certificate)), [certificate] * some((0, 1, 3, 256))],
            "hello": lambda: [certificate, some(INTEGERS), "127.0.194.9:1", "x", 0, True, [], 0, "behind", True, ""],
            "relayed": lambda: [speaker.member.sign("relayed", wire.pack(
                [some((TARGET, FRIEND, "cat")), some(INTEGERS[:13]), 1, some(INTEGERS[:13]),
                 time.time_ns() + some((-1, 1)) * 10**9, r.randbytes(200)]))],
            "goodbye": lambda: [some(TEXTS)],
            "nack": lambda: ["queue_full", "echo_request", TARGET, some(TEXTS), some(TEXTS)],
        }
        return bodies.get(word, lambda: self.value())()

    def body(self, word, speaker):
        data = wire.pack(self.seed(word, speaker)) if self.random.random() < 0.7 else self.random.randbytes(40)
        return self.bytes(data) if self.random.random() < 0.6 else data

    def bytes(self, data):
        """Flipped bits, cuts, doubled pieces, huge lengths."""
        data = bytearray(data)
        for _ in range(self.random.choice((1, 1, 1, 2, 5))):
            at = self.random.randrange(len(data) + 1)
            kind = self.random.randrange(6)
            if kind == 0 and data:
                data[at % len(data)] ^= 1 << self.random.randrange(8)
            elif kind == 1:
                del data[at:]
            elif kind == 2:
                data[at:at] = data[at:at + self.random.choice((1, 4, 64))]
            elif kind == 3:
                data[at:at + 1] = self.random.choice((b"\xdd\xff\xff\xff\xff", b"\xdc\xff\xff", b"\xc6\x7f\xff\xff\xff", b"\xc1", b"\xdf\0"))
            elif kind == 4:
                data[at:at] = self.random.randbytes(self.random.choice((1, 8)))
            elif data:
                data[at % len(data)] = self.random.choice((0, 0x7F, 0x80, 0xC0, 0xFF))
        return bytes(data)

    def frame(self, speaker):
        """(its subtype, the next frame of the link). One in two has a wrong header, one in 200 wrong bytes of it."""
        r = self.random
        word = r.choice(self.words)
        if word == "goodbye" and r.random() < 0.95:
            word = "greeting"
        frame = wire.Frame(word, speaker.member.id, r.choice((TARGET, TARGET, TARGET, "*")),
                           type=r.choice((wire.COMMAND, wire.REQUEST, wire.INFORMATION)), id=r.randrange(1 << 48),
                           link=speaker.link, sequence=speaker.sequence + 1, data=self.body(word, speaker))
        if r.random() < 0.5:
            for name, values in (("type", (0, 1, 2, 3, 4, 255)), ("flags", (0, 1, 2, 4, 0xFFFF)), ("remaining_ms", (0, 1, 2**32 - 1)),
                                 ("id", INTEGERS[:13]), ("reply_to", (0, 1, 1 << 48, 5 << 48 | 7, 2**64 - 1)),
                                 ("target", TEXTS), ("source", TEXTS), ("subtype", TEXTS)):
                if r.random() < (0.004 if name in CLOSES else 0.1):
                    setattr(frame, name, r.choice(values))
        raw = frame.encode()
        if r.random() < 0.005:
            raw = raw[:24] + self.bytes(raw[24:])
        return word, raw


class Fuzz:
    def __init__(self, seconds, seed):
        self.seconds, self.seed = seconds, seed
        self.cleanups, self.said, self.links, self.worst = [], collections.Counter(), 0, 0.0
        self.most = {}
        services = {TARGET: ["router"], FRIEND: ["router"], **{name: ["router"] for name in MEMBERS}}
        if (support.PROGRAMS / "trb-scheduler").exists():
            services[TARGET] = ["router", "scheduler"]
        self.fleet = support.make_fleet(self, support.RouterFleet, services=services, block=BLOCK, udp_port=UDP_PORT)
        self.context = zmq.Context()
        self.fleet.bring_up(TARGET, FRIEND)
        self.fleet.wait("the honest nodes are linked", lambda: self.honest_links()[0] == "ONLINE", 30)
        self.pids = {node: self.fleet.pid(node, "router") for node in (TARGET, FRIEND)}
        self.first = self.honest_links()
        self.memory = {node: resident(pid) for node, pid in self.pids.items()}
        self.open = {node: descriptors(pid) for node, pid in self.pids.items()}
        self.watch = support.Watch(self.fleet, TARGET)
        self.mutator = Mutator(seed, self.fleet)
        key = authority.Authority(self.fleet.authority_dir(), self.fleet.passphrase())
        self.certificates = {name: key.certificate(Signer(self.fleet, name).certificate, serial=1000 + at, relay=True)
                             for at, name in enumerate(RELAYS)}
        self.speakers = dict.fromkeys(MEMBERS)
        self.next_link = dict.fromkeys(MEMBERS, 0.0)

    def addCleanup(self, what, *arguments):  # noqa: N802, unittest's name
        self.cleanups.append((what, arguments))

    def close(self):
        for one in self.speakers.values():
            if one:
                one.close()
        self.context.destroy(0)
        while self.cleanups:
            what, arguments = self.cleanups.pop()
            what(*arguments)

    def honest_links(self):
        rows = self.fleet.json("route", "list", node=TARGET)["routes"]
        row = next((row for row in rows if row["id"] == FRIEND), {"state": "unknown", "link": 0})
        return row["state"], row["link"]

    # ---- sending

    def speaker(self, name):
        """Its link, made again if it was closed; nothing while it is too soon for that."""
        one, now = self.speakers[name], time.monotonic()
        if one is None and now >= self.next_link[name]:
            self.next_link[name] = now + 1 / RELINKS_S
            one = Attacker(self, name, certificate=self.certificates.get(name))
            one.socket.setsockopt(zmq.SNDTIMEO, 200)
            one.join(relay=name in RELAYS)
            self.speakers[name] = one
            try:
                one.receive_until(lambda frame: frame.subtype == "hello", 1)
                one.seal()
                self.links += 1
            except (TimeoutError, zmq.ZMQError):
                self.hang_up(name)
                return None
        return self.speakers[name]

    def hang_up(self, name):
        if self.speakers[name]:
            self.speakers[name].close()
        self.speakers[name] = None

    @staticmethod
    def has_ended(one):
        """Reads what there is, perhaps a Goodbye: messages after it are not read."""
        while one.socket.poll(1):
            frame = wire.decode(one.socket.recv())
            one.heard = frame.sequence
            if frame.subtype == "goodbye":
                return True
        return False

    def talk(self, name):
        """Fifty frames, correctly sealed or, now and then, not."""
        one = self.speaker(name)
        if one is None:
            return
        try:
            for _ in range(50):
                word, raw = self.mutator.frame(one)
                if len(raw) > (1 << 20):
                    continue
                one.sequence += 1
                one.socket.send(raw)
                one.open.append(raw)
                self.said[word] += 1
                if len(one.open) % 8 == 0 and self.has_ended(one):
                    return self.hang_up(name)
                if len(one.open) >= 16:
                    if self.mutator.random.random() < 0.002:
                        one.put_seal(["seal", one.member.id, self.mutator.bytes(one.range()), self.mutator.random.randbytes(64)])
                    else:
                        one.seal()
                    self.said["seal"] += 1
            one.live()
            if self.has_ended(one):
                self.hang_up(name)
        except (zmq.ZMQError, wire.WireError):
            self.hang_up(name)

    # ---- checks

    def harm(self):
        """The harm to the honest nodes; empty: none."""
        out = []
        for node, pid in self.pids.items():
            if self.fleet.nodes[node].child.poll() is not None:
                out.append(f"trb up of {node} has ended with {self.fleet.nodes[node].child.returncode}")
                continue
            if self.fleet.pid(node, "router") != pid:
                out.append(f"the router of {node} is another process")
                continue
            self.most[node] = max(self.most.get(node, 0.0), resident(pid))
            if self.most[node] - self.memory[node] > MEMORY_MIB:
                out.append(f"the router of {node} has grown from {self.memory[node]:.0f} to {self.most[node]:.0f} MiB")
            if descriptors(pid) - self.open[node] > DESCRIPTORS:
                out.append(f"the router of {node} has {descriptors(pid)} descriptors, {self.open[node]} at first")
        for path in [*self.fleet.root.glob("*.log"), *self.fleet.root.glob("nodes/*/log/*.log")]:
            if found := SANITIZER.search(path.read_text(errors="replace")):
                out.append(f"{path.name}: {found[0]}: " + path.read_text(errors="replace")[found.start():][:2000])
        if not out and self.honest_links() != self.first:
            out.append(f"the honest link was {self.first} and is {self.honest_links()}")
        if self.honest.fault:
            out.append(f"an honest question: {self.honest.fault}")
        self.worst = max([self.worst, *self.honest.times])
        # A stall of the machine is one or two of them.
        if sorted([0, 0, *self.honest.times])[-3] > ANSWER_S or self.worst > 5:
            out.append(f"an honest answer took {self.worst:.2f} s")
        return out

    def run(self):
        self.honest = Honest(self.fleet)
        self.honest.start()
        self.honest.wait_answers(1)
        end, look = time.monotonic() + self.seconds, time.monotonic() + CHECK_S
        harm = []
        while time.monotonic() < end and not harm:
            if all(one is None for one in self.speakers.values()):
                self.honest.ended.wait(0.02)
            for name in MEMBERS:
                self.talk(name)
            if time.monotonic() >= look:
                harm, look = self.harm(), time.monotonic() + CHECK_S
        self.honest.wait_answers(10)
        harm = harm or self.harm()
        self.honest.end()
        return harm

    def print_table(self):
        print(f"{sum(self.said.values())} frames on {self.links} links, seed {self.seed}, {support.PROGRAMS}")
        for at, (word, count) in enumerate(sorted(self.said.items())):
            print(f"  {word:24}{count:8}", end="\n" if at % 3 == 2 else "")
        print("\nrefused or dropped:")
        for name, count in sorted(self.watch.rise(("refused.", "dropped.", "cut.")).items()):
            print(f"  {name:40}{count:8}")
        print(f"honest answers: {len(self.honest.times)}, worst {self.worst * 1000:.0f} ms")
        for node, most in self.most.items():
            print(f"memory of {node}: {self.memory[node]:.0f} MiB at first, {most:.0f} at most")


def main():
    seed = OPTIONS.seed if OPTIONS.seed is not None else random.SystemRandom().randrange(1 << 32)
    print(f"== fuzzing as a member for {OPTIONS.seconds:.0f} s, --seed {seed}", flush=True)
    fuzz = Fuzz(OPTIONS.seconds, seed)
    try:
        harm = fuzz.run()
        if not harm:
            fuzz.print_table()
        elif all(one.child.poll() is None for one in fuzz.fleet.nodes.values()):
            try:
                fuzz.print_table()
            except (trb_fleet.subprocess.SubprocessError, RuntimeError, OSError) as fault:
                print(f"no table: {fault}")
        for what in harm:
            print(f"HARM: {what}")
        print(f"== member: {'harm' if harm else 'no harm'} done")
    finally:
        fuzz.close()
    sys.exit(1 if harm else 0)


if __name__ == "__main__":
    main()
