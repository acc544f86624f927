"""What flows through the gateway: sensors that are watched, messages, histories.

Addresses 127.0.250.x, 127.0.251.x.
"""
import subprocess
import unittest

import support
import sensor_side
import trb_fleet
from gateway_case import GOOD, ROBOT, Fleet, GatewayCase

SENSOR = "humidity"
TOPIC = f"sensor/{ROBOT}/{SENSOR}"


class SensorFleet(Fleet):
    """The robot's node has a sensor-bus; a program feeds it."""

    def __init__(self, *where, **more):
        super().__init__(*where, **more)
        self.side = sensor_side.SensorSide(self, ROBOT)


class Feeder:
    """A line of shell that emits a value five times a second: a ramp, so that every value is another one."""

    def __init__(self, bus, name):
        emit = f"dbus-send --bus={bus.address} --type=signal /trbots/{name} trbots.{name}.value double:$i string:percent"
        line = f"i=0; while :; do i=$((i+1)); {emit} 2>/dev/null; sleep 0.2; done"
        self.child = subprocess.Popen(["sh", "-c", line], preexec_fn=trb_fleet.end_with_parent)

    def stop(self):
        self.child.terminate()
        self.child.wait()


def rows_of(frame, kind):
    return [row for block in frame.get("blocks", []) for row in block["rows"] if row["kind"] == kind]


class Stream(GatewayCase):
    block, udp_port = 250, 50250
    fleet_kind = SensorFleet

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.feeder = Feeder(cls.fleet.side.bus, SENSOR)
        cls.addClassCleanup(cls.feeder.stop)
        cls.fleet.wait("the sensor is listed", lambda: cls.viewer.ask(
            "GET", f"/api/v1/sensors/{ROBOT}/{SENSOR}").status == 200, 20)
        cls.tap = support.Tap(cls.fleet, ROBOT)
        cls.addClassCleanup(cls.tap.child.stop)

    # ---- helpers

    def leases(self):
        """The leases of the orders for this sensor's values that have passed the router of its node."""
        return [order["lease_s"] for order in self.tap.bodies("sensor_watch") if order["sensor"] == SENSOR]

    def wait_stream(self, running):
        """The last order on the bus starts the stream, or ends it."""
        self.fleet.wait(f"the stream runs: {running}", lambda: bool(self.leases()) and
                        (self.leases()[-1] > 0) == running, 8)

    def open_live(self, client=None):
        live = (client or self.viewer).live()
        self.addCleanup(live.close)
        self.assertEqual(live.status, 101)
        return live

    def watch(self, live, topic=TOPIC):
        live.say({"subscribe": topic})
        return rows_of(live.until(lambda heard: rows_of(heard, "reading")), "reading")[0]

    # ---- sensors

    def test_the_first_client_starts_a_sensors_stream_and_the_last_one_ends_it(self):
        one, two = self.open_live(), self.open_live(self.operator)
        row = self.watch(one)
        self.assertEqual((row["node"], row["name"], row["live"], row["content"]["unit"]),
                         (ROBOT, SENSOR, "live", "percent"))
        self.wait_stream(True)
        self.watch(two)
        one.say({"unsubscribe": TOPIC})
        two.until(lambda heard: rows_of(heard, "reading"))
        self.assertGreater(self.leases()[-1], 0)
        two.close()
        self.wait_stream(False)
        count = len(self.leases())
        self.watch(self.open_live())
        self.wait_stream(True)
        self.assertGreater(len(self.leases()), count)

    def test_a_sign_out_ends_the_stream(self):
        client = self.client()
        client.sign_in("vic", GOOD)
        live = self.open_live(client)
        self.watch(live)
        self.wait_stream(True)
        client.ask("DELETE", "/api/v1/session")
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 4401)
        self.wait_stream(False)

    def test_a_sensor_that_nobody_has_gives_an_empty_topic_and_no_stream(self):
        live = self.open_live()
        live.say({"subscribe": f"sensor/{ROBOT}/none"})
        frame = live.until(lambda heard: heard.get("blocks"))
        self.assertEqual(frame["blocks"][0]["rows"], [])
        live.say({"subscribe": "sensor/../secrets"})
        self.assertIn("error", live.until(lambda heard: "error" in heard))
        self.assertEqual([order for order in self.tap.bodies("sensor_watch") if order["sensor"] == "none"], [])


if __name__ == "__main__":
    support.main()
