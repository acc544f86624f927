"""Hosts on one machine: a network namespace each, joined by the bridge of a switch that is a namespace of its own.

Every name begins with trbn and the lab's tag, so that several labs stand side by side and none touches another.
"""
import contextlib
import itertools
import pathlib
import signal
import subprocess
import sys

DELAY = pathlib.Path(__file__).resolve().parent / "delay.py"


def run(*words, check=True):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if check and done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def batch(lines):
    """Many `ip` commands; consecutive ones for the same "-n SPACE" go to one process."""
    for space, group in itertools.groupby(lines, lambda line: line.split()[1] if line.startswith("-n ") else ""):
        words = "\n".join(line.split(" ", 2)[2] if space else line for line in group) + "\n"
        done = subprocess.run(["ip", *(["-n", space] if space else []), "-batch", "-"], input=words, capture_output=True,
                              text=True)
        if done.returncode != 0:
            raise RuntimeError(f"ip {space}: {words}: {done.stderr.strip()}")


@contextlib.contextmanager
def neighbours_allowed(count):
    """All namespaces share one bound on known neighbours (1024 by default); fifty hosts know 2450. Restored later."""
    before = {}
    try:
        for family in ("ipv4", "ipv6"):
            for threshold in ("gc_thresh3", "gc_thresh2", "gc_thresh1"):
                path = pathlib.Path(f"/proc/sys/net/{family}/neigh/default/{threshold}")
                if path.exists() and int(path.read_text()) < count:
                    before[path] = path.read_text().strip()
                    print(f"lab: {path} is raised from {before[path]} to {count} for this case", flush=True)
                    path.write_text(str(count))
        yield
    finally:
        for path, value in reversed(before.items()):
            path.write_text(value)


class Lab:
    """A switch and its hosts. Addresses: IPv4 10.77.0.N/24 and, if asked for, IPv6 fd77::N/64."""

    def __init__(self, tag):
        self.tag = tag
        self.switch = f"trbn{tag}-sw"
        self.hosts = {}
        self.subnets = {}  # host -> the third number of its address; 77 if it is not named here
        self.helpers = []
        self.spaces = []

    def __enter__(self):
        try:
            self.make_space(self.switch)
            batch([f"-n {self.switch} link set lo up", f"-n {self.switch} link add br0 type bridge",
                   f"-n {self.switch} link set br0 up"])
            self.nft("add table bridge lab")
            self.nft("add chain bridge lab between { type filter hook forward priority 0; }")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for helper in self.helpers:
            helper.kill()
            helper.wait()
        for space in reversed(self.spaces):
            run("ip", "netns", "del", space, check=False)

    def make_space(self, name):
        run("ip", "netns", "del", name, check=False)  # of a run that was killed
        run("ip", "netns", "add", name)
        self.spaces.append(name)
        return name

    def space(self, host):
        return f"trbn{self.tag}-{host}"

    def port(self, host):
        return f"p-{host}"

    def inside(self, host, *words):
        """The command line that runs a program on that host."""
        return ["ip", "netns", "exec", self.space(host), *map(str, words)]

    # ---- building

    def add_hosts(self, names, family=4):
        """`family` 0: no address but the link-local one that the kernel makes."""
        for name in names:
            self.hosts[name] = len(self.hosts) + 1
            self.make_space(self.space(name))
        batch([f"link add {self.port(name)} netns {self.switch} type veth peer name eth0 netns {self.space(name)}"
               for name in names])
        batch([f"-n {self.switch} link set {self.port(name)} {what}" for name in names for what in ("master br0", "up")])
        lines = []
        for name in names:
            at = self.space(name)
            lines += [f"-n {at} link set lo up", f"-n {at} link set eth0 up"]
            if family == 4:
                lines.append(f"-n {at} addr add {self.address(name)}/24 brd 10.77.0.255 dev eth0")
            if family == 6:
                lines.append(f"-n {at} addr add {self.address6(name)}/64 dev eth0 nodad")
        batch(lines)

    def address(self, host):
        return f"10.{self.subnets.get(host, 77)}.0.{self.hosts[host]}"

    def address6(self, host):
        return f"fd77::{self.hosts[host]:x}"

    def add_hall(self, names, gate="gate"):
        """A second switch with hosts of its own, 10.78.0.0/24, behind a host that forwards and does not translate: no
        broadcast goes through. Its cable is the gate's: pull_cable("gate")."""
        self.add_hosts([gate])
        batch([f"-n {self.switch} link add br1 type bridge", f"-n {self.switch} link set br1 up",
               f"link add p-hall netns {self.switch} type veth peer name eth1 netns {self.space(gate)}",
               f"-n {self.switch} link set p-hall master br1", f"-n {self.switch} link set p-hall up",
               f"-n {self.space(gate)} addr add 10.78.0.{self.hosts[gate]}/24 dev eth1",
               f"-n {self.space(gate)} link set eth1 up"])
        run("ip", "netns", "exec", self.space(gate), "sysctl", "-qw", "net.ipv4.ip_forward=1")
        for name in names:
            self.subnets[name] = 78
            self.hosts[name] = len(self.hosts) + 1
            at = self.make_space(self.space(name))
            batch([f"link add {self.port(name)} netns {self.switch} type veth peer name eth0 netns {at}",
                   f"-n {self.switch} link set {self.port(name)} master br1",
                   f"-n {self.switch} link set {self.port(name)} up",
                   f"-n {at} link set lo up", f"-n {at} link set eth0 up",
                   f"-n {at} addr add {self.address(name)}/24 brd 10.78.0.255 dev eth0"])
        for name in self.hosts:
            if name != gate:
                near = "10.78.0" if name in names else "10.77.0"
                run("ip", "-n", self.space(name), "route", "add", "default", "via", f"{near}.{self.hosts[gate]}")

    def add_far_host(self, name):
        """A host on no switch: only a tunnel may lead to it."""
        self.hosts[name] = len(self.hosts) + 1
        at = self.make_space(self.space(name))
        batch([f"-n {at} link set lo up"])

    def raise_tunnel(self, one, other):
        """A VPN between two hosts: tun0 at both ends, 10.88.0.0/24."""
        ends = [(self.space(host), f"10.88.0.{self.hosts[host]}") for host in (one, other)]
        batch([f"link add tun0 netns {ends[0][0]} type veth peer name tun0 netns {ends[1][0]}"] +
              [line for at, address in ends for line in
               (f"-n {at} addr add {address}/24 brd 10.88.0.255 dev tun0", f"-n {at} link set tun0 up")])

    def drop_tunnel(self, host):
        """The VPN's program has ended: the interface is gone at both ends."""
        run("ip", "-n", self.space(host), "link", "del", "tun0")

    def add_delayed_host(self, name, delay_ms):
        """Its cable is two taps joined by a program that holds every frame back: this kernel has no netem."""
        self.hosts[name] = len(self.hosts) + 1
        at = self.make_space(self.space(name))
        helper = subprocess.Popen([sys.executable, str(DELAY), self.switch, self.port(name), at, "eth0", str(delay_ms)],
                                  stdout=subprocess.PIPE, text=True)
        self.helpers.append(helper)
        if helper.stdout.readline().strip() != "ready":
            raise RuntimeError("delay.py did not start")
        batch([f"-n {at} link set lo up", f"-n {self.switch} link set {self.port(name)} master br0",
               f"-n {self.switch} link set {self.port(name)} up", f"-n {at} link set eth0 up",
               f"-n {at} addr add {self.address(name)}/24 brd 10.77.0.255 dev eth0"])
        return helper

    def add_nat_host(self, name):
        """A host on a network of its own behind an address translator: it can dial out, nobody can dial it."""
        gate, at = f"{name}-nat", self.make_space(self.space(name))
        self.add_hosts([gate])
        inner = 100 + self.hosts[gate]
        gate_space = self.space(gate)
        batch([f"link add in0 netns {gate_space} type veth peer name eth0 netns {at}",
               f"-n {gate_space} addr add 192.168.{inner}.1/24 dev in0", f"-n {gate_space} link set in0 up",
               f"-n {at} link set lo up", f"-n {at} link set eth0 up",
               f"-n {at} addr add 192.168.{inner}.2/24 brd 192.168.{inner}.255 dev eth0",
               f"-n {at} route add default via 192.168.{inner}.1"])
        run("ip", "netns", "exec", gate_space, "sysctl", "-qw", "net.ipv4.ip_forward=1")
        for words in ("add table ip nat", "add chain ip nat out { type nat hook postrouting priority 100; }",
                      "add rule ip nat out oifname eth0 masquerade"):
            run("ip", "netns", "exec", gate_space, "nft", *words.split())
        return gate

    # ---- faults, and their end

    def nft(self, words):
        return run("ip", "netns", "exec", self.switch, "nft", *words.split())

    def pull_cable(self, host):
        run("ip", "-n", self.switch, "link", "set", self.port(host), "down")

    def plug_cable(self, host):
        run("ip", "-n", self.switch, "link", "set", self.port(host), "up")

    def switch_dies(self):
        batch([f"-n {self.switch} link set {self.port(host)} nomaster" for host in self.hosts])

    def switch_returns(self):
        batch([f"-n {self.switch} link set {self.port(host)} master br0" for host in self.hosts])

    def one_way_cut(self, host):
        """What the host sends is lost; it still receives from the others."""
        self.nft(f"add rule bridge lab between iifname {self.port(host)} drop")

    def cut_between(self, one, other):
        for a, b in ((one, other), (other, one)):
            self.nft(f"add rule bridge lab between iifname {self.port(a)} oifname {self.port(b)} drop")

    def lose(self, host, percent):
        for side in ("iifname", "oifname"):
            self.nft(f"add rule bridge lab between {side} {self.port(host)} numgen random mod 100 < {percent} drop")

    def drop_large(self, host, size):
        """A path with a smaller MTU that is not signalled: larger packets vanish, both ways."""
        for side in ("iifname", "oifname"):
            self.nft(f"add rule bridge lab between {side} {self.port(host)} meta length > {size} drop")

    def heal_rules(self):
        self.nft("flush chain bridge lab between")

    def rename(self, host, old, new):
        """An interface goes, or comes, by its name."""
        batch([f"-n {self.space(host)} link set {old} down", f"-n {self.space(host)} link set {old} name {new}",
               f"-n {self.space(host)} link set {new} up"])

    def add_vpn(self, host, address):
        batch([f"-n {self.space(host)} link add tun0 type bridge", f"-n {self.space(host)} link set tun0 up",
               f"-n {self.space(host)} addr add {address}/24 dev tun0"])

    def remove_vpn(self, host):
        run("ip", "-n", self.space(host), "link", "del", "tun0")

    def change_address(self, host, old, new):
        """As a new lease of DHCP: the old address goes, then the new one comes."""
        at = self.space(host)
        run("ip", "-n", at, "addr", "del", f"{old}/24", "dev", "eth0")
        run("ip", "-n", at, "addr", "add", f"{new}/24", "brd", "10.77.0.255", "dev", "eth0")


def end(process, how=signal.SIGTERM, wait=8):
    if process.poll() is None:
        process.send_signal(how)
    try:
        process.wait(wait)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
