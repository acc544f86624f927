"""What may happen to a plant's network, and what must be so afterwards. Each case builds a lab and a fleet of its own.

A case is a function (report, rounds) that calls report.round(...) for each round; `long` ones wait for minutes.
"""
import contextlib
import statistics
import time

from lab import Lab
from net_fleet import FAKE_TIME, WITHIN_S, NetFleet, trb_fleet  # noqa: F401
from trb_process import wait_until

NODES = ["ant", "bee", "cat", "dog"]
LEASE_S = 10.0
CASES = {}


def case(name, rounds, quick=1):
    def add(function):
        CASES[name] = (function, rounds, quick)
        return function
    return add


class Report:
    """One case's rounds and figures; lines go to standard output as they come."""

    def __init__(self, name, tag):
        self.name, self.tag = name, tag
        self.times, self.faults, self.notes = [], [], {}
        self.fleet, self.links, self.via = None, None, {}

    def say(self, text):
        print(f"{self.name}: {text}", flush=True)

    def fail(self, text):
        self.faults.append(text)
        self.say(f"FAULT {text}")

    @contextlib.contextmanager
    def standing(self, fleet, links=None, via=None, patience=20, then=None):
        """The fleet stands, all tables right; at the end what must not have happened is looked for. `then` is done
        between the start and the forming."""
        with fleet:
            self.fleet, self.via = fleet, via or {}
            self.links = links or {n: len(fleet.node_names) - 1 for n in fleet.node_names}
            since = time.monotonic()
            fleet.start_all()
            if then:
                then()
                since = time.monotonic()
            took = fleet.wait_right(patience, self.via, since)
            if took is None:
                self.show_logs()
                raise RuntimeError(f"does not form: {fleet.what_is_wrong(since, self.via)}")
            self.notes["formed_s"] = round(took, 2)
            self.say(f"{len(fleet.node_names)} nodes formed in {took:.2f} s")
            yield fleet
            self.look_back()

    def healed(self, number, rounds, since, shared=lambda: 0.0):
        """A round's end: how long after `since`, the healing, everything was right. `shared`: seconds of that in which
        every core was taken by routers that in a hall have computers of their own; they do not count."""
        took = self.fleet.wait_right(30, self.via, since)
        if took is None:
            self.fail(f"round {number}: not healed in 30 s: {self.fleet.what_is_wrong(since, self.via)}")
            self.show_logs()
            took = 30.0
        elif took - shared() > WITHIN_S:
            self.fail(f"round {number}: healed after {took:.2f} s, {shared():.2f} s of it on shared cores: more than "
                      f"{WITHIN_S:.0f} s")
            self.show_logs()
        self.times.append(took)
        gone = self.fleet.restarted()
        if gone:
            self.fail(f"round {number}: ended or started again: {gone}")
        if rounds <= 10 or number % 5 == 0:
            self.say(f"round {number} of {rounds}: right {took:.2f} s after the healing")

    def look_back(self):
        """No link double, at the kernel too; no message twice or astray."""
        left = wait_until(lambda: self.fleet.extra_connections(self.links) == 0, 60, 0.5)
        extra = self.fleet.extra_connections(self.links)
        if left is None:
            self.fail(f"{extra} connections beyond one a pair: "
                      f"{ {n: self.fleet.connections(n) for n in self.fleet.routers} }")
        self.notes["extra_connections"] = extra
        self.notes.update(self.fleet.witness.figures())
        if self.fleet.witness.duplicates:
            self.fail(f"delivered twice: {self.fleet.witness.duplicates[:3]}")
        if self.fleet.witness.wrong:
            self.fail(f"wrongly delivered: {self.fleet.witness.wrong[:3]}")

    def show_logs(self):
        for node in self.fleet.node_names[:4]:
            for line in self.fleet.log_lines(node):
                print(f"    {node}: {line[:180]}", flush=True)

    def result(self):
        times = sorted(self.times)
        return {"case": self.name, "rounds": len(times), "median_s": round(statistics.median(times), 2) if times else None,
                "most_s": round(times[-1], 2) if times else None, **self.notes, "faults": self.faults}


def addresses_of(names):
    return {name: None for name in names}


@contextlib.contextmanager
def four(report):
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES)
        with report.standing(NetFleet(lab, addresses_of(NODES))) as fleet:
            yield lab, fleet


def break_for(seconds, report, rounds, cut, mend):
    """In each round something is cut for so long, at another host each time; then all has to heal."""
    for number in range(1, rounds + 1):
        host = NODES[number % len(NODES)]
        cut(host)
        time.sleep(seconds)  # nothing is waited for: it lasts so long
        mend(host)
        report.healed(number, rounds, time.monotonic())


def pull(report, rounds, seconds):
    with four(report) as (lab, _):
        break_for(seconds, report, rounds, lab.pull_cable, lab.plug_cable)


@case("cable-3s", 30, 2)
def cable_3s(report, rounds):
    pull(report, rounds, 3)


@case("cable-30s", 5, 1)
def cable_30s(report, rounds):
    pull(report, rounds, 30)


@case("cable-300s", 1, 0)
def cable_300s(report, rounds):
    pull(report, rounds, 300)


@case("switch", 10, 1)
def switch_dies(report, rounds):
    """No port forwards anything; the carrier stays. Longer than a lease: every link of every node is lost."""
    with four(report) as (lab, _):
        break_for(14, report, rounds, lambda _: lab.switch_dies(), lambda _: lab.switch_returns())


@case("one-way", 10, 1)
def one_way(report, rounds):
    """What a node says is lost, what it hears is not: both sides must end the link, neither may think it is up."""
    with four(report) as (lab, fleet):
        for number in range(1, rounds + 1):
            host = NODES[number % len(NODES)]
            lab.one_way_cut(host)

            def is_over(since=0.0):
                tables = fleet.witness.tables(since)
                mine = [row["state"] != "ONLINE" for n, row in tables.get(host, {}).items() if n != host]
                theirs = [t.get(host, {}).get("state") != "ONLINE" for n, t in tables.items() if n != host]
                return mine and all(mine) and all(theirs)

            if wait_until(is_over, LEASE_S + 4) is None:
                report.fail(f"round {number}: a link that is cut one way is still ONLINE after {LEASE_S + 4:.0f} s")
            lab.heal_rules()
            report.healed(number, rounds, time.monotonic())


@case("loss-30", 10, 1)
def loss(report, rounds):
    with four(report) as (lab, _):
        break_for(12, report, rounds, lambda host: lab.lose(host, 30), lambda _: lab.heal_rules())


@case("delay-50", 10, 1)
def delay(report, rounds):
    """One host is 50 ms away each way: it forms, and comes back after its cable was out for longer than a lease."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES[:3])
        lab.add_delayed_host(NODES[3], 50)
        with report.standing(NetFleet(lab, addresses_of(NODES))):
            break_for(13, report, rounds, lambda _: lab.pull_cable(NODES[3]), lambda _: lab.plug_cable(NODES[3]))


@case("address", 10, 2)
def address(report, rounds):
    """HOST_INT is an interface; its address changes as by DHCP."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES)
        with report.standing(NetFleet(lab, {**addresses_of(NODES), "bee": "eth0"})) as fleet:
            now = lab.address("bee")
            for number in range(1, rounds + 1):
                new = f"10.77.0.{100 + number}"
                lab.change_address("bee", now, new)
                now = new
                report.healed(number, rounds, time.monotonic())
                shown = {t.get("bee", {}).get("address") for t in fleet.witness.tables().values()}
                if shown != {f"{new}:45000"}:
                    report.fail(f"round {number}: the tables show {shown}, the address is {new}")


@case("clock-1970", 10, 2)
def clock_1970(report, rounds):
    """A node loses its power and comes back without knowing the time, as a Raspberry Pi without a network does."""
    fake = {"LD_PRELOAD": FAKE_TIME, "FAKETIME": "@1970-01-01 00:00:10", "FAKETIME_DONT_FAKE_MONOTONIC": "1",
            "DONT_FAKE_MONOTONIC": "1"}
    with four(report) as (lab, fleet):
        for number in range(1, rounds + 1):
            host = NODES[number % len(NODES)]
            lab.pull_cable(host)
            fleet.stop_router(host)
            lab.plug_cable(host)
            since = time.monotonic()
            fleet.start_router(host, env=fake)
            report.healed(number, rounds, since)
            clocks = {t.get(host, {}).get("clock") for t in fleet.witness.tables().values()}
            if clocks != {"unverified"}:
                report.fail(f"round {number}: its clock is shown as {clocks}")


@case("dial-ten", 10, 1)
def dial_ten(report, rounds):
    """Ten nodes that all name each other as seeds, started at the same moment: everybody dials everybody."""
    names = [f"n{i:02d}" for i in range(10)]
    with Lab(report.tag) as lab:
        lab.add_hosts(names)
        fleet = NetFleet(lab, addresses_of(names), every=0.5)
        with fleet_with_seeds(report, fleet, names):
            for number in range(1, rounds + 1):
                for name in names:
                    fleet.stop_router(name)
                since = time.monotonic()
                for name in names:
                    fleet.start_router(name)
                report.healed(number, rounds, since)


@contextlib.contextmanager
def fleet_with_seeds(report, fleet, names, seeds_of=None):
    """`seeds_of`: node -> the nodes that it names; everyone names everyone if not given."""
    make = fleet.make

    def make_with_seeds():
        make()
        for name in names:
            others = names if seeds_of is None else seeds_of.get(name, [])
            seeds = [fleet.seed(other) for other in others if other != name]
            fleet.change_node_json(name, seeds=seeds)
    fleet.make = make_with_seeds
    with report.standing(fleet):
        yield fleet


@case("nat", 10, 1)
def nat(report, rounds):
    """A node behind an address translator: only it can dial, by seeds. Its cable is pulled for longer than a lease."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES[:3])
        gate = lab.add_nat_host(NODES[3])
        inner = f"192.168.{100 + lab.hosts[gate]}.2"
        fleet = NetFleet(lab, {**addresses_of(NODES[:3]), NODES[3]: inner})
        with fleet_with_seeds(report, fleet, NODES, {NODES[3]: NODES[:3]}):
            break_for(13, report, rounds, lambda _: lab.pull_cable(gate), lambda _: lab.plug_cable(gate))


def six(report, rounds, hosts):
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES, family=6)
        with report.standing(NetFleet(lab, hosts(lab))):
            break_for(13, report, rounds, lab.pull_cable, lab.plug_cable)


@case("ipv6", 3, 1)
def ipv6(report, rounds):
    """A network without IPv4: HOST_INT is an address or an interface, beacons go to the group."""
    six(report, rounds, lambda lab: {"ant": "eth0", "bee": lab.address6("bee"), "cat": "eth0", "dog": "eth0"})


@case("ipv6-link-local", 3, 1)
def ipv6_link_local(report, rounds):
    """Not even an address was given: the interfaces have the link-local ones that the kernel makes."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES, family=0)
        with report.standing(NetFleet(lab, {name: "eth0" for name in NODES})):
            for number in range(1, rounds + 1):
                lab.pull_cable("bee")
                time.sleep(13)
                lab.plug_cable("bee")
                report.healed(number, rounds, time.monotonic())


@case("late-interface", 5, 1)
def late_interface(report, rounds):
    """HOST_INT and VPN_INT name interfaces that come after the router was started, go, and come again."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES)
        lab.rename("bee", "eth0", "other")
        fleet = NetFleet(lab, {**addresses_of(NODES), "bee": "tun0"}, network={"cat": {"VPN_INT": "tun0"}})

        def waits():
            if wait_until(lambda: "HOST_INT" in fleet.note("bee"), WITHIN_S) is None:
                report.fail(f"the service list does not say that it waits: {fleet.note('bee')!r}")

        def come():
            waits()
            lab.rename("bee", "other", "tun0")

        with report.standing(fleet, then=come):
            for number in range(1, rounds + 1):
                lab.rename("bee", "tun0", "other")
                waits()
                lab.rename("bee", "other", "tun0")
                report.healed(number, rounds, time.monotonic())
                lab.add_vpn("cat", "10.88.0.1")
                if wait_until(lambda: "10.88.0.1" in fleet.doors("cat"), WITHIN_S) is None:
                    report.fail(f"round {number}: the VPN's address is no door: {fleet.doors('cat')}")
                lab.remove_vpn("cat")
                if wait_until(lambda: "10.88.0.1" not in fleet.doors("cat"), WITHIN_S) is None:
                    report.fail(f"round {number}: the VPN is gone and still a door: {fleet.doors('cat')}")


@case("relay", 10, 1)
def relay(report, rounds):
    """Two nodes that cannot reach each other, and a cloud that both reach: what they say goes by it, until they can."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES)
        more = {name: {"relay": name == "cat"} for name in NODES}
        fleet = NetFleet(lab, addresses_of(NODES), more=more)
        with report.standing(fleet):
            links = dict(report.links)
            for number in range(1, rounds + 1):
                report.via = {("ant", "bee"): "cat"}
                since = time.monotonic()
                lab.cut_between("ant", "bee")
                took = fleet.wait_right(LEASE_S + 6, report.via, since)
                if took is None:
                    report.fail(f"round {number}: no way by the relay: {fleet.what_is_wrong(since, report.via)}")
                    report.show_logs()
                else:
                    report.say(f"round {number}: by the relay {took:.2f} s after the cut, of which the lease is {LEASE_S:.0f} s")
                relayed = fleet.counters("cat").get("relayed.sent", 0)
                if wait_until(lambda: fleet.counters("cat").get("relayed.sent", 0) > relayed, 10) is None:
                    report.fail(f"round {number}: nothing went by the relay for 10 s")
                report.via = {}
                lab.heal_rules()
                report.healed(number, rounds, time.monotonic())
            report.links = links
            report.notes["relayed"] = fleet.counters("cat").get("relayed.sent", 0)
            if not report.notes["relayed"]:
                report.fail("nothing was relayed")


@case("one-seed", 3, 1)
def one_seed(report, rounds):
    """No beacons: each node names one seed, the cloud. Whom it reaches the others learn from it, and dial."""
    with Lab(report.tag) as lab:
        lab.add_hosts(NODES)
        more = {name: {"relay": name == "cat", "beacon": False} for name in NODES}
        fleet = NetFleet(lab, addresses_of(NODES), more=more)
        with fleet_with_seeds(report, fleet, NODES, {name: ["cat"] for name in NODES if name != "cat"}):
            for number in range(1, rounds + 1):
                for name in NODES:
                    fleet.stop_router(name)
                    (fleet.dir(name) / "state" / "peers").unlink(missing_ok=True)
                since = time.monotonic()
                for name in NODES:
                    fleet.start_router(name)
                report.healed(number, rounds, since)
