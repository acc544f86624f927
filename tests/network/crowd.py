"""Fifty nodes on one machine: how long, how many messages, how much of the processor and of memory a node takes."""
import collections
import os
import resource
import statistics
import time

import zmq
from cases import addresses_of, case
from lab import Lab, neighbours_allowed
from net_fleet import NetFleet


def stat_of(pid):
    """(CPU seconds, resident megabytes) of a process."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    with open(f"/proc/{pid}/status") as file:
        memory = next(line for line in file if line.startswith("VmRSS")).split()[1]
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), int(memory) / 1024


class Load:
    """What the routers use between two looks."""

    def __init__(self, fleet):
        self.fleet, self.at = fleet, time.monotonic()
        self.before = {node: stat_of(router.pid)[0] for node, router in fleet.routers.items()}

    def take(self, but=()):
        """Milliseconds of CPU a second and router: (mean, most)."""
        seconds = time.monotonic() - self.at
        used = [1000 * (stat_of(r.pid)[0] - self.before[n]) / seconds for n, r in self.fleet.routers.items()
                if n not in but]
        return statistics.mean(used), max(used)


    def used(self):
        """Seconds of CPU of them all."""
        return sum(stat_of(r.pid)[0] - self.before[n] for n, r in self.fleet.routers.items())

    def shared(self):
        """Seconds for which they would take all the cores of this machine."""
        return self.used() / os.cpu_count()


OVER_FLOOR = 8  # times the floor, to form again; measured 5 to 6.5, see README


def handshake_ms():
    """CPU milliseconds of one CURVE connection by TCP, both ends: the least that a link costs on this machine."""
    def spent():
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    count, server, client = 200, zmq.curve_keypair(), zmq.curve_keypair()
    with zmq.Context() as context, context.socket(zmq.ROUTER) as inbox:
        inbox.curve_server, inbox.curve_secretkey, inbox.curve_publickey = True, server[1], server[0]
        port = inbox.bind_to_random_port("tcp://127.0.0.1")
        before = spent()
        for _ in range(count):
            with context.socket(zmq.DEALER) as link:
                link.linger = 0
                link.curve_serverkey, link.curve_secretkey, link.curve_publickey = server[0], client[1], client[0]
                link.connect(f"tcp://127.0.0.1:{port}")
                link.send(b"hello")
                inbox.recv_multipart()
        return 1000 * (spent() - before) / count


def all_sent(fleet, nodes):
    """What these nodes together have sent, by subtype."""
    total = collections.Counter()
    for node in nodes:
        total.update({n[5:]: v for n, v in fleet.counters(node).items() if n.startswith("sent.")})
    return total


def sent_of(fleet, nodes):
    """The same, per node."""
    return {name: round(count / len(nodes), 1) for name, count in all_sent(fleet, nodes).most_common(8)}


@case("fifty", 2, 1)
def fifty(report, rounds):
    """50 nodes, each a host, one a relay: form, lose the switch for 30 s, form again; one starts again. Takes two minutes."""
    names = [f"n{i:02d}" for i in range(50)]
    ring = [(a, b) for a, b in zip(names, names[1:] + names[:1])]
    with neighbours_allowed(8 * len(names) ** 2), Lab(report.tag) as lab:
        lab.add_hosts(names)
        more = {name: {"relay": name == names[0]} for name in names}
        fleet = NetFleet(lab, addresses_of(names), more=more, every=2, pairs=ring, ask_every=1.0, look_every=0.25)
        floor_ms = handshake_ms() / 2 * (len(names) - 1)
        start = time.monotonic()
        with report.standing(fleet, patience=90):
            notes = report.notes
            notes["handshakes_ms_a_node"] = round(floor_ms, 1)
            notes["nodes"] = len(names)
            notes["forming_cpu_ms_a_node"] = round(1000 * statistics.mean(stat_of(r.pid)[0] for r in fleet.routers.values()))
            notes["sent_while_forming_a_node"] = sent_of(fleet, names[5::10])
            notes["sent_while_forming_by_the_relay"] = sent_of(fleet, names[:1])
            report.say(f"formed, with making and starting {time.monotonic() - start:.1f} s")
            fleet.witness.ask_every = 60.0  # now the fleet is measured, not the witness
            time.sleep(3)
            load = Load(fleet)
            time.sleep(20)
            notes["quiet_cpu_ms_per_s_mean"], notes["quiet_cpu_ms_per_s_most"] = (round(v, 2) for v in load.take())
            memory = [stat_of(r.pid)[1] for r in fleet.routers.values()]
            notes["memory_mb_mean"], notes["memory_mb_most"] = round(statistics.mean(memory), 1), round(max(memory), 1)
            before = Load(fleet)
            time.sleep(10)
            alone = before.take(but=names[7:8])
            fleet.stop_router(names[7])
            after = Load(fleet)
            fleet.start_router(names[7])
            time.sleep(10)
            beside = after.take(but=names[7:8])
            notes["restart_others_cpu_ms_per_s_before"], notes["restart_others_cpu_ms_per_s_after"] = (
                round(alone[0], 2), round(beside[0], 2))
            notes["restart_most_cpu_ms_per_s_after"] = round(beside[1], 2)
            if beside[0] > alone[0] + 10:
                report.fail(f"one restart: {alone[0]:.1f} ms/s of CPU before, {beside[0]:.1f} after, a node")
            fleet.witness.ask_every = 1.0
            report.healed(1, 2, time.monotonic())
            report.times.clear()
            for number in range(1, rounds + 1):
                load = Load(fleet)
                lab.switch_dies()
                time.sleep(30)
                notes["dead_cpu_ms_per_s_mean"] = round(load.take()[0], 2)
                sent, load = collections.Counter(all_sent(fleet, names[5::10])), Load(fleet)
                since = time.monotonic()
                lab.switch_returns()
                report.healed(number, rounds, since, load.shared)
                reform_ms = 1000 * load.used() / len(names)
                notes["reform_cpu_ms_a_node"], notes["reform_over_floor"] = round(reform_ms), round(reform_ms / floor_ms, 2)
                if reform_ms > OVER_FLOOR * floor_ms:
                    report.fail(f"round {number}: {reform_ms:.0f} ms of CPU a node to form again, over {OVER_FLOOR} times "
                                f"the {floor_ms:.0f} ms of the handshakes alone")
                again = collections.Counter(all_sent(fleet, names[5::10]))
                again.subtract(sent)
                notes["sent_while_reforming_a_node"] = {n: round(c / 5, 1) for n, c in again.most_common(8)}
                for seconds, count, some in fleet.progress[-12:]:
                    report.say(f"{seconds} s after: {count} faults, {some}")
