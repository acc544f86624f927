"""scripts/test-vpn [openvpn|wireguard ...] [--cuts N] [--json FILE]

Two tenants' fleets on one cloud host, each over a VPN of its own (deploy/vpn), between network namespaces: a run over the
VPN, the cable of a robot cut and plugged in under a run, a foreign client, and what one tenant sees of the other. Needs root.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "network"), str(HERE.parents[1] / "scripts"), str(HERE.parent / "support"),
                str(HERE.parent / "integration")]
import hosts  # noqa: E402
import skips  # noqa: E402
import trb_fleet  # noqa: E402
import tunnels as recipes  # noqa: E402
from lab import Lab  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402
from trb_process import wait_until  # noqa: E402
from vpn_fleet import VpnFleet  # noqa: E402

PROGRAMS = pathlib.Path(os.environ.get("TRB_BIN_DIR", HERE.parents[1] / "build/plain/bin"))
HOST = "hub"  # the cloud's host
NORTH = {"ant": ("lines", "ridgeback", ["--skill", "fetch=6", "--skill", "load_out=1"]),
         "bee": ("lines", "conveyor", ["--skill", "run=1"])}
SOUTH = {"cow": ("lines", "conveyor", ["--skill", "run=1"])}
# Each passes on to the other: what is between them goes by the cloud, for nothing else joins their halls.
RUN = {"name": "over-the-vpn",
       "tasks": [{"id": "first", "robot": "bee", "skill": "run"},
                 {"id": "fetch", "robot": "ant", "skill": "fetch", "data": {"from": "table1", "to": "conveyor_entry"},
                  "after": ["first"]},
                 {"id": "convey", "robot": "bee", "skill": "run", "after": ["fetch"]},
                 {"id": "load", "robot": "ant", "skill": "load_out", "after": ["convey"]}]}
ONCE = {"bee": ["run", "run"], "ant": ["fetch", "load_out"]}
CUT_S = 13  # longer than a lease
PORT = 45000


class World:
    """The hosts, the tunnels, the two fleets: all of it goes with the `with`."""

    def __init__(self, kind):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="trb-vpn-", dir="/tmp"))
        self.folder.chmod(0o755)
        self.lab = Lab(f"{os.getpid() % 100000}")
        self.tunnels = recipes.KINDS[kind](self.lab, self.folder, HOST)
        self.north, self.south = recipes.Tenant("north", 91, 1194), recipes.Tenant("south", 92, 1195)
        self.fleets = []
        self.faults, self.notes = [], {}

    def say(self, text):
        print(f"{self.tunnels.kind}: {text}", flush=True)

    def check(self, holds, text):
        if not holds:
            self.faults.append(text)
            self.say(f"FAULT {text}")
            for fleet in self.fleets:
                for line in fleet.log_lines(CLOUD):
                    self.say(f"  {fleet.name} cloud: {line[:160]}")

    def __enter__(self):
        try:
            self.build()
        except BaseException:
            self.__exit__()
            raise
        return self

    def build(self):
        self.lab.__enter__()
        self.lab.add_hosts([HOST])
        self.cloud = self.lab.address(HOST)
        robots = {self.north: NORTH, self.south: SOUTH}
        for tenant, names in robots.items():
            (self.folder / tenant.name).mkdir(mode=0o755)
            for name in names:
                tenant.add(name)
                self.lab.add_nat_host(name)
        self.lab.add_nat_host("eve")
        self.load_firewall()
        for tenant, names in robots.items():
            self.tunnels.make(tenant)
            self.tunnels.raise_cloud(tenant)
            for name in names:
                self.tunnels.raise_robot(tenant, name, name, self.cloud)
                self.load_robot_rules(name)
        for tenant, names, user in ((self.north, NORTH, 64201), (self.south, SOUTH, 64202)):
            fleet = VpnFleet(self.folder / tenant.name / "fleet", PROGRAMS, self.lab, tenant, self.tunnels, HOST, names, user)
            self.fleets.append(fleet)
            fleet.make()
            for name in names:  # the robot beside its node's PC
                recipes.lab_of.batch([f"-n {self.lab.space(name)} addr add {fleet.robot_address(name)}/24 dev eth0"])

    def load_firewall(self):
        rows = [f'"{self.tunnels.device(t)}" . {t.cloud}' for t in (self.north, self.south)]
        rules = recipes.defined(recipes.RECIPES / "cloud.nft", nodes=f"{{ {', '.join(rows)} }}",
                                vpn_ports=f"{{ {self.north.port}, {self.south.port} }}")
        recipes.load_rules(self.lab, HOST, rules)

    def load_robot_rules(self, name):
        rules = recipes.defined(recipes.RECIPES / "robot.nft", vpn=f'"{self.tunnels.robot_device}"')
        recipes.load_rules(self.lab, name, rules)

    def start(self):
        began = time.monotonic()
        for fleet in self.fleets:
            fleet.start()
        for fleet in self.fleets:
            fleet.wait_formed(60)
        self.notes["formed_s"] = round(time.monotonic() - began, 1)
        self.say(f"both fleets formed in {self.notes['formed_s']} s")

    def __exit__(self, *_):
        for fleet in self.fleets:
            fleet.stop()
        self.tunnels.stop()
        self.lab.__exit__()
        if os.environ.get("TRB_KEEP") != "1":
            shutil.rmtree(self.folder, ignore_errors=True)

    def dial(self, host, address, port=PORT, timeout=3):
        """True if a TCP connection from that host comes about."""
        code = (f"import socket; s = socket.socket(); s.settimeout({timeout}); "
                f"raise SystemExit(0 if s.connect_ex(('{address}', {port})) == 0 else 1)")
        return subprocess.run(self.lab.inside(host, sys.executable, "-c", code), capture_output=True).returncode == 0


def far_ends(pid):
    """The IPv4 addresses that have a link with this process's host, by the kernel's table."""
    rows = [row.split()[1:4] for name in ("tcp", "tcp6")
            for row in pathlib.Path(f"/proc/{pid}/net/{name}").read_text().splitlines()[1:]]
    ends = [far.rsplit(":", 1)[0][-8:] for near, far, state in rows if state == "01" and f":{PORT:04X}" in near + far]
    return {".".join(str(b) for b in reversed(bytes.fromhex(end))) for end in ends}


def over_the_vpn(world):
    """All links of a tenant go by its tunnel, and a run finishes."""
    fleet = world.fleets[0]
    far = far_ends(fleet.pid_of_child(fleet.nodes[CLOUD].child.pid, "router"))
    own = {*world.north.nodes.values(), *world.south.nodes.values(), world.north.cloud, world.south.cloud}
    world.check(far and far <= own, f"the cloud's links come from {far}, the tunnels' addresses are {own}")
    routes = fleet.routes("ant")
    world.check(routes["bee"].get("via") == CLOUD, f"ant reaches bee by {routes['bee'].get('via') or 'a link of its own'}")
    world.check(not world.dial("ant", world.cloud), "the fleet's port is open on the cloud's public address")
    before = fleet.begun()
    view = fleet.wait_ended(fleet.submit(RUN))
    world.check(view["state"] == "FINISHED", f"the run over the VPN is {view['state']}")
    check_once(world, fleet, before)
    world.say("a run of three nodes over the VPN: FINISHED")


def check_once(world, fleet, before):
    now = fleet.begun()
    told = {robot: now[robot][len(before[robot]):] for robot in ONCE}
    world.check(told == ONCE, f"the robots were told {told}, the run has {ONCE}")


def cut_and_back(world, rounds):
    """The cable of the hall whose robot works is pulled for longer than a lease: the run goes on, nothing is done twice."""
    fleet, times = world.fleets[0], []
    for number in range(1, rounds + 1):
        before = fleet.begun()
        run = fleet.submit(RUN)
        fleet.wait("ant fetches", lambda b=before: "fetch" in fleet.begun()["ant"][len(b["ant"]):], 60)
        world.lab.pull_cable("ant-nat")
        cut = time.monotonic()
        world.check(wait_until(lambda: fleet.routes(CLOUD)["ant"]["state"] == "OFFLINE", CUT_S + 10) is not None, "the cut is not seen")
        wait_until(lambda c=cut: time.monotonic() - c >= CUT_S, CUT_S + 1)
        world.check(fleet.view(run)["state"] not in ("FINISHED", "FAILED"), "the run ended in the cut")
        world.lab.plug_cable("ant-nat")
        back = time.monotonic()
        online = wait_until(lambda: fleet.routes(CLOUD)["ant"]["state"] == "ONLINE", 60) is not None
        times.append(time.monotonic() - back)
        world.check(online, f"round {number}: ant is not back after 60 s")
        view = fleet.wait_ended(run)
        world.check(view["state"] == "FINISHED", f"round {number}: the run is {view['state']} after the cut")
        check_once(world, fleet, before)
        world.say(f"round {number} of {rounds}: {times[-1]:.1f} s after the cable was back ant was, and the run FINISHED")
    world.notes.update(back_median_s=round(statistics.median(times), 1), back_most_s=round(max(times), 1))


def foreign_client(world):
    """Who has no key of the tunnel does not get in; who has one and no certificate of the fleet gets no further."""
    tunnels = world.tunnels
    tenant = tunnels.stranger(world.north, "eve", world.cloud)
    time_up = wait_until(lambda: world.dial("eve", world.north.cloud, timeout=1), 10) is not None
    world.check(not time_up, "a foreign client of the VPN reaches the fleet's port")
    world.say(f"a foreign client: refused ({tunnels.wait_refused(world.north).strip()[-90:]})")
    if tunnels.let_in(world.north):
        world.check(wait_until(lambda: world.dial("eve", world.north.cloud, timeout=1), 20) is not None, "a client that was let in gets nowhere")
    tunnels.stop_robot(tenant, "eve")
    # The tunnel falls open: whoever sits in it still is no member.
    fleet, stranger = world.fleets[0], world.fleets[1]
    recipes.load_rules(world.lab, HOST, "flush ruleset\n")
    before = fleet.counters(CLOUD).get("refused.foreign_fleet", 0)
    stranger.change("cow", "node.json", seeds=[*json.loads((stranger.dir("cow") / "node.json").read_text())["seeds"],
                                                 net_seed(fleet)])
    add_way(world, "cow", world.north.cloud)
    done = subprocess.run(world.lab.inside("cow", PROGRAMS / "trb", "reload", stranger.dir("cow")), capture_output=True, text=True)
    world.check(done.returncode == 0, f"trb reload: {done.stdout}{done.stderr}")
    seen = wait_until(lambda: fleet.counters(CLOUD).get("refused.foreign_fleet", 0) > before, 40) is not None
    world.check(seen, "north's cloud does not refuse a node of south by name (refused.foreign_fleet)")
    world.check("cow" not in fleet.routes(CLOUD), "a node of south is in north's table")
    world.load_firewall()
    world.say("a node of another fleet inside the tunnel's net, without a firewall: refused.foreign_fleet")


def net_seed(fleet):
    from net_fleet import seed_of
    return seed_of(fleet.dir(CLOUD), fleet.tenant.cloud)


def add_way(world, host, address):
    """As the host's own root could: the way into the tunnel for another address than its cloud's."""
    device = world.tunnels.robot_device
    recipes.lab_of.run("ip", "-n", world.lab.space(host), "route", "replace", f"{address}/32", "dev", device)
    if world.tunnels.kind == "wireguard":
        name = f"{world.south.name}-{host}"
        key = world.tunnels.keys[f"{world.south.name}-cloud"][1]
        world.tunnels.wg(name, "set", device, "peer", key, "allowed-ips", f"{world.south.cloud}/32,{address}/32")


def two_tenants(world):
    """By what each of them could look into: taps, tables, certificates, databases, folders, the network."""
    north, south = world.fleets
    foreign = {north: list(SOUTH), south: list(NORTH)}
    taps = {fleet: fleet.tap(8) for fleet in world.fleets}
    runs = {north: RUN, south: {"name": "south", "tasks": [{"id": "only", "robot": "cow", "skill": "run"}]}}
    ids = {fleet: fleet.submit(scenario) for fleet, scenario in runs.items()}
    for fleet, run in ids.items():
        view = fleet.wait_ended(run)
        world.check(view["state"] == "FINISHED", f"{fleet.name}: the run beside the other tenant's is {view['state']}")
    for fleet, tap in taps.items():
        heard = tap.communicate(timeout=60)[0]
        lines = heard.splitlines()
        world.check(len(lines) > 10 and any(own in heard for own in fleet.robots), f"{fleet.name}: the tap heard {len(lines)} lines")
        told = [name for name in foreign[fleet] if f'"{name}"' in heard]
        told += [ids[other] for other in world.fleets if other is not fleet and ids[other] in heard]
        world.check(not told, f"{fleet.name}'s tap heard of {told}")
        world.notes[f"tap_lines_{fleet.name}"] = len(lines)
    for fleet in world.fleets:
        for node in fleet.node_names:
            strange = [name for name in fleet.routes(node) if name not in fleet.node_names]
            world.check(not strange, f"{fleet.name}: {node}'s table has {strange}")
        rows = fleet.words_of_database()
        world.check(all(name in rows for name in fleet.robots), f"{fleet.name}: capability.db lacks its own robots")
        world.check(not [name for name in foreign[fleet] if f"'{name}'" in rows], f"{fleet.name}: capability.db has the other's robots")
        other = south if fleet is north else north
        theirs = other.dir(CLOUD)
        for file in ("keys/certificate.json", "keys/link.key", "state/capability.db", "node.json"):
            done = subprocess.run(fleet.as_user("cat", theirs / file), capture_output=True)
            world.check(done.returncode != 0, f"{fleet.name}'s user reads {other.name}'s {file}")
        done = subprocess.run(fleet.as_user(PROGRAMS / "trb", "tap", "--timeout", "2", "--node", theirs), capture_output=True)
        world.check(done.returncode != 0, f"{fleet.name}'s user opens {other.name}'s tap")
    fleets = {fleet.name: fleet.json("fleet", "show", fleet.dir(CLOUD)) for fleet in world.fleets}
    world.notes["fleets"] = {name: shown.get("fleet") or shown.get("authority") for name, shown in fleets.items()}
    ids = [json.dumps(value, sort_keys=True) for value in world.notes["fleets"].values()]
    world.check(ids[0] != ids[1] and "null" not in ids, f"the certificates name {ids}")
    # Positive first: what is not reached is not merely dead.
    world.check(world.dial("cow", world.south.cloud), "cow does not reach its own cloud")
    add_way(world, "cow", world.north.cloud)
    world.check(not world.dial("cow", world.north.cloud), "cow reaches north's cloud")
    add_way(world, "cow", world.north.nodes["ant"])
    world.check(not world.dial("cow", world.north.nodes["ant"]), "cow reaches ant")
    world.say("two tenants on one host: neither's taps, tables, certificates, databases, folders, addresses are the other's")


def revoked_client(world):
    """OpenVPN alone has certificates: one that was revoked ends at the server, by the list."""
    if world.tunnels.kind != "openvpn":
        return
    fleet = world.fleets[1]
    world.tunnels.revoke(world.south, "cow")
    world.tunnels.stop_robot(world.south, "cow")
    again = world.tunnels
    profile = again.root / "south" / "client-cow" / "talkrobots.conf"
    again.raise_robot(world.south, "cow", "cow", world.cloud, profile.read_text())
    again.wait_refused(world.south)
    world.check(wait_until(lambda: fleet.routes(CLOUD)["cow"]["state"] == "OFFLINE", 40) is not None, "a revoked client is still in the fleet")
    world.say("a revoked client: refused")


def run_kind(kind, cuts):
    with World(kind) as world:
        try:
            world.start()
            for step in (over_the_vpn, lambda w: cut_and_back(w, cuts), two_tenants, foreign_client, revoked_client):
                step(world)
        except (RuntimeError, TimeoutError, KeyError) as problem:
            world.check(False, f"{type(problem).__name__}: {problem}")
        return {"vpn": kind, **world.notes, "faults": world.faults}


def what_is_missing():
    if not pathlib.Path("/dev/net/tun").exists():
        return "needs /dev/net/tun"
    return hosts.why_not("openvpn", "wireguard-go", "wg", "setpriv", "nsenter")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("kinds", nargs="*", choices=[[], *recipes.KINDS], metavar="openvpn|wireguard")
    parser.add_argument("--cuts", type=int, default=2)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    if missing := what_is_missing():
        skips.leave(f"scripts/test-vpn {missing}")
    began = time.monotonic()
    results = [run_kind(kind, arguments.cuts) for kind in arguments.kinds or recipes.KINDS]
    for result in results:
        print("  ".join(f"{key} = {value}" for key, value in result.items() if key != "faults"))
        for fault in result["faults"]:
            print(f"{result['vpn']}: FAULT {fault}")
    faults = sum(len(result["faults"]) for result in results)
    print(f"{len(results)} kinds of VPN, {faults} faults, {time.monotonic() - began:.0f} s")
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    return 1 if faults else 0


if __name__ == "__main__":
    trb_fleet.run_main(main, "scripts/test-vpn")
