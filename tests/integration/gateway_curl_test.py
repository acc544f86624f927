"""The curl lines of the gateway's README, in one shell, as somebody would copy them.

Addresses 127.0.238.x, 127.0.239.x.
"""
import json
import os
import pathlib
import subprocess

import shell_blocks
import support
from gateway_case import GOOD, ROBOT, GatewayCase

README = pathlib.Path(__file__).resolve().parents[2] / "services/cloud-gateway/README.md"
STATED = "https://localhost:8443"


def readme_lines():
    block, = shell_blocks.blocks_of(README)  # the README has one block of shell
    return block.text


class Curl(GatewayCase):
    block, udp_port = 238, 50238

    def test_the_readme_lines_do_what_they_say(self):
        lines = readme_lines()
        self.assertEqual(lines.count(STATED), 1, "the address stands once, so that a reader changes it once")
        root = self.fleet.root
        sign_in = root / "sign-in.json"
        sign_in.touch(mode=0o600)
        sign_in.write_text(json.dumps({"user": "root2", "password": GOOD}))
        self.assertEqual(self.admin.ask("POST", "/api/v1/users", {"name": "root2", "role": "admin", "password": GOOD}).status, 201)
        shell = subprocess.run(["bash", "-euo", "pipefail", "-c", lines.replace(STATED, f"https://localhost:{self.port}")], cwd=root,
                               env={**os.environ, "PATH": f"{os.environ['TRB_BIN_DIR']}:{os.environ['PATH']}"},
                               capture_output=True, text=True, timeout=90)
        self.assertEqual(shell.returncode, 0, shell.stdout[-3000:] + shell.stderr)
        self.assertIn(f"{ROBOT} ONLINE", shell.stdout)
        self.assertIn('"hint"', shell.stdout)
        self.assertIn("trb_gateway_", shell.stdout)
        for name in ("session.json", "token.json", "night.curl", "jar"):
            self.assertEqual((root / name).stat().st_mode & 0o77, 0, name)
        self.assertEqual([token["name"] for token in self.admin.ask("GET", "/api/v1/tokens").json["tokens"]], ["night-shift"])


if __name__ == "__main__":
    support.main()
