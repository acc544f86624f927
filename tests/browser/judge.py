"""Stoplight's prism as a proxy before a gateway: another maker's program that holds every answer against openapi.json."""
import os
import pathlib
import re
import subprocess

import support
import trb_fleet

HERE = pathlib.Path(__file__).resolve().parent
PRISM = HERE / "prism/node_modules/@stoplight/prism-cli/dist/index.js"
DESCRIPTION = trb_fleet.REPO / "services/cloud-gateway/api/openapi.json"
HOSTILE = "hit("  # in the texts of story_hostile.mjs: an address with one is refused, as it should be
LEAST_NODE = 20  # a dependency of prism is an ES module alone
REFUSED = re.compile(r"\[HTTP SERVER\] (\w+ \S+) .*stoplight\.io/prism/errors#(.*)")
COLOURS = re.compile(r"\x1b\[[0-9;]*m")


def why_not():
    """What is missing for it; empty: nothing."""
    version = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout.strip().lstrip("v")
    if int(version.split(".")[0]) < LEAST_NODE:
        return f"prism needs Node {LEAST_NODE} or newer, this is {version}"
    return "" if PRISM.exists() else "prism is not installed: scripts/test-browser --prism does it"


class Judge:
    """An answer that the description does not allow reaches the page as an error, and stands in the log."""

    def __init__(self, gateway, certificate, log):
        self.port = trb_fleet.free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.path = pathlib.Path(log)
        command = ["node", PRISM, "proxy", DESCRIPTION, gateway, "--errors", "--port", str(self.port)]
        self.log = open(log, "wb")
        self.child = subprocess.Popen(command, env=dict(os.environ, NODE_EXTRA_CA_CERTS=str(certificate), NO_COLOR="1"),
                                      stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log,
                                      preexec_fn=trb_fleet.end_with_parent)
        support.wait_until("prism listens", lambda: trb_fleet.answers(("127.0.0.1", self.port)), 60)

    def refused(self):
        """What the description does not allow, of requests and of answers. That nobody was signed in is no fault."""
        lines = COLOURS.sub("", self.path.read_text(errors="replace")).splitlines()
        found = [REFUSED.search(line) for line in lines]
        return sorted({f"{one[1]}: {one[2]}" for one in found
                       if one and not one[2].startswith("UNAUTHORIZED") and HOSTILE not in one[1]})

    def judged(self):
        """How many answers it has passed on."""
        return self.path.read_text(errors="replace").count("The upstream call to")

    def verdict(self):
        """Prints what it has found; 0: nothing."""
        found, judged = self.refused(), self.judged()
        print(f"== prism: {judged} answers judged, {len(found)} kinds of exchanges that openapi.json does not allow")
        for one in found:
            print(f"     {one}")
        return 1 if found or judged == 0 else 0

    def stop(self):
        self.child.terminate()
        self.child.wait()
        self.log.close()
