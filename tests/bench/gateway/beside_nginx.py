"""P8: how many answers a second the gateway gives to GET of one robot, beside nginx that serves the same bytes as a file.

Both by HTTPS with the same certificate, the same ciphers by default, connections that stay open. The server has core 0 and wrk
core 1; in turns, in one run."""
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import fed_gateway  # noqa: E402
import gateway_page  # noqa: E402
import nginx  # noqa: E402
import trb_fleet  # noqa: E402

SERVER, LOAD = 0, 1
ROBOT = "/api/v1/robots/robot-0000"
CONNECTIONS = 16
SERVED = """
sendfile on; tcp_nopush on; keepalive_requests 1000000000;
  open_file_cache max=16;
  default_type application/json;
  server {{
    listen 127.0.0.1:{port} ssl;
    ssl_certificate {certificate};
    ssl_certificate_key {key};
    root {folder}/files;
  }}
"""


def why_not():
    """What is missing; empty: nothing."""
    for name in ("wrk", nginx.PROGRAM):
        if shutil.which(name) is None:
            return f"there is no {name}: apt-get install wrk nginx-light"
    return "" if os.cpu_count() >= 2 else "it needs two cores"


class Nginx:
    """One process that serves one file under the robot's own path."""

    def __init__(self, folder, fleet, body):
        self.port = trb_fleet.free_port()
        file = folder / "files" / ROBOT[1:]
        file.parent.mkdir(parents=True)
        file.write_bytes(body)
        for path in [folder, *(folder / "files").rglob("*")]:
            path.chmod(0o755 if path.is_dir() else 0o644)
        self.child = nginx.start(folder, SERVED.format(folder=folder, port=self.port, certificate=fleet.certificate(),
                                                       key=fleet.certificate().with_suffix(".key")))
        fleet.wait("nginx answers", lambda: trb_fleet.answers(("127.0.0.1", self.port)), 10)
        pin(self.child.pid, SERVER)

    def stop(self):
        self.child.terminate()
        self.child.wait()


def pin(pid, core):
    for task in (pathlib.Path("/proc") / str(pid) / "task").iterdir():
        os.sched_setaffinity(int(task.name), {core})


def load(port, token, seconds):
    """Answers a second, all of them 200; wrk takes whole seconds."""
    command = ["taskset", "-c", LOAD, "wrk", "-t1", f"-c{CONNECTIONS}", f"-d{seconds}s", "-H", f"Authorization: Bearer {token}",
               f"https://localhost:{port}{ROBOT}"]
    said = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True, timeout=seconds + 30).stdout
    if "Non-2xx" in said or "Socket errors" in said:
        raise RuntimeError(f"port {port}: not every request was answered\n{said}")
    return float(re.search(r"Requests/sec:\s*([\d.]+)", said)[1])


def measure(programs, folder, rounds, seconds):
    """One robot that changes once in a thousand seconds: its bytes are the same throughout, but for an age now and then."""
    with fed_gateway.FedGateway(folder / "fleet", programs, 1, 0.001) as fleet:
        fleet.make()
        fleet.start()
        token = fleet.token("load")
        client = gateway_page.client(fleet)
        client.token = token
        fleet.wait("the robot is known", lambda: client.ask("GET", ROBOT).status == 200, 10)
        body = client.ask("GET", ROBOT).bytes
        nginx = Nginx(folder / "nginx", fleet, body)
        try:
            pin(fleet.pid("gateway"), SERVER)
            pin(fleet.pid("feeder"), LOAD)
            ports = {"gateway": fleet.gateway_port, "nginx": nginx.port}
            for port in ports.values():
                load(port, token, 1)
            found = {name: [] for name in ports}
            for i in range(rounds):
                for name in sorted(ports, reverse=i % 2 == 1):
                    found[name].append(load(ports[name], token, seconds))
        finally:
            nginx.stop()
    ratio = statistics.median(a / b for a, b in zip(found["gateway"], found["nginx"]))
    return {"body_bytes": len(body), **found, "ratio": ratio}
