"""What a browser needs of a fleet's gateway, and of this machine."""
import pathlib
import shutil
import subprocess
import sys

REPO = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(REPO / "scripts"), str(REPO / "tests" / "support")]
import demo_page  # noqa: E402
import gateway_client  # noqa: E402
from trb_fleet import CLOUD  # noqa: E402

WEB = REPO / "services/cloud-gateway/web"
PASSWORD = "a good long password"
PEOPLE = {"olga": "operator", "vic": "viewer"}
CHROMIUM = pathlib.Path("/usr/bin/chromium")
LEAST_NODE = (18, 18)


def why_not():
    """What of a browser's test is missing on this machine; empty: nothing."""
    if not CHROMIUM.exists():
        return f"there is no {CHROMIUM}: apt-get install chromium"
    if shutil.which("node") is None:
        return "there is no node: apt-get install nodejs npm"
    version = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout.strip().lstrip("v")
    if tuple(map(int, version.split(".")[:2])) < LEAST_NODE:
        return f"node {version} is too old, {'.'.join(map(str, LEAST_NODE))} is needed"
    if not (WEB / "node_modules/playwright-core").exists():
        return "the page's tools are not installed: scripts/test-page does it"
    return ""


def client(fleet):
    return gateway_client.Client(fleet.gateway_port, fleet.dir(CLOUD) / "keys/gateway.crt")


def open_to_people(fleet):
    """Waits for the gateway, and makes its users. The policy under which it serves its page."""
    fleet.wait("the page is served", lambda: demo_page.is_ready(fleet), 60)
    made = fleet.json("cloud", "password", fleet.dir(CLOUD))["password"]
    admin = client(fleet)
    asked = [("POST", "/api/v1/session", {"user": "admin", "password": made}),
             ("PUT", "/api/v1/me/password", {"old": made, "new": PASSWORD}),
             ("POST", "/api/v1/session", {"user": "admin", "password": PASSWORD})]
    asked += [("POST", "/api/v1/users", {"name": name, "role": role, "password": PASSWORD}) for name, role in PEOPLE.items()]
    for method, path, body in asked:
        answer = admin.sign_in(**body) if path.endswith("/session") else admin.ask(method, path, body)
        if answer.status >= 300:
            raise RuntimeError(f"{method} {path}: {answer.status} {answer.bytes.decode()}")
    return admin.ask("GET", "/").headers["Content-Security-Policy"]
