"""Devices plugged into a node: the real systemd-udevd, libudev and trb-sensor-bus; kernel events sent by hand."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

import sensor_node  # noqa: E402
import skips  # noqa: E402
from sensor_node import NODE  # noqa: E402

GGA = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
NO_FIX = "$GPGGA,123519,,,,,0,00,,,M,,M,,*6B\r\n"
KEYS = {"4": 5, "2": 3, "\n": 28}


class Hotplug(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = sensor_node.skip_reason()
        if missing:
            raise unittest.SkipTest(missing)
        cls.node = sensor_node.SensorNode(cls, block=122, udp_port=50922)
        cls.hall = cls.node.hall
        cls.node.start()

    def setUp(self):
        self.addCleanup(self.node.wait, "nothing is left", lambda there: not there)  # after every device is unplugged

    def plug(self, device):
        self.addCleanup(device.unplug)
        return device

    def test_each_kind_is_recognised_and_read(self):
        self.plug(self.hall.plug_temperature(21.5))
        self.node.wait_state("temperature", "ok")
        iio = {"in_pressure_input": "101.3\n", "in_humidityrelative_raw": "100\n", "in_humidityrelative_scale": "400\n"}
        self.plug(self.hall.plug_iio(iio))
        self.plug(self.hall.plug_w1(23.1, "28-000005e2fdc3"))
        gps = self.plug(self.hall.plug_serial(model="GPS Receiver", serial="G1"))
        tags = self.plug(self.hall.plug_serial(model="RFID Reader", serial="T1"))
        keys = self.plug(self.hall.plug_keyboard())
        self.node.wait("all are there", lambda there: len(there) == 11)
        tags.say("\x0204A1B2C3\x03\r\n")
        for each in "42\n":
            keys.press(KEYS[each])
        heard = {"temperature", "pressure", "humidity", "temperature_2", "position", "latitude", "longitude", "altitude", "tag", "tag_2"}


        def are_read(there):
            gps.say(GGA)  # again and again, as a receiver does
            return {name for name, sensor in there.items() if sensor["state"] == "ok"} == heard

        self.node.wait("all but the speed are read", are_read)
        read = self.node.read("temperature")
        self.assertEqual((read["number"], read["unit"], read["quality"]), (21.5, "degC", "good"))
        self.assertEqual(self.node.read("temperature_2")["number"], 23.1)
        self.assertEqual(self.node.read("pressure")["number"], 101300)
        self.assertEqual(self.node.read("humidity")["number"], 40)
        there = self.node.sensors()
        self.assertEqual(there["temperature_2"]["identity"], "28-000005e2fdc3")
        self.assertEqual(there["position"]["identity"], "1209:0001:G1/position")
        self.assertEqual(there["pressure"]["unit"], "Pa")
        self.assertEqual({there["tag"]["device"], there["tag_2"]["device"]}, {"Example RFID Reader"})

    def test_a_gps_without_a_fix_says_so(self):
        gps = self.plug(self.hall.plug_serial(model="GPS Receiver", serial="G2"))
        self.node.wait("it is there", lambda there: "position" in there)

        def says_no_fix(there):
            gps.say(NO_FIX)  # again and again, as a receiver does
            return (there["position"]["state"], there["position"]["detail"]) == ("silent", "no fix")

        self.node.wait("no fix", says_no_fix)

        def is_ok(there):
            gps.say(GGA)
            return (there["position"]["state"], there["position"]["detail"]) == ("ok", "")

        self.node.wait("a fix", is_ok)

    def test_what_is_plugged_in_before_the_start_is_found(self):
        self.node.stop()
        self.plug(self.hall.plug_temperature(20))
        self.plug(self.hall.plug_serial())
        self.node.start()
        self.node.wait("three sensors", lambda there: set(there) == {"temperature", "temperature_2", "humidity"})

    def test_the_fleet_learns_of_it_at_once(self):
        def capabilities():
            routes = self.node.fleet.json("route", "list", node=NODE)["routes"]
            return next(r for r in routes if r["id"] == NODE)["profile"]["capabilities"]

        device = self.hall.plug_temperature(20)
        took = self.node.fleet.wait("the capability", lambda: "temperature" in capabilities(), 60)
        device.unplug()
        gone = self.node.fleet.wait("no capability", lambda: "temperature" not in capabilities(), 60)
        print(f"plugged in to capability {took * 1000:.0f} ms, unplugged to none {gone * 1000:.0f} ms (one question every 50 ms)")

    def test_a_value_that_changes_is_told_when_it_is_asked_for(self):
        device = self.plug(self.hall.plug_temperature(15))
        self.node.wait_state("temperature", "ok")
        for value in (15, 25, -3.5):
            device.set(value)
            self.assertEqual(self.node.read("temperature")["number"], value)

    def test_a_repeated_event_changes_nothing(self):
        before = len(self.node.logged("device_plugged"))
        device = self.plug(self.hall.plug_temperature(20))
        self.node.wait_state("temperature", "ok")
        for action in ("add", "change", "bind", "add", "change"):
            device.event(action)
        self.plug(self.hall.plug_temperature(20))  # its event comes after theirs
        self.node.wait("both", lambda there: len(there) == 2)
        self.assertEqual(len(self.node.logged("device_plugged")) - before, 2)

    def test_a_hundred_at_once(self):
        devices = [self.hall.plug_temperature(20) for _ in range(100)]
        took = self.node.wait("a hundred are read", lambda there: len([s for s in there.values() if s["state"] == "ok"]) == 100, 60)
        _, threads, _ = self.node.figures()
        self.assertLess(threads, 110)
        for device in devices:
            device.unplug()
        gone = self.node.wait("none is left", lambda there: not there, 60)
        self.node.fleet.wait("their threads have ended", lambda: self.node.figures()[1] < 10, 60)
        print(f"a hundred plugged in at once: all read {took:.2f} s after the last; unplugged: gone {gone:.2f} s after")

    def test_a_device_keeps_its_identity_wherever_it_is_plugged_in(self):
        device = self.hall.plug_serial(serial="A7")
        self.node.wait("it is there", lambda there: "temperature" in there)
        identity = self.node.sensors()["temperature"]["identity"]
        device.unplug()
        self.node.wait("it is gone", lambda there: not there)
        self.plug(self.hall.plug_serial(serial="A7"))
        self.node.wait("it is there again", lambda there: "temperature" in there)
        self.assertEqual(self.node.sensors()["temperature"]["identity"], identity)

    def test_a_device_that_errs_says_so_and_recovers(self):
        device = self.plug(self.hall.plug_temperature(20))
        line = self.plug(self.hall.plug_serial())
        self.node.wait_state("temperature", "ok")
        device.write("temp1_input", None)
        self.node.wait_state("temperature", "failed")
        self.assertIn("No such file", self.node.sensors()["temperature"]["detail"])
        device.write("temp1_input", "21000\n")
        self.node.wait_state("temperature", "ok")
        line.say(b"x" * 1_000_000 + b"\n")
        self.node.wait_state("humidity", "failed")
        line.say("T=1;H=2\n")
        self.node.wait_state("humidity", "ok")
        line.hang_up()
        self.node.wait_state("humidity", "failed")

    def test_a_device_that_hangs_holds_up_no_other(self):
        frozen = self.plug(self.hall.plug_temperature(20))
        good = self.plug(self.hall.plug_temperature(20))
        self.node.wait("both are read", lambda there: [s["state"] for s in there.values()] == ["ok", "ok"])
        frozen.freeze("temp1_input")
        self.node.wait("one has failed", lambda there: sorted(s["state"] for s in there.values()) == ["failed", "ok"])
        failed = next(s for s in self.node.sensors().values() if s["state"] == "failed")
        self.assertIn("hangs: no answer for 3 s", failed["detail"])
        good.write("temp1_input", None)
        self.node.wait("the other one is read on", lambda there: all(s["state"] == "failed" for s in there.values()))
        frozen.thaw("temp1_input", "20000\n")
        good.set(21)
        self.node.wait("both are read again", lambda there: [s["state"] for s in there.values()] == ["ok", "ok"])

    def heard_udevd(self):
        return len(self.node.logged("udevd_heard"))

    def test_udevd_may_come_later(self):
        self.addCleanup(self.hall.start_udevd)
        self.node.stop()
        self.hall.stop_udevd()
        before = len(self.node.logged("no_udevd")), self.heard_udevd()
        self.node.start()
        self.node.fleet.wait("it says so", lambda: len(self.node.logged("no_udevd")) > before[0], 60)
        self.plug(self.hall.plug_temperature(20))  # without an event
        self.hall.start_udevd()
        took = self.node.wait("what was not said is found", lambda there: set(there) == {"temperature"})
        self.plug(self.hall.plug_temperature(21))
        heard = self.node.wait("what is plugged in later is heard", lambda there: len(there) == 2)
        self.assertEqual(self.heard_udevd() - before[1], 1)
        print(f"udevd after the service: found {took:.2f} s after its start; the next one in {heard:.2f} s")

    def test_udevd_may_be_started_again(self):
        self.addCleanup(self.hall.start_udevd)
        self.plug(self.hall.plug_temperature(20))
        self.node.wait_state("temperature", "ok")
        before = self.heard_udevd()
        self.hall.stop_udevd()
        self.plug(self.hall.plug_temperature(21))  # without an event
        self.hall.start_udevd()
        self.plug(self.hall.plug_temperature(22))
        self.node.wait("all three are there", lambda there: len(there) == 3)
        self.node.fleet.wait("it has noticed", lambda: self.heard_udevd() > before, 60)
        last = self.hall.plug_temperature(23)
        self.node.wait("a fourth one", lambda there: len(there) == 4)
        last.unplug()
        self.node.wait("it is gone", lambda there: len(there) == 3)

    def test_an_unknown_device_comes_with_a_rule_that_makes_it_known(self):
        device = self.plug(self.hall.plug_serial(model="Uno", serial="U1"))
        found = []
        self.node.fleet.wait("it is listed", lambda: found or found.extend(self.node.table(unknown=True)["unknown"]), 60)
        self.assertEqual(found[0]["device"], "/sys" + device.path)
        self.assertIn("ID_MODEL=Uno", found[0]["properties"])
        self.assertEqual(self.node.sensors(), {})
        rule = self.node.dir / "sensors" / "uno.json"
        rule.write_text(found[0]["rule"])
        self.addCleanup(rule.unlink)
        self.node.stop()
        self.node.start()
        self.node.wait("it is known", lambda there: "temperature" in there)
        self.assertEqual(self.node.table(unknown=True)["unknown"], [])

    def test_a_faulty_rule_is_told_with_its_key_and_a_cure(self):
        rule = self.node.dir / "sensors" / "mine.json"
        rule.write_text(json.dumps({"match": {"subsystem": "tty"}, "read": "line", "baud": 9601, "sensors": [{"knd": "x"}]}))
        self.addCleanup(rule.unlink)
        done = self.node.fleet.trb("check", self.node.dir, check=False)
        said = done.stdout + done.stderr
        for words in ("sensors/mine.json: baud: 9601 is no speed", "sensors[0].kind: is missing", "did you mean 'kind'?"):
            self.assertIn(words, said)


if __name__ == "__main__":
    skips.main()
