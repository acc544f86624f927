"""A Docker engine of the test's own: started, and stopped by its pid; its socket and its data lie in folders of its own."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile

import trb_fleet
from trb_process import wait_until

DOCKER, COMPOSE = "/usr/bin/docker", "/usr/bin/docker-compose"  # Debian's, whatever else lies on the path
UP_S = 60


class Engine:
    def __init__(self, data):
        self.data = pathlib.Path(data)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="trbd-", dir="/tmp"))  # short: it holds sockets
        self.process = None

    def __enter__(self):
        self.data.mkdir(parents=True, exist_ok=True)
        self.log = open(self.folder / "log", "ab")
        command = ["dockerd", "--iptables=false", "--ip6tables=false", "--ip-forward=false", "--bridge=none",
                   "--data-root", self.data, "--exec-root", self.folder / "exec", "--pidfile", self.folder / "pid",
                   "--host", self.host()]
        self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=self.log,
                                        stderr=self.log, preexec_fn=self.apart)
        try:
            wait_until(lambda: self.process.poll() is not None or self.answers(), UP_S, 0.2)
            if self.process.poll() is not None or not self.answers():
                raise RuntimeError(f"dockerd does not start: {(self.folder / 'log').read_text()[-600:]}")
        except BaseException:
            self.__exit__()
            raise
        return self

    def answers(self):
        return self.docker("version", check=False).returncode == 0

    @staticmethod
    def apart():
        """Ctrl-C is this program's: it brings the containers down first. The engine ends with this program."""
        os.setpgid(0, 0)
        trb_fleet.end_with_parent()

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def host(self):
        return f"unix://{self.folder}/sock"

    def env(self, **more):
        return dict(os.environ, DOCKER_HOST=self.host(), DOCKER_BUILDKIT="1", DOCKER_CONFIG=str(self.folder / "config"),
                    DOCKER=DOCKER, COMPOSE_HTTP_TIMEOUT="180", PATH=f"/usr/bin:/usr/sbin:/bin:/sbin:{os.environ.get('PATH', '')}", **more)

    def docker(self, *words, check=True, timeout=120, **more):
        done = subprocess.run([DOCKER, *map(str, words)], capture_output=True, text=True, timeout=timeout, env=self.env(), **more)
        if check and done.returncode != 0:
            raise RuntimeError(f"docker {' '.join(map(str, words))}: {done.stderr.strip()[-600:]}")
        return done

    def inspect(self, what):
        return json.loads(self.docker("inspect", what).stdout)[0]

    def build(self, target, arguments, context):
        """What it says goes to a file beside the data; its end is told if it fails."""
        log = self.data.with_name(f"{self.data.name}-{target}.log")
        words = [word for name, value in arguments.items() for word in ("--build-arg", f"{name}={value}")]
        with open(log, "w") as out:
            done = subprocess.run([DOCKER, "build", "--network=host", "--progress=plain", *words, "-f",
                                   "deploy/compose/Dockerfile", "--target", target, "-t", f"talkrobots-{target}", "."],
                                  cwd=context, stdout=out, stderr=out, env=self.env())
        if done.returncode != 0:
            raise RuntimeError(f"docker build {target}: see {log}\n" + "\n".join(log.read_text().splitlines()[-8:]))


class Composition:
    """One compose file, up while the `with` lasts."""

    def __init__(self, engine, file, project, **env):
        self.engine, self.file, self.project, self.more = engine, file, project, env

    def compose(self, *words, check=True, timeout=300):
        done = subprocess.run([COMPOSE, "-f", str(self.file), "-p", self.project, *words], capture_output=True, text=True,
                              timeout=timeout, env=self.engine.env(**self.more))
        if check and done.returncode != 0:
            raise RuntimeError(f"docker-compose {' '.join(words)}: {done.stderr.strip()[-900:]}")
        return done

    def __enter__(self):
        try:
            self.compose("up", "-d")
            rows = [self.engine.inspect(one) for one in self.compose("ps", "-q", "-a").stdout.split()]
            self.names = {row["Config"]["Labels"]["com.docker.compose.service"]: row["Name"].strip("/") for row in rows}
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.compose("down", "--timeout", "8", check=False)

    def down(self):
        """What is left afterwards: containers, networks, volumes, bridges. Nothing is right."""
        self.compose("down", "--timeout", "8")
        left = self.engine.docker("ps", "-aq").stdout.split() + self.engine.docker("volume", "ls", "-q").stdout.split()
        left += [n for n in self.engine.docker("network", "ls", "--format", "{{.Name}}").stdout.split()
                 if n not in ("bridge", "host", "none")]
        links = subprocess.run(["ip", "-o", "link", "show", "type", "bridge"], capture_output=True, text=True).stdout
        return left + [line.split(":")[1].strip() for line in links.splitlines() if ": br-" in line]

    def pid(self, service):
        return self.engine.inspect(self.names[service])["State"]["Pid"]

    def trb(self, service, *words, check=True, timeout=60):
        return self.engine.docker("exec", self.names[service], "/usr/bin/trb", *words, "--node", "/node", check=check, timeout=timeout)

    def json(self, service, *words):
        done = self.trb(service, *words, "--json", check=False)
        try:
            return json.loads(done.stdout.splitlines()[-1]) if done.stdout.strip() else {}
        except ValueError:
            return {}

    def address(self, service, network):
        return self.engine.inspect(self.names[service])["NetworkSettings"]["Networks"][f"{self.project}_{network}"]["IPAddress"]

    def cut(self, service, network):
        address = self.address(service, network)
        self.engine.docker("network", "disconnect", f"{self.project}_{network}", self.names[service])
        return address

    def mend(self, service, network, address):
        self.engine.docker("network", "connect", "--ip", address, f"{self.project}_{network}", self.names[service])

    def kill(self, service, how="KILL"):
        self.engine.docker("kill", "--signal", how, self.names[service])

    def start(self, service):
        self.engine.docker("start", self.names[service])

    def log_of(self, service):
        return self.engine.docker("logs", self.names[service]).stdout
