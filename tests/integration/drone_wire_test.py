"""The drone's wire, one side at a time: a raw client against the virtual drone, a raw drone, and another maker's, against
the mode-adapter. Addresses 127.0.84.x and 127.0.85.x."""
import json
import os
import statistics
import subprocess
import time
import unittest

import raw_drone
import support
import trb_fleet
from drone_fleet import DroneFleet
from raw_drone import AIR, GROUND, TOGGLE, bits_of

BLOCK = 84
VIRTUAL = support.PROGRAMS / "trb-virtual-drone"


@support.told_again
def unless_lost(case):
    """A drone that is told nothing for 2 s lands."""
    return lambda: case.drone.drain() or any("communication lost" in line for line in case.drone.lines)


class RawClient(unittest.TestCase):
    """The virtual drone against a client that is independent of this repository."""

    def setUp(self):
        self.drone = trb_fleet.Process([VIRTUAL, "--address", "127.0.85.9", "--port", "auto", "--die-with-parent"],
                                       os.devnull, stdin=subprocess.PIPE)
        self.addCleanup(self.drone.stop)
        line, _ = self.drone.wait_line("ready", 60)
        _, at_port, navdata_port = line.split()
        self.client = raw_drone.Client("127.0.85.9", int(at_port), int(navdata_port))
        self.addCleanup(self.client.close)

    def come_up(self):
        self.client.wake()
        self.client.wait("bootstrap", lambda n: n["state"] & raw_drone.BOOTSTRAP and "control" not in n)
        self.client.send("COMWDG", 'CONFIG,"general:navdata_demo","TRUE"')
        self.client.wait("acknowledged", lambda n: n["state"] & raw_drone.COMMAND and "control" in n)
        self.client.send("CTRL,5,0")
        self.client.wait("put down", lambda n: not n["state"] & raw_drone.COMMAND)

    def take_off(self):
        self.come_up()
        self.client.send("FTRIM")
        self.client.hold(AIR)
        return self.client.wait("it hovers", lambda n: n["control"] == raw_drone.HOVERING)

    @unless_lost
    def test_take_off_fly_hover_and_land(self):
        heard = self.take_off()
        self.assertTrue(heard["state"] & raw_drone.FLYING)
        self.assertAlmostEqual(heard["altitude"], 800, delta=100)
        self.client.hold(AIR, f"1,0,{bits_of(-0.5)},0,0")
        heard = self.client.wait("it flies forward", lambda n: n["vx"] > 1400)
        self.assertEqual(heard["control"], raw_drone.FLIES)
        self.assertLess(heard["theta"], -5000)  # nose down
        self.client.hold(AIR)
        self.client.wait("it stands", lambda n: abs(n["vx"]) < 50)
        self.client.hold(GROUND)
        self.client.wait("it lands", lambda n: n["control"] == raw_drone.LANDING)
        self.client.wait("it has landed", lambda n: n["control"] == raw_drone.LANDED and not n["state"] & raw_drone.FLYING)
        self.drone.wait_line("command FTRIM", 60)

    @unless_lost
    def test_navdata_comes_fifteen_times_a_second(self):
        self.come_up()
        self.client.hold(GROUND)  # who commands and then falls silent is told nothing any more
        times = []
        self.client.wait("two seconds of navdata", lambda n: times.append(time.monotonic()) or len(times) > 30)
        self.assertAlmostEqual(statistics.median(b - a for a, b in zip(times, times[1:])), 1 / 15, delta=0.02)

    def test_a_client_that_is_silent_is_given_up(self):
        self.take_off()
        self.client.hold(AIR)
        self.client.state = []
        heard = self.client.wait("the watchdog", lambda n: n["state"] & raw_drone.WATCHDOG)
        self.assertFalse(heard["state"] & raw_drone.COM_LOST)
        self.assertEqual(heard["control"], raw_drone.HOVERING)
        self.drone.wait_line("communication lost", 60)
        self.drone.wait_line("state landed", 60)
        self.client.wake()  # it was told nothing more
        self.client.wait("it is lost", lambda n: n["state"] & raw_drone.COM_LOST and n["control"] == raw_drone.LANDED)
        self.client.send(f"REF,{AIR}")
        self.client.send("COMWDG")
        heard = self.client.wait("it is there again", lambda n: not n["state"] & raw_drone.COM_LOST)
        self.assertEqual(heard["control"], raw_drone.LANDED)
        self.client.hold(AIR)
        self.client.wait("it takes off", lambda n: n["control"] == raw_drone.TAKING_OFF)

    def test_all_options_are_told_to_who_wants_no_demo(self):
        self.client.wake()
        self.client.wait("bootstrap", lambda n: n["state"] & raw_drone.BOOTSTRAP)
        self.client.send("COMWDG", 'CONFIG,"general:navdata_demo","FALSE"')
        heard = self.client.wait("all of it", lambda n: not n["state"] & raw_drone.BOOTSTRAP)
        self.assertFalse(heard["state"] & raw_drone.DEMO)
        self.assertEqual(heard["options"], list(range(28)))
        self.assertEqual(heard["vision"], 1)
        self.assertTrue(heard["state"] & raw_drone.CAMERA and heard["state"] & raw_drone.PIC)

    @unless_lost
    def test_emergency_and_back(self):
        self.take_off()
        self.client.hold(TOGGLE)
        self.client.wait("motors cut", lambda n: n["state"] & raw_drone.EMERGENCY and n["altitude"] == 0)
        self.client.hold(GROUND)
        self.client.wait("still cut", lambda n: n["state"] & raw_drone.EMERGENCY)
        self.client.hold(TOGGLE)
        self.client.wait("recovered", lambda n: not n["state"] & raw_drone.EMERGENCY)

    @unless_lost
    def test_lines_let_it_fail_and_drain_it(self):
        self.take_off()
        self.drone.say("battery 12")
        heard = self.client.wait("low", lambda n: n["state"] & raw_drone.BATTERY_LOW)
        self.assertEqual(heard["battery"], 12)
        self.drone.say("fault fly CRITICAL a bird")
        self.client.wait("cut", lambda n: n["state"] & raw_drone.EMERGENCY and n["state"] & raw_drone.CUTOUT)
        self.drone.say("clear")
        self.client.wait("cleared", lambda n: not n["state"] & (raw_drone.EMERGENCY | raw_drone.CUTOUT))

    def test_garbage_changes_nothing(self):
        self.come_up()
        for junk in (b"", b"\0" * 1024, b"AT*REF=9999999,290718208", b"x" * 2000, b"AT*REF=1.5,290718208\r"):
            self.client.at.send(junk)
        self.drone.wait_line("rejected longer than 1024 bytes", 60)
        heard = self.client.wait("it still speaks", lambda n: True)
        self.assertEqual(heard["control"], raw_drone.LANDED)


class RawDrone(unittest.TestCase):
    """The mode-adapter flies a drone that is independent of this repository."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, DroneFleet, block=BLOCK)
        cls.fleet.start()

    def setUp(self):
        self.drone = raw_drone.Drone(self.fleet.robot_address("drone"))
        self.drone.start()
        self.addCleanup(self.let_go)
        self.fleet.wait_robot("ONLINE")

    def let_go(self):
        self.drone.close()
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)

    def wait_call(self, mark, name, arguments, timeout=60):
        self.fleet.wait(f"{name} {arguments}", lambda: any(c[3] == arguments for c in self.drone.since(mark, name)), timeout)

    def test_it_is_woken_configured_and_acknowledged(self):
        names = [call[1] for call in self.drone.since(0)]
        self.assertEqual(names[:1], ["CONFIG"])
        self.assertLess(names.index("CTRL"), names.index("REF"))
        self.assertEqual(self.drone.since(0, "CONFIG")[0][3], '"general:navdata_demo","TRUE"')
        self.assertEqual(self.drone.since(0, "CTRL")[0][3], "5,0")

    def test_the_state_comes_every_30_ms_and_the_numbers_rise(self):
        mark = self.drone.mark()
        self.fleet.wait("300 states", lambda: len(self.drone.since(mark, "REF")) >= 300, 60)
        times = [call[0] for call in self.drone.since(mark, "REF")]
        gaps = sorted((b - a) * 1000 for a, b in zip(times, times[1:]))
        print(f"resend: median {statistics.median(gaps):.1f} ms, 99th percentile {gaps[int(len(gaps) * 0.99)]:.1f} ms, "
              f"largest {gaps[-1]:.1f} ms, of {len(gaps)}", flush=True)
        self.assertAlmostEqual(statistics.median(gaps), 30, delta=3)
        numbers = [call[2] for call in self.drone.since(0)]
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
        self.assertLess(max(len(data) for _, data in self.drone.datagrams), 1025)

    def test_a_command_is_sent_once_and_its_state_again_and_again(self):
        mark = self.drone.mark()
        self.assertEqual(self.fleet.send("lights", "[3, 0.5, 2]").returncode, 0)
        self.assertEqual(self.fleet.send("take_off").returncode, 0)
        self.fleet.wait("50 states", lambda: len(self.drone.since(mark, "REF")) >= 50, 60)
        self.assertEqual([call[3] for call in self.drone.since(mark, "LED")], [f"3,{bits_of(0.5)},2"])
        self.assertEqual(len(self.drone.since(mark, "FTRIM")), 1)
        self.assertEqual(self.drone.since(mark, "REF")[-1][3], str(AIR))
        self.drone.is_in(state=raw_drone.FLYING, control=raw_drone.HOVERING, altitude_mm=800)
        self.fleet.wait("airborne", lambda: '"hovering"' in self.fleet.ask("state").stdout.replace("\\", ""), 60)
        mark = self.drone.mark()
        self.assertEqual(self.fleet.send("move", "[0, -0.8, 0, 0.25, 0.5]").returncode, 0)
        self.wait_call(mark, "PCMD", f"1,0,{bits_of(-0.8)},0,{bits_of(0.25)}")
        self.wait_call(mark, "PCMD", "0,0,0,0,0")  # no longer than ordered

    def test_a_wrong_checksum_and_an_old_number_are_counted(self):
        before = self.fleet.counters()
        with self.drone.lock:
            good = self.drone.packet()
            self.drone.tell(good[:-1] + bytes([good[-1] ^ 1]))
            self.drone.tell(good)
            self.drone.tell(good)
            self.drone.tell(b"nonsense")
        for name in ("wrong_checksum", "old_navdata", "bad_navdata"):
            self.fleet.wait(name, lambda: self.fleet.counters().get(f"refused.{name}", 0) >
                            before.get(f"refused.{name}", 0), 60)
        self.assertEqual(self.fleet.profile()["robot"], "ONLINE")

    def test_text_that_the_protocol_cannot_carry_is_refused(self):
        mark = self.drone.mark()
        for text in ('"5\\"\\rAT*REF=9,290717952\\r"', '"5\\n"', '"5\\r"'):
            done = self.fleet.send("set_altitude_max", text)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("not_escapable", done.stderr)
        self.assertEqual(self.drone.since(mark, "CONFIG"), [])

    def test_a_drone_that_falls_silent_is_lost_and_comes_back(self):
        for _ in range(3):  # what a stalled machine adds comes and goes
            self.drone.answers = True
            self.fleet.wait_robot("ONLINE", 60)
            self.drone.answers = False
            start = time.monotonic()
            self.fleet.wait_robot("CONNECTION_BROKEN", 60)
            took = time.monotonic() - start
            if took < 3.5:
                break
        self.assertLess(took, 3.5)
        self.assertEqual(self.fleet.profile()["detail"], "no navdata for 2 s")
        mark, woken = self.drone.mark(), self.drone.woken
        self.fleet.wait("it is woken", lambda: self.drone.woken > woken, 60)
        self.assertEqual(self.drone.since(mark, "REF"), [])  # nothing is sent to a silent drone
        self.assertIn("robot_offline", self.fleet.send("land").stderr)
        self.drone.answers = True
        self.fleet.wait_robot("ONLINE", 60)


class OtherMaker(unittest.TestCase):
    """A drone of a maker that is not in the repository: JSON alone, with words, names and ports of its own."""

    VENDOR = {"port": 6556, "transport": "udp-at", "monitor": {"protocol": "ar-navdata", "port": 6554},
              "commands": {"ascend": "REF take_off", "come_down": "REF land", "stop": "REF land", "release": "", "stay": "hover",
                           "glide": "PCMD {0} {1} {2} {3} for 0.5", "call_it": 'CONFIG "general:ardrone_name" {data}'},
              "values": {"height": "altitude"}, "requests": {"how_high": "height"}}
    SKILL = {"capability": "fly", "command": {"subtype": "ascend"}, "end": {"kind": "state", "state": "airborne", "equals": 1}}

    BY_HAND = [{"part": "base", "capability": "fly", "axes": {"x": {"limit": 1, "factor": -0.3333}},
                "command": {"subtype": "glide", "data": "[0, {x}, 0, 0]"}, "stand": {"subtype": "stay"}}]

    def edit(self, name, change):
        path = self.fleet.dir("drone") / name
        content = json.loads(path.read_text())
        change(content)
        path.write_text(json.dumps(content))

    def test_it_flies_by_its_own_words(self):
        self.fleet = support.make_fleet(self, DroneFleet, block=BLOCK)
        self.edit("node.json", lambda node: node.update(framework="skyco"))
        self.edit("profile.json", lambda profile: profile.update(skyco="direct"))
        self.edit("commands.json", lambda commands: commands.update(skyco=self.VENDOR))
        self.edit("robots/drone.json", lambda robot: robot.update(maker="Skyco", skills={"go_up": self.SKILL}, drives=self.BY_HAND))
        drone = self.fleet.start_drone("--port", "6556")
        self.fleet.start()
        self.fleet.wait_robot("ONLINE")
        path = self.fleet.root / "up.json"
        path.write_text(json.dumps({"name": "up", "tasks": [{"id": "up", "robot": "drone", "skill": "go_up"}]}))
        self.fleet.wait("the cloud knows the drone", lambda: self.fleet.formed(), 60)
        done = self.fleet.trb("scenario", "run", path, "--watch", "--timeout", 30, node="cloud", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(float(json.loads(self.fleet.ask("how_high").stdout)["data"]), 0.5)
        self.assertEqual(self.fleet.send("call_it", '"bee"', "--take").returncode, 0)
        drone.wait_line("config general:ardrone_name bee", 60)
        self.fleet.trb("stop", "drone", node="cloud")
        drone.wait_line("state landed", 60)

if __name__ == "__main__":
    support.main()
