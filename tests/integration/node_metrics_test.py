"""What a node tells Prometheus; with scripts/test-monitoring also what a real one makes of it, of the example rules and of the
dashboard.

Addresses 127.0.104.x, 127.0.105.x.
"""
import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import unittest
import urllib.parse

import support
import trb_fleet

MONITORING = support.REPO / "deploy" / "monitoring"
PROMETHEUS = os.environ.get("TRB_PROMETHEUS")
NODES = {"ant": ["router", "scheduler"], "bee": ["router", "scheduler", "resilience"]}


class Fleet(support.RouterFleet):
    def __init__(self, root, programs, **more):
        super().__init__(root, programs, NODES, **more)
        self.ports = {node: trb_fleet.free_port() for node in NODES}

    def make_node(self, node):
        super().make_node(node)
        (self.dir(node) / "metrics.json").write_text(json.dumps({"listen": f"127.0.0.1:{self.ports[node]}"}))


def get(port, path, **headers):
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    try:
        link.request("GET", path, headers=headers)
        reply = link.getresponse()
        return reply.status, reply.read().decode()
    finally:
        link.close()


class Metrics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, Fleet, block=104, udp_port=50104)
        cls.fleet.bring_up(*NODES)
        cls.fleet.wait("they are linked", lambda: cls.value("ant", 'trb_node_peers{state="ONLINE"}') == 1, 60)

    @classmethod
    def told(cls, node):
        status, text = get(cls.fleet.ports[node], "/metrics")
        assert status == 200, text
        return text

    @classmethod
    def value(cls, node, sample):
        found = re.search(rf"(?m)^{re.escape(sample)} (\d+)$", cls.told(node))
        return int(found[1]) if found else None

    def test_services_peers_and_counters(self):
        text = self.told("ant")
        self.assertIn('trb_node_info{node="ant",role="cloud",version="', text)
        self.fleet.wait("its scheduler is up", lambda: self.value("ant", 'trb_node_service_up{service="scheduler"}') == 1, 60)
        self.assertGreater(self.value("ant", 'trb_node_events_total{event="sent",about="hello"}'), 0)
        self.assertGreater(self.value("ant", "trb_node_disk_free_bytes"), 0)
        self.assertGreater(self.value("ant", "trb_node_certificate_ends_seconds"), 1_700_000_000)
        self.assertEqual(self.value("ant", "trb_node_boot"), int((self.fleet.dir("ant") / "state/boot").read_text()))
        for line in text.splitlines():
            self.assertRegex(line, r'^(# (HELP|TYPE) trb_node_|trb_node_[a-z_]+(\{[a-z]+="[^"]*"(,[a-z]+="[^"]*")*\})? \d+$)')

    def test_a_service_that_waits_for_its_files_is_told(self):
        """By its router, to whoever asks: metrics, service list, doctor; here the resilience service, whose database nobody can open."""
        node, database = self.fleet.dir("bee"), self.fleet.dir("bee") / "state/capability.db"
        noted = 'trb_node_service_notes{service="resilience"}'
        self.fleet.wait("it works", lambda: self.fleet.services("bee")["resilience"]["state"] == "up", 60)
        self.assertEqual(self.value("bee", noted), 0)
        self.assertEqual(self.fleet.trb("doctor", "--service", "resilience", "--node", node, check=False).returncode, 0)
        kept = database.with_name("kept")
        database.rename(kept)
        database.mkdir()
        os.kill(self.fleet.pid("bee", "resilience"), signal.SIGTERM)
        self.fleet.wait("it waits, and is up", lambda: self.value("bee", noted) == 1, 60)
        self.assertRegex(self.fleet.services("bee")["resilience"]["note"], "^it waits: .*capability.db")
        for words in (), ("--service", "resilience"):
            done = self.fleet.trb("doctor", *words, "--json", "--node", node, check=False)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(("service_waits", "resilience"), [(row["cause"], row["subject"]) for row in json.loads(done.stdout)["findings"]])
        database.rmdir()
        kept.rename(database)
        self.fleet.wait("it works again", lambda: self.value("bee", noted) == 0, 60)

    def test_an_address_that_is_taken_is_noted(self):
        path = self.fleet.dir("bee") / "metrics.json"
        kept = path.read_text()
        path.write_text(json.dumps({"listen": f"127.0.0.1:{self.fleet.ports['ant']}"}))
        self.fleet.trb("reload", self.fleet.dir("bee"))
        note = lambda: self.fleet.services("bee")["router"]["note"]
        said = lambda words: lambda: (self.fleet.trb("service", "list", node="bee", check=False).returncode == 0) and words(note())
        self.fleet.wait("it says so", said(lambda now: "no metrics, and Prometheus takes the node for gone" in now), 60)
        path.write_text(kept)
        self.fleet.trb("reload", self.fleet.dir("bee"))
        self.fleet.wait("it is mended", said(lambda now: "no metrics" not in now), 60)

    def test_a_page_under_another_name_is_told_nothing(self):
        self.assertEqual(get(self.fleet.ports["ant"], "/metrics", Host="evil.example")[0], 403)
        self.assertEqual(get(self.fleet.ports["ant"], "/")[0], 404)

    def test_an_address_that_others_reach_is_refused(self):
        path = self.fleet.dir("bee") / "metrics.json"
        kept = path.read_text()
        self.addCleanup(path.write_text, kept)
        path.write_text('{"listen": "0.0.0.0:9464"}')
        done = self.fleet.trb("check", self.fleet.dir("bee"), check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("metrics.json", done.stdout + done.stderr)

    def test_rules_name_what_is_told(self):
        names = set(re.findall(r"(?m)^# TYPE (\S+)", self.told("ant"))) | {"trb_node_robot_online", "trb_node_robot_fenced",
                                                                         "trb_node_robot_out_of_use"}
        for file in ("talkrobots-rules.yml", "talkrobots-grafana.json"):
            used = set(re.findall(r"trb_\w+", (MONITORING / file).read_text()))
            self.assertTrue(used, file)
            self.assertEqual(used - names, set(), file)


class Prometheus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, Fleet, block=104, udp_port=50105)
        cls.fleet.bring_up(*NODES)
        cls.folder = support.temporary_folder(cls)
        cls.port = trb_fleet.free_port()
        example = (MONITORING / "prometheus.yml").read_text()
        targets = ", ".join(f'"127.0.0.1:{port}"' for port in cls.fleet.ports.values())
        assert '"127.0.0.1:9464"]' in example
        (cls.folder / "prometheus.yml").write_text(
            example.replace('targets: ["127.0.0.1:9464"]', f"targets: [{targets}]").replace("15s", "1s"))
        rules = (MONITORING / "talkrobots-rules.yml").read_text()
        (cls.folder / "talkrobots-rules.yml").write_text(re.sub(r"for: \d+m", "for: 1s", rules))
        cls.process = trb_fleet.Process(
            [f"{PROMETHEUS}/prometheus", f"--config.file={cls.folder}/prometheus.yml", f"--storage.tsdb.path={cls.folder}/data",
             f"--web.listen-address=127.0.0.1:{cls.port}"], cls.folder / "prometheus.log")
        cls.addClassCleanup(cls.process.stop)
        cls.fleet.wait("Prometheus asks both", lambda: cls.query('sum(up{job="talkrobots-node"})') == ["2"], 60)

    @classmethod
    def ask(cls, path):
        try:
            status, text = get(cls.port, path)
        except OSError:
            return {}
        return json.loads(text) if status == 200 else {}

    @classmethod
    def query(cls, words):
        answer = cls.ask("/api/v1/query?" + urllib.parse.urlencode({"query": words}))
        return [row["value"][1] for row in answer.get("data", {}).get("result", [])] if answer else None

    def alerts(self):
        return {(one["labels"]["alertname"], one["state"]) for one in self.ask("/api/v1/alerts")["data"]["alerts"]}

    def test_the_examples_as_they_are(self):
        for words in (["check", "config", MONITORING / "prometheus.yml"], ["check", "rules", MONITORING / "talkrobots-rules.yml"]):
            done = subprocess.run([f"{PROMETHEUS}/promtool", *words], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        text = subprocess.run([f"{PROMETHEUS}/promtool", "check", "metrics"], input=get(self.fleet.ports["ant"], "/metrics")[1],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual((text.returncode, text.stderr), (0, ""), text.stdout)

    def test_every_expression_of_the_dashboard_is_understood(self):
        board = json.loads((MONITORING / "talkrobots-grafana.json").read_text())
        for panel in board["panels"]:
            for target in panel["targets"]:
                with self.subTest(panel["title"]):
                    words = target["expr"].replace("$__rate_interval", "1m")
                    found = self.query(words)
                    self.assertIsNotNone(found, words)
                    self.assertTrue(found or "robot" in words or "refused" in words, f"{words}: nothing")

    def test_a_node_that_is_gone_is_an_alert_and_its_return_ends_it(self):
        self.assertNotIn("TalkRobotsNodeGone", {name for name, _ in self.alerts()})
        self.fleet.nodes.pop("bee").stop()
        self.fleet.wait("it is an alert", lambda: {("TalkRobotsNodeGone", "firing"), ("TalkRobotsPeersGone", "firing")} <= self.alerts(), 90)
        self.fleet.bring_up("bee")
        self.fleet.wait("it is over", lambda: "TalkRobotsNodeGone" not in {name for name, _ in self.alerts()}, 60)


if not PROMETHEUS:
    del Prometheus

if __name__ == "__main__":
    support.main()
