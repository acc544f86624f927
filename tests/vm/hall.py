"""The fleet in the machine of scripts/test-vm: a cloud node with the page, signed by files as the first one must be, and a robot's
node, which joins by a code. The robot's is the service of the package; the cloud's has a unit of the test's own."""
import json

NODE = "/var/lib/talkrobots/node"
CLOUD = "/var/lib/hall/cloud"
AUTHORITY = "/root/authority"
ADDRESS, CLOUD_ADDRESS, ROBOT_ADDRESS = "127.0.9.1", "127.0.9.10", "127.0.9.2"
PAGE = "https://localhost:8443"
PASSWORD = "a hall for trying it"
PASSPHRASE = "TRB_PASSPHRASE=a-hall-for-trying"
AS_NODE = "runuser -u trbots --"

CLOUD_UNIT = f"""[Unit]
Description=the cloud's node
ConditionPathExists={CLOUD}/keys/certificate.json
[Service]
Type=notify
NotifyAccess=all
TimeoutStartSec=infinity
User=trbots
UMask=0077
ExecStart=/usr/bin/trb up {CLOUD}
[Install]
WantedBy=multi-user.target
"""
ROBOT_UNIT = f"""[Unit]
Description=a virtual arm
ConditionPathExists=/usr/bin/trb-virtual-ur
[Service]
ExecStart=/usr/bin/trb-virtual-ur --address {ROBOT_ADDRESS}
[Install]
WantedBy=multi-user.target
"""
UNITS = {"cloud": CLOUD_UNIT, "robot": ROBOT_UNIT}
CLOUD_FILES = {
    "node.json": {"id": "cloud", "role": "cloud", "services": ["router", "scheduler", "resilience", "cloud-gateway"]},
    "network.json": {"UDP_PORT": 50000, "TCP_PORT_EXT": 45000, "TCP_PORT": 40000, "HOST_INT": CLOUD_ADDRESS, "VPN_INT": "tun0"},
    "cloud.json": {"listen": "127.0.0.1:8443"},
}
MAKE_CLOUD = [
    f"install -d -o trbots -g trbots -m 0700 /var/lib/hall {CLOUD}",
    f"cp /usr/share/talkrobots/config/*.json {CLOUD}",
    *(f"echo '{json.dumps(text)}' > {CLOUD}/{name}" for name, text in CLOUD_FILES.items()),
    f"chown -R trbots: {CLOUD} && {AS_NODE} trb fleet request {CLOUD}",
    f"{PASSPHRASE} trb fleet init {AUTHORITY}",
    f"cp {CLOUD}/keys/request.json /root && {PASSPHRASE} trb fleet sign {AUTHORITY} /root/request.json",
    f"install -o trbots -g trbots -m 0600 /root/certificate.json {CLOUD}/keys/certificate.json",
    f"{AS_NODE} trb check {CLOUD}",
    "systemctl start robot cloud",
]
MAKE_NODE = (f"cd /var/lib/talkrobots && {AS_NODE} trb node new node --robot arm1 --like ur --address {ROBOT_ADDRESS} "
             f"--network {ADDRESS} --interface {ADDRESS}")
# It waits until the node has joined. As who owns the folder of the cloud's node, for it uses that node's bus.
INVITE = f"{PASSPHRASE} trb fleet invite {AUTHORITY} arm1 --via {CLOUD} --json > /root/invited 2>&1 &"
CURL = f"curl -sS --fail-with-body --max-time 120 --cacert {CLOUD}/keys/gateway.crt -H 'Origin: {PAGE}' -b /root/jar -c /root/jar"


def join(story):
    """The robot's node gets its certificate and its seeds by a code; no file is copied."""
    story.sh(MAKE_NODE)
    story.sh(INVITE)
    code = story.wait("there is a code", lambda: story.line_of("/root/invited", "code"))["code"]
    # The code goes on after a try to which a busy machine was too slow.
    story.wait("it has joined", lambda: story.machine.sh(f"{AS_NODE} trb node join {NODE} {code}", 900)[1] == 0)
    story.wait("the inviter has seen it join", lambda: story.line_of("/root/invited", "joined"))
    story.sh(f"{AS_NODE} trb check {NODE}")


def call(story, method, path, body=None, csrf=""):
    """What the API answers."""
    data = f" --json '{json.dumps(body)}'" if body is not None else ""
    said = story.sh(f"{CURL} -X {method} -H 'X-CSRF-Token: {csrf}'{data} {PAGE}/api/v1{path}")
    return json.loads(said) if said else None


def sign_in(story, password):
    """The value that a change needs. Who has a session would need its value for another one; on a busy machine a password's check
    takes longer than the gateway waits (503)."""
    ask = f"rm -f /root/jar; {CURL} -X POST --json '{json.dumps({'user': 'admin', 'password': password})}' {PAGE}/api/v1/session"
    said = story.wait("signed in", lambda: (answer := story.machine.sh(ask, 900))[1] == 0 and answer[0])
    return json.loads(said)["csrf"]


def first_sign_in(story):
    story.wait("the page is served", lambda: story.machine.sh(f"{CURL} {PAGE}/api/v1/ready")[1] == 0)
    made = json.loads(story.sh(f"{AS_NODE} trb cloud password {CLOUD} --json"))["password"]
    csrf = sign_in(story, made)
    call(story, "PUT", "/me/password", {"old": made, "new": PASSWORD}, csrf)


def noted_on_page(story):
    """What the page shows of the robot's node, beside its router."""
    sign_in(story, PASSWORD)
    services = call(story, "GET", "/services?node=arm1")["services"]
    return next(each["note"] for each in services if each["service"] == "router")
