"""A fleet with two cloud nodes, whose gateways share one database; its caller has the folder of trb_fleet on sys.path."""
import json

import trb_fleet
from trb_fleet import CLOUD

SECOND = "cloud2"
CLOUDS = (CLOUD, SECOND)


class TwoClouds(trb_fleet.Fleet):
    def __init__(self, root, programs, database, authority, **more):
        super().__init__(root, programs, **more)
        self.node_names.append(SECOND)
        self.ports = {CLOUD: self.gateway_port, SECOND: trb_fleet.free_port()}
        self.proxy_port = trb_fleet.free_port()
        self.database, self.authority = database, authority

    def make_node(self, node):
        super().make_node(node)
        if node not in CLOUDS:
            return
        folder = self.dir(node)
        settings = {"listen": f"127.0.0.1:{self.ports[node]}", "names": [f"localhost:{self.proxy_port}"],
                    "database": self.database.url}
        (folder / "cloud.json").write_text(json.dumps(settings) + "\n")
        self.authority.issue(folder / "keys/gateway.crt", folder / "keys/gateway.key")
        secret = folder / "keys/database.password"
        secret.touch(mode=0o600)
        secret.write_text(self.database.password + "\n")
