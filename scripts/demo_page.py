"""The page of the demonstration's cloud node: where it is, and how one signs in."""
import http.client
import socket
import ssl

from trb_fleet import CLOUD, free_port

PORT = 8443  # the gateway's own, if nobody else has it


def take_port():
    """For the gateway, on this machine's own address alone."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", PORT))
            return PORT
        except OSError:
            return free_port()


def is_ready(fleet):
    """True if the gateway answers, and its router answers it."""
    certificate = fleet.dir(CLOUD) / "keys/gateway.crt"
    if not certificate.exists():
        return False
    connection = http.client.HTTPSConnection("localhost", fleet.gateway_port, timeout=5,
                                             context=ssl.create_default_context(cafile=certificate))
    try:
        connection.request("GET", "/api/v1/ready")
        return connection.getresponse().status == 200
    except OSError:
        return False
    finally:
        connection.close()


def open_to_people(fleet, say):
    """Waits for the gateway, and tells how to sign in; the password is new with each demonstration."""
    fleet.wait("the page is served", lambda: is_ready(fleet), 60)
    made = fleet.json("cloud", "password", fleet.dir(CLOUD))
    say(f"\n== the page: https://localhost:{fleet.gateway_port}/   sign in as {made['user']}, password {made['password']}")
    say("  The page asks for a password of your own first.")
    say("  This machine alone reaches it. Its certificate is its own, and a browser asks about that once.")
