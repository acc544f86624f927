"""Wrong files, as a user writes them: those of a node, and those of the fleet's authority."""
import json
import shutil
import socket

import support
from bad_input_case import NO_JSON, Case, all_of, changed, removed, run, written

BLOCK = 50
UDP_PORT = 50050
SEED = {"address": "10.0.0.1:45000", "key": "0" * 64}

# What a user does to a good node's folder (of the node "ur3"): the fault's file, key, a part of its text and of its cure.
FAULTS = {
    "no node.json": (removed("node.json"), "node.json", "", "no such file", "write it"),
    "no network.json": (removed("network.json"), "network.json", "", "no such file", "config/network.json"),
    "no profile.json": (removed("profile.json"), "profile.json", "", "no such file", "config/profile.json"),
    "no commands.json": (removed("commands.json"), "commands.json", "", "no such file", "config/commands.json"),
    "no places.json": (removed("places.json"), "places.json", "", "no such file", "config/places.json"),
    "no description": (removed("robots/ur3.json"), "robots/ur3.json", "", "no such file", "config/robots"),
    "no link key": (removed("keys/link.key"), "keys", "", "link.key: no such file", "trb fleet request"),
    "no identity key": (removed("keys/identity.key"), "keys", "", "identity.key: no such file", "trb fleet request"),
    "no certificate": (removed("keys/certificate.json"), "keys", "", "certificate.json: no such file", "trb fleet sign"),
    **{f"a malformed {name}": (written(name, NO_JSON), name, "", "line 3, column 5", "")
       for name in ("node.json", "network.json", "profile.json", "commands.json", "places.json", "robots/ur3.json")},
    "a malformed link key": (written("keys/link.key", "zz\n"), "keys", "", "link.key: not a key of 32 bytes", "trb fleet request"),
    "a malformed certificate": (written("keys/certificate.json", NO_JSON), "keys", "", "certificate.json: no JSON at line 3, column 5", ""),
    "a certificate without its parts": (written("keys/certificate.json", "{}"), "keys", "", "certificate: missing", "trb fleet sign"),
    "a changed certificate": (changed("keys/certificate.json", "certificate", "signature", "00" * 64), "keys", "",
                              "was not signed by this fleet's authority", "sign the node's request again"),
    "an unknown mode": (changed("profile.json", "ur", "serial"), "profile.json", "ur", "'serial'", "interpreter, direct, ros"),
    "an unknown framework": (changed("node.json", "framework", "urr"), "node.json", "framework", "'urr' is not in profile.json", "'ur'"),
    "no such address": (changed("network.json", "HOST_INT", "203.0.113.9"), "network.json", "HOST_INT", "no interface or address '203.0.113.9'", "lo (127.0.0.1)"),
    "the name of Windows": (changed("network.json", "HOST_INT", "Wi-Fi"), "network.json", "HOST_INT", "Windows", "ip address"),
    "a port as text": (changed("network.json", "TCP_PORT", "40000"), "network.json", "TCP_PORT", "is a text", ""),
    "a port out of range": (changed("network.json", "UDP_PORT", 70000), "network.json", "UDP_PORT", "out of range", "65535"),
    "an unknown key": (changed("node.json", "becon", True), "node.json", "becon", "no key", "'beacon'"),
    "a number as id": (changed("node.json", "id", 7), "node.json", "id", "whole number", "text"),
    "an id that is none": (changed("node.json", "id", "UR 3"), "node.json", "id", "is no id", ""),
    "a list as robot": (changed("node.json", "robot", []), "node.json", "robot", "list", ""),
    "a seed twice": (changed("node.json", "seeds", [SEED, SEED]), "node.json", "seeds[1].address", "occurs twice", "keep one"),
    "a service twice": (changed("node.json", "services", ["router", "router"]), "node.json", "services[1]", "occurs twice", ""),
    "an unknown service": (changed("node.json", "services", ["router", "schedular"]), "node.json", "services", "'schedular'", "'scheduler'"),
    "a key twice": (written("places.json", '{"places": {}, "places": {}}'), "places.json", "", "places", ""),
    "no words for stop": (changed("commands.json", "ur", "commands", "stop", None), "commands.json", "ur.commands.stop", "how it is stopped", "stop program"),
    "a place without x": (changed("places.json", "places", "dock", "x", None), "places.json", "places.dock.x", "is missing", ""),
    "a skill without an end": (changed("robots/ur3.json", "skills", "pick", "end", None), "robots/ur3.json", "skills.pick.end", "has no end", ""),
    "a readable key": (lambda folder: (folder / "keys/link.key").chmod(0o644), "keys", "", "others may read this secret key", "chmod 600"),
    "a readable sign-in": (lambda folder: (written("keys/robot.auth", "basic a:b\n")(folder), (folder / "keys/robot.auth").chmod(0o644)),
                           "keys/robot.auth", "", "others may read it", "chmod 600"),
    "a folder as sign-in": (lambda folder: (folder / "keys/robot.auth").mkdir(), "keys/robot.auth", "", "is no file", "remove it"),
    "another id than the certificate's": (changed("node.json", "id", "ur4"), "keys/certificate.json", "id", "is for 'ur3', node.json says 'ur4'",
                                         "correct \"id\" in node.json to 'ur3'"),
    "another role than the certificate's": (
        all_of(changed("node.json", "role", "cloud"), changed("node.json", "services", ["router"]),
               *(changed("node.json", key, None) for key in ("framework", "description", "robot"))),
        "keys/certificate.json", "role", "is 'robot', node.json says 'cloud'", "trb fleet sign"),
}


class Files(Case):
    @classmethod
    def setUpClass(cls):
        robots = {name: support.trb_fleet.ROBOTS[name] for name in ("ur3", "ridgeback")}
        cls.fleet = support.make_fleet(cls, block=BLOCK, udp_port=UDP_PORT, robots=robots, cloud=False)

    def copy(self, node="ur3"):
        folder = self.temporary() / node
        shutil.copytree(self.fleet.dir(node), folder)
        return folder

    def check_and_up(self, folder, *fault):
        for command in ("check", "up"):
            self.assert_fault(self.faults_of(command, folder), *fault)
        self.assert_nothing_started(folder)

    def test_the_folder_is_good_before_it_is_spoilt(self):
        done = run("check", self.copy(), "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)), (0, {"faults": []}))

    def test_every_fault_of_a_folder(self):
        for what, (spoil, *fault) in FAULTS.items():
            with self.subTest(what):
                folder = self.copy()
                spoil(folder)
                self.check_and_up(folder, *fault)

    def test_no_folder(self):
        for command in ("check", "up", "reload"):
            self.assert_fault(self.faults_of(command, "/nowhere/at/all"), "/nowhere/at/all", "", "is no folder", "node.json")

    def test_a_reload_is_refused_before_a_service_takes_the_sign_in(self):
        folder = self.copy()
        written("keys/robot.auth", "distributor:abc\n")(folder)
        (folder / "keys/robot.auth").chmod(0o600)
        self.assert_fault(self.faults_of("reload", folder), "keys/robot.auth", "", "is no sign-in", "basic USER:PASSWORD")

    def test_a_port_in_use(self):
        with socket.create_server((self.fleet.address("ur3"), 45000)):
            self.check_and_up(self.copy(), "network.json", "TCP_PORT_EXT", "is in use by another program", "ss -ltnp")

    def test_the_certificate_of_another_node(self):
        folder = self.copy()
        shutil.copy(self.fleet.dir("ridgeback") / "keys/certificate.json", folder / "keys/certificate.json")
        self.check_and_up(folder, "keys", "", "made for other keys than those beside it", "trb fleet sign")

    def test_a_certificate_that_has_ended(self):
        folder = self.copy()
        self.fleet.trb("fleet", "sign", self.fleet.authority_dir(), folder / "keys/request.json", "--days", "0.000001")
        self.fleet.wait("the certificate ends", lambda: run("check", folder).returncode != 0, 60)
        self.check_and_up(folder, "keys/certificate.json", "not_after", "ended 20", "run trb fleet renew")

    def test_several_faults_are_told_at_once(self):
        folder = self.copy()
        for spoil in ("an unknown mode", "no such address", "a place without x"):
            FAULTS[spoil][0](folder)
        self.assertEqual(sorted(fault["file"] for fault in self.faults_of("check", folder)),
                         ["network.json", "places.json", "profile.json"])

    # ---- the authority

    def sign(self, *requests, secret=None, authority=None, **expected):
        secret = self.fleet.passphrase() if secret is None else secret
        self.error_of("fleet", "sign", authority or self.fleet.authority_dir(), *requests, TRB_PASSPHRASE=secret, **expected)

    def test_fleet_sign(self):
        folder = self.copy()
        request = folder / "keys/request.json"
        before = (folder / "keys/certificate.json").read_bytes()
        self.sign(request, secret="a wrong passphrase", code="not_permitted", what="the passphrase is wrong", cure="try again")
        self.sign(request, authority=folder, code="missing", what="fleet.json: no such file", cure="trb fleet init")
        self.sign(folder / "none.json", code="missing", what="none.json: no such file", cure="trb fleet request")
        self.sign(request, "--days", "0", code="bad_value", what="--days: '0'", cure="--days 5")
        self.sign(request, "--days", "100000", code="bad_value", what="--days: '100000' is over 36500", cure="at most 36500")
        shutil.copy(request, folder / "keys/other.json")
        self.sign(request, folder / "keys/other.json", code="conflict", what="both certificates would be", cure="a folder of its own")
        changed("keys/request.json", "signature", "00" * 64)(folder)
        self.sign(request, code="bad_signature", what="request of 'ur3'", cure="trb fleet request")
        request.write_text(NO_JSON)
        self.sign(request, code="malformed", what="line 3, column 5", cure="trb fleet request")
        self.assertEqual((folder / "keys/certificate.json").read_bytes(), before)

    def test_fleet_init(self):
        folder = self.temporary() / "authority"
        self.error_of("fleet", "init", folder, TRB_PASSPHRASE="short", code="bad_value", what="passphrase: under 12 characters",
                      cure="longer")
        self.error_of("fleet", "init", folder, code="missing", what="no passphrase", cure="TRB_PASSPHRASE")
        self.error_of("fleet", "init", folder, "--name", "Hall 3", TRB_PASSPHRASE="long enough for it", code="bad_value",
                      what="name", cure="letters")
        self.error_of("fleet", "init", folder, "--passphrase-file", folder / "none", code="missing", what="none: no such file",
                      cure="passphrase")
        self.assertFalse(folder.exists())
        folder.mkdir()
        (folder / "authority.key").write_text("00")
        self.error_of("fleet", "init", folder, TRB_PASSPHRASE="long enough for it", code="conflict", what="fleet.json is not",
                      cure=f"rm {folder}/authority.key")
        self.error_of("fleet", "init", self.fleet.authority_dir(), TRB_PASSPHRASE="long enough for it", code="conflict",
                      what="holds a fleet authority already", cure="another folder")

    def test_fleet_request_and_show(self):
        empty = self.temporary()
        self.error_of("fleet", "request", empty, code="missing", what="node.json: no such file", cure="write node.json first")
        for text, what in (("{}", "id"), (NO_JSON, "line 3, column 5"), ('{"id": 7}', "id: needs text"),
                           ('{"id": "a", "role": "boss"}', "role: 'boss'"), ('{"id": "A B"}', "'A B'")):
            (empty / "node.json").write_text(text)
            done = run("fleet", "request", empty, "--json")
            error = json.loads(done.stdout)["error"]
            self.assertEqual(done.returncode, 1)
            self.assertIn(what, error["what"])
            self.assertIn("node.json", error["what"] + error["cure"])
            self.assertTrue(error["cure"], error)
        self.assertFalse((empty / "keys").exists())
        self.error_of("fleet", "show", empty, code="missing", what="no fleet.json", cure="trb fleet")
        self.error_of("fleet", "show", "/nowhere", code="missing", what="/nowhere", cure="trb fleet")


if __name__ == "__main__":
    support.main()
