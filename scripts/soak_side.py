"""What goes on beside the runs of scripts/soak: the page, a sensor that comes and goes, members that join and are revoked."""
import json
import pathlib
import shutil
import sys
import threading

import trb_fleet
from fault_fleet import FaultFleet, TEMPERATURE, WHOLE_S
from trb_fleet import CLOUD

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "support"))
import gateway_client  # noqa: E402

PASSWORD = "a good long password"
TOPICS = ("fleet", "alerts")  # as the real page: all rows of the fleet, its runs among them
SMALL = {"proof_log_mb": 8, "archive_mb": 2}


class SoakFleet(FaultFleet):
    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "node.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), **SMALL}, indent=2) + "\n")

    def start(self):
        trb_fleet.Fleet.start(self)
        self.wait_formed(WHOLE_S)
        self.plug()

    def plug(self):
        self.thermometer = self.side.plug_temperature(TEMPERATURE)
        self.wait("the cloud knows the thermometer", self.knows_sensor, WHOLE_S)

    def plug_anew(self):
        """Unplugged, and plugged in; where there can be no hall, left alone."""
        if not self.side.hall:
            return False
        self.thermometer.unplug()
        self.wait("the cloud knows that it is gone", lambda: not self.knows_sensor(), WHOLE_S)
        self.plug()
        return True

    # ---- a member that joins, and is put out

    def visit(self, number):
        name = f"visitor{number}"
        folder = self.dir(name)
        folder.mkdir()
        for file in ("profile.json", "commands.json", "places.json"):
            shutil.copy(self.dir(CLOUD) / file, folder)
        network = json.loads((self.dir(CLOUD) / "network.json").read_text())
        (folder / "network.json").write_text(json.dumps({**network, "HOST_INT": f"127.0.{self.block}.100"}))
        (folder / "node.json").write_text(json.dumps({"id": name, "role": "cloud", "services": ["router", "scheduler"], **SMALL}))
        self.trb("fleet", "request", folder)
        self.trb("fleet", "sign", self.authority_dir(), folder / "keys" / "request.json")
        visitor = trb_fleet.Process([self.programs / "trb", "up", folder, "--die-with-parent"], self.root / "up-visitor.log")
        try:
            self.wait(f"{name} is a member", lambda: self.is_online(name), WHOLE_S)
            self.trb("fleet", "revoke", self.authority_dir(), name, "--reason", "the soak", "--via", self.dir(CLOUD))
            self.wait(f"{name} is out", lambda: not self.is_online(name), WHOLE_S)
        finally:
            visitor.stop()
        shutil.rmtree(folder)

    def is_online(self, node):
        routes = self.ask("route", "list").get("routes")
        return routes is not None and any(row["id"] == node and row["state"] == "ONLINE" for row in routes)


class Page:
    """A page that is open all the time: it signs in, hears the live stream, and comes back when the gateway was killed."""

    def __init__(self, fleet):
        self.fleet = fleet
        self.heard, self.opened, self.refused = 0, 0, []
        self.socket = None
        self.end = threading.Event()
        first = fleet.json("cloud", "password", fleet.dir(CLOUD))["password"]
        client = self.client()
        client.sign_in("admin", first)
        client.ask("PUT", "/api/v1/me/password", {"old": first, "new": PASSWORD})
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def client(self):
        return gateway_client.Client(self.fleet.gateway_port, self.fleet.dir(CLOUD) / "keys" / "gateway.crt")

    def run(self):
        while not self.end.wait(1.0):
            try:
                self.listen(self.client())
            except (OSError, EOFError, TimeoutError, ValueError, IndexError):
                pass  # the gateway was killed: the page tries again

    def listen(self, client):
        if client.sign_in("admin", PASSWORD).status != 201:
            return
        self.socket = client.live()
        self.opened += 1
        for topic in TOPICS:
            self.socket.say({"subscribe": topic})
        while not self.end.is_set() and "closed" not in (said := self.socket.hear()):
            if "error" in said:
                self.refused.append(f"the page was refused: {said['error'].get('title')}: {said['error'].get('detail')}")
            self.heard += 1

    def close(self):
        self.end.set()
        if self.socket:
            self.socket.close()
        self.thread.join(30)
