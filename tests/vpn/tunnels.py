"""Tunnels between the hosts of a lab, by the recipes of deploy/vpn: the same files, filled in; nothing beside them.

Each kind makes a tenant's authority or keys, the cloud's end and the robots' ends, and what a stranger would bring.
"""
import os
import pathlib
import re
import shutil
import subprocess

import lab as lab_of
import trb_fleet
from trb_process import wait_until

RECIPES = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "vpn"
UP_S = 30  # a deadline, not a measurement


def filled(path, **words):
    """A recipe with its words; one that is left over is a fault of the recipe or of the test."""
    text = path.read_text()
    for word, value in words.items():
        text = text.replace(f"@{word}@", str(value))
    left = re.search(r"^[^#\n]*@([A-Z_]+)@", text, re.MULTILINE)
    if left:
        raise RuntimeError(f"{path}: @{left[1]}@ is not filled in")
    return text


def defined(path, **definitions):
    """Rules of nft with other definitions."""
    text = path.read_text()
    for name, value in definitions.items():
        text, count = re.subn(rf"^define {name} = .*$", f"define {name} = {value}", text, flags=re.MULTILINE)
        if count != 1:
            raise RuntimeError(f"{path}: defines no {name}")
    return text


def load_rules(lab, host, text):
    subprocess.run(lab.inside(host, "nft", "-f", "-"), input=text, text=True, check=True)


class Tenant:
    """`number` makes its network 10.NUMBER.0.0/24, its port and its device at the cloud."""

    def __init__(self, name, number, port):
        self.name, self.number, self.port = name, number, port
        self.network = f"10.{number}.0"
        self.cloud = f"{self.network}.1"
        self.nodes = {}  # node -> its address in the tunnel

    def add(self, node):
        self.nodes[node] = f"{self.network}.{11 + len(self.nodes)}"
        return self.nodes[node]


def wait(what, condition, timeout=UP_S):
    took = wait_until(condition, timeout)
    if took is None:
        raise TimeoutError(f"{what}: not within {timeout} s")
    return took


def address_of(lab, host, device):
    out = subprocess.run(["ip", "-n", lab.space(host), "-4", "-o", "addr", "show", "dev", device], capture_output=True,
                         text=True).stdout
    found = re.search(r"inet ([0-9.]+)", out)
    return found[1] if found else None


class Tunnels:
    """The processes that carry a recipe's tunnels, by "TENANT-HOST"."""

    def __init__(self, lab, root, cloud_host):
        self.lab, self.root, self.cloud_host = lab, root, cloud_host
        self.processes = {}

    def pump(self):
        for process in self.processes.values():
            process.pump(0)

    def stop_robot(self, tenant, host):
        self.processes.pop(f"{tenant.name}-{host}").stop()

    def stop(self):
        for process in self.processes.values():
            process.stop()


class OpenVpn(Tunnels):
    kind = "openvpn"
    robot_device = "tun0"

    @staticmethod
    def device(tenant):
        return f"tun-{tenant.name}"

    def pki(self, tenant, *words):
        done = subprocess.run([RECIPES / "openvpn" / "pki", self.root / tenant.name / "pki", *map(str, words)],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"pki {words}: {done.stderr}")
        return done.stdout

    def make(self, tenant):
        self.pki(tenant, "init", tenant.name)
        self.pki(tenant, "server", "cloud")
        for node in tenant.nodes:
            self.pki(tenant, "client", node)

    def raise_cloud(self, tenant):
        # The server gives up its rights once it is up: what it reads later must be open to it.
        folder = self.root / tenant.name / "server"
        (folder / "nodes").mkdir(parents=True)
        for name in ("ca.crt", "tls-crypt.key", "crl.pem", "cloud.crt", "cloud.key"):
            shutil.copy(self.root / tenant.name / "pki" / name, folder / name)
        (folder / "server.conf").write_text(filled(RECIPES / "openvpn/server.conf", TENANT=tenant.name, PORT=tenant.port,
                                                   NETWORK=f"{tenant.network}.0", SERVER="cloud", FOLDER=folder))
        for node, address in tenant.nodes.items():
            (folder / "nodes" / node).write_text(f"ifconfig-push {address} 255.255.255.0\n")
        for path in (folder, folder / "nodes"):
            path.chmod(0o755)
        for path in (folder / "nodes").iterdir():
            path.chmod(0o644)
        # As systemd's unit starts it: not in the tenant's folder.
        self.start(f"{tenant.name}-cloud", self.cloud_host, folder.parent, folder / "server.conf")

    def revoke(self, tenant, node):
        self.pki(tenant, "revoke", node)
        shutil.copy(self.root / tenant.name / "pki" / "crl.pem", self.root / tenant.name / "server" / "crl.pem")

    def profile(self, tenant, node, at):
        """As a robot's PC gets it, from the tenant's authority; `at`: the cloud that it is to dial."""
        return self.pki(tenant, "profile", node, at, tenant.port)

    def raise_robot(self, tenant, node, host, at, profile=None):
        folder = self.root / tenant.name / f"client-{host}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "talkrobots.conf").write_text(profile or self.profile(tenant, node, at))
        self.start(f"{tenant.name}-{host}", host, folder, "talkrobots.conf", wait_up=profile is None)

    def start(self, name, host, folder, file, wait_up=True):
        command = self.lab.inside(host, "openvpn", "--cd", folder, "--config", file)
        self.processes[name] = trb_fleet.Process(command, self.root / f"openvpn-{name}.log")
        if wait_up:
            self.processes[name].wait_line("Initialization Sequence Completed", UP_S)

    def stranger(self, tenant, host, at):
        """Whoever has made an authority of his own: it signs the same names, and knows the tunnel's common key."""
        false = Tenant(f"{tenant.name}-false", tenant.number, tenant.port)
        self.pki(false, "init", tenant.name)
        self.pki(false, "server", "cloud")
        self.pki(false, "client", next(iter(tenant.nodes)))
        profile = self.profile(false, next(iter(tenant.nodes)), at)
        common = (self.root / tenant.name / "pki" / "tls-crypt.key").read_text()
        common = common[common.index("-----BEGIN"):].strip()
        true_ca = (self.root / tenant.name / "pki" / "ca.crt").read_text().strip()
        profile = re.sub(r"<tls-crypt>.*</tls-crypt>", f"<tls-crypt>\n{common}\n</tls-crypt>", profile, flags=re.DOTALL)
        profile = re.sub(r"<ca>.*</ca>", f"<ca>\n{true_ca}\n</ca>", profile, flags=re.DOTALL)
        self.raise_robot(false, "stranger", host, at, profile)
        return false

    def wait_refused(self, tenant):
        """The cloud's end says why it did not let somebody in."""
        process = self.processes[f"{tenant.name}-cloud"]
        wait("the refusal", lambda: process.pump(0) and any("VERIFY ERROR" in line for line in process.lines))
        return next(line for line in process.lines if "VERIFY ERROR" in line)

    @staticmethod
    def let_in(tenant):
        """Nothing to show here: the server has said itself what was wrong."""
        return False


class WireGuard(Tunnels):
    """By wireguard-go, where the kernel has no WireGuard: the same files as for wg-quick."""
    kind = "wireguard"
    robot_device = "wg0"

    def __init__(self, lab, root, cloud_host):
        super().__init__(lab, root, cloud_host)
        self.keys = {}

    @staticmethod
    def device(tenant):
        return f"wg-{tenant.name}"

    def pair(self, name):
        secret = subprocess.run(["wg", "genkey"], capture_output=True, text=True, check=True).stdout.strip()
        public = subprocess.run(["wg", "pubkey"], input=secret, capture_output=True, text=True, check=True).stdout.strip()
        self.keys[name] = secret, public

    def make(self, tenant):
        for node in ("cloud", *tenant.nodes):
            self.pair(f"{tenant.name}-{node}")

    def raise_cloud(self, tenant):
        own = RECIPES / "wireguard/cloud.conf"
        first, block = own.read_text().split("# A block for each node.")
        words = {"TENANT": tenant.name, "NETWORK": tenant.network, "PORT": tenant.port,
                 "PRIVATE_KEY": self.keys[f"{tenant.name}-cloud"][0]}
        text = first + "".join("#" + block.replace("@NODE@", node).replace("@NODE_ADDRESS@", address).replace(
            "@NODE_PUBLIC_KEY@", self.keys[f"{tenant.name}-{node}"][1]) for node, address in tenant.nodes.items())
        for word, value in words.items():
            text = text.replace(f"@{word}@", str(value))
        self.start(f"{tenant.name}-cloud", self.cloud_host, self.device(tenant), text)

    def raise_robot(self, tenant, node, host, at, address=None, secret=None):
        text = filled(RECIPES / "wireguard/robot.conf", ADDRESS=address or tenant.nodes[node], CLOUD=at, PORT=tenant.port,
                      PRIVATE_KEY=secret or self.keys[f"{tenant.name}-{node}"][0],
                      CLOUD_PUBLIC_KEY=self.keys[f"{tenant.name}-cloud"][1], CLOUD_ADDRESS=tenant.cloud)
        self.start(f"{tenant.name}-{host}", host, self.robot_device, text)

    def start(self, name, host, device, text):
        """What `wg-quick up` does with such a file: the device, its keys and peers, its address."""
        path = self.root / f"{name}-wg" / f"{device}.conf"  # wg-quick takes the device's name from the file's
        path.parent.mkdir(mode=0o700)
        path.touch(mode=0o600)
        path.write_text(text)
        # Its control socket is a file, by the device's name alone: each host has a folder of its own for it.
        script = f"mkdir -p /run/wireguard && mount -t tmpfs none /run/wireguard && exec wireguard-go -f {device}"
        process = trb_fleet.Process(self.lab.inside(host, "unshare", "--mount", "sh", "-c", script),
                                    self.root / f"wireguard-{name}.log", env=dict(os.environ, WG_PROCESS_FOREGROUND="1"))
        self.processes[name] = process
        wait(f"{device} of {host} is there", lambda: self.wg(name, "show", device).returncode == 0)
        bare = subprocess.run(["wg-quick", "strip", path], capture_output=True, text=True, check=True).stdout
        set_up = self.wg(name, "setconf", device, "/dev/stdin", text=bare)
        if set_up.returncode != 0:
            raise RuntimeError(f"wg setconf {device}: {set_up.stderr}")
        address = re.search(r"^Address = (\S+)", text, re.MULTILINE)[1]
        lab_of.batch([f"-n {self.lab.space(host)} addr add {address} dev {device}",
                      f"-n {self.lab.space(host)} link set {device} mtu 1420 up"])

    def wg(self, name, *words, text=None):
        command = ["nsenter", "--target", self.processes[name].child.pid, "--mount", "--net", "wg", *words]
        return subprocess.run([str(word) for word in command], input=text, capture_output=True, text=True)

    def stranger(self, tenant, host, at):
        """A key that the cloud's file does not name; everything else is right."""
        self.pair("stranger")
        self.raise_robot(tenant, "stranger", host, at, f"{tenant.network}.99", self.keys["stranger"][0])
        return tenant

    def wait_refused(self, tenant):
        """The cloud's end answers nothing: its peers are those of the file, and all have shaken hands long ago."""
        shown = self.wg(f"{tenant.name}-cloud", "show", self.device(tenant), "peers").stdout.split()
        if self.keys["stranger"][1] in shown:
            raise RuntimeError("the cloud knows the stranger's key")
        return "its key is no peer's"

    def let_in(self, tenant):
        """The stranger's key is written into the cloud's file after all: nothing else kept it out."""
        done = self.wg(f"{tenant.name}-cloud", "set", self.device(tenant), "peer", self.keys["stranger"][1], "allowed-ips",
                       f"{tenant.network}.99/32")
        return done.returncode == 0


KINDS = {one.kind: one for one in (OpenVpn, WireGuard)}
