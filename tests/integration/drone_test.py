"""The drone over its maker's protocol, one side at a time: a raw client against the virtual drone, a raw drone against
the mode-adapter, and both together in a fleet. Addresses 127.0.144.x and 127.0.145.x."""
import json
import os
import signal
import statistics
import subprocess
import time
import unittest

import raw_drone
import support
import trb_fleet
from raw_drone import AIR, GROUND, TOGGLE, bits_of

VIRTUAL = support.PROGRAMS / "trb-virtual-drone"


class DroneFleet(trb_fleet.Fleet):
    """A drone's node and the cloud; the drone itself is for the tests to start."""

    def __init__(self, root, programs):
        super().__init__(root, programs, block=144, robots={"drone": ("ardrone", "drone", [])})

    def start_robot(self, node, *more):
        pass

    def start_drone(self, *more):
        super().start_robot("drone", *more)
        self.virtual["drone"].wait_line("ready", 2)
        return self.virtual["drone"]

    def kill_drone(self):
        self.virtual.pop("drone").stop(signal.SIGKILL)

    def profile(self):
        routes = self.json("route", "list", node="drone")["routes"]
        return next(route for route in routes if route["id"] == "drone")["profile"]

    def wait_robot(self, state, timeout=15):
        return self.wait(f"the drone is {state}", lambda: self.profile()["robot"] == state, timeout)

    def send(self, subtype, data="", *more):
        return self.trb("send", "drone", "command", subtype, data, *more, node="cloud", check=False)

    def ask(self, subtype):
        return self.trb("request", "drone", subtype, "--json", node="cloud", check=False)

    def counters(self):
        rows = self.json("service", "counters", "mode-adapter", node="drone")["values"]
        return {row["name"]: int(row["value"]) for row in rows}


class RawClient(unittest.TestCase):
    """The virtual drone against a client that is independent of this repository."""

    def setUp(self):
        self.drone = trb_fleet.Process([VIRTUAL, "--address", "127.0.145.9", "--port", "auto", "--die-with-parent"],
                                       os.devnull, stdin=subprocess.PIPE)
        self.addCleanup(self.drone.stop)
        line, _ = self.drone.wait_line("ready", 10)
        _, at_port, navdata_port = line.split()
        self.client = raw_drone.Client("127.0.145.9", int(at_port), int(navdata_port))
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
        self.drone.wait_line("command FTRIM", 2)

    def test_navdata_comes_fifteen_times_a_second(self):
        self.come_up()
        self.client.hold(GROUND)  # who commands and then falls silent is told nothing any more
        start, count = time.monotonic(), []
        self.client.wait("a second of navdata", lambda n: count.append(n) or len(count) > 30)
        self.assertAlmostEqual((time.monotonic() - start) / 30, 1 / 15, delta=0.02)

    def test_a_client_that_is_silent_is_given_up(self):
        self.take_off()
        self.client.hold(AIR)
        self.client.state = []
        heard = self.client.wait("the watchdog", lambda n: n["state"] & raw_drone.WATCHDOG)
        self.assertFalse(heard["state"] & raw_drone.COM_LOST)
        self.assertEqual(heard["control"], raw_drone.HOVERING)
        self.drone.wait_line("communication lost", 10)
        self.drone.wait_line("state landed", 10)
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

    def test_emergency_and_back(self):
        self.take_off()
        self.client.hold(TOGGLE)
        self.client.wait("motors cut", lambda n: n["state"] & raw_drone.EMERGENCY and n["altitude"] == 0)
        self.client.hold(GROUND)
        self.client.wait("still cut", lambda n: n["state"] & raw_drone.EMERGENCY)
        self.client.hold(TOGGLE)
        self.client.wait("recovered", lambda n: not n["state"] & raw_drone.EMERGENCY)

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
        self.drone.wait_line("rejected longer than 1024 bytes", 5)
        heard = self.client.wait("it still speaks", lambda n: True)
        self.assertEqual(heard["control"], raw_drone.LANDED)


class RawDrone(unittest.TestCase):
    """The mode-adapter flies a drone that is independent of this repository."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, DroneFleet)
        cls.fleet.start()

    def setUp(self):
        self.drone = raw_drone.Drone(self.fleet.robot_address("drone"))
        self.drone.start()
        self.addCleanup(self.let_go)
        self.fleet.wait_robot("ONLINE")

    def let_go(self):
        self.drone.close()
        self.fleet.wait_robot("CONNECTION_BROKEN", 10)

    def wait_call(self, mark, name, arguments, timeout=3):
        self.fleet.wait(f"{name} {arguments}", lambda: any(c[3] == arguments for c in self.drone.since(mark, name)), timeout)

    def test_it_is_woken_configured_and_acknowledged(self):
        names = [call[1] for call in self.drone.since(0)]
        self.assertEqual(names[:1], ["CONFIG"])
        self.assertLess(names.index("CTRL"), names.index("REF"))
        self.assertEqual(self.drone.since(0, "CONFIG")[0][3], '"general:navdata_demo","TRUE"')
        self.assertEqual(self.drone.since(0, "CTRL")[0][3], "5,0")

    def test_the_state_comes_every_30_ms_and_the_numbers_rise(self):
        mark = self.drone.mark()
        self.fleet.wait("300 states", lambda: len(self.drone.since(mark, "REF")) >= 300, 20)
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
        self.fleet.wait("50 states", lambda: len(self.drone.since(mark, "REF")) >= 50, 10)
        self.assertEqual([call[3] for call in self.drone.since(mark, "LED")], [f"3,{bits_of(0.5)},2"])
        self.assertEqual(len(self.drone.since(mark, "FTRIM")), 1)
        self.assertEqual(self.drone.since(mark, "REF")[-1][3], str(AIR))
        self.drone.is_in(state=raw_drone.FLYING, control=raw_drone.HOVERING, altitude_mm=800)
        self.fleet.wait("airborne", lambda: '"hovering"' in self.fleet.ask("state").stdout.replace("\\", ""), 5)
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
                            before.get(f"refused.{name}", 0), 5)
        self.assertEqual(self.fleet.profile()["robot"], "ONLINE")

    def test_text_that_the_protocol_cannot_carry_is_refused(self):
        mark = self.drone.mark()
        for text in ('"5\\"\\rAT*REF=9,290717952\\r"', '"5\\n"', '"5\\r"'):
            done = self.fleet.send("set_altitude_max", text)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("not_escapable", done.stderr)
        self.assertEqual(self.drone.since(mark, "CONFIG"), [])

    def test_a_drone_that_falls_silent_is_lost_and_comes_back(self):
        self.drone.answers = False
        start = time.monotonic()
        self.fleet.wait_robot("CONNECTION_BROKEN", 5)
        self.assertLess(time.monotonic() - start, 3.5)
        self.assertEqual(self.fleet.profile()["detail"], "no navdata for 2 s")
        mark, woken = self.drone.mark(), self.drone.woken
        self.fleet.wait("it is woken", lambda: self.drone.woken > woken, 3)
        self.assertEqual(self.drone.since(mark, "REF"), [])  # nothing is sent to a silent drone
        self.assertIn("robot_offline", self.fleet.send("land").stderr)
        self.drone.answers = True
        self.fleet.wait_robot("ONLINE", 5)


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
        self.fleet = support.make_fleet(self, DroneFleet)
        self.edit("node.json", lambda node: node.update(framework="skyco"))
        self.edit("profile.json", lambda profile: profile.update(skyco="direct"))
        self.edit("commands.json", lambda commands: commands.update(skyco=self.VENDOR))
        self.edit("robots/drone.json", lambda robot: robot.update(maker="Skyco", skills={"go_up": self.SKILL}, drives=self.BY_HAND))
        drone = self.fleet.start_drone("--port", "6556")
        self.fleet.start()
        self.fleet.wait_robot("ONLINE")
        path = self.fleet.root / "up.json"
        path.write_text(json.dumps({"name": "up", "tasks": [{"id": "up", "robot": "drone", "skill": "go_up"}]}))
        self.fleet.wait("the cloud knows the drone", lambda: self.fleet.formed(), 20)
        done = self.fleet.trb("scenario", "run", path, "--watch", "--timeout", 30, node="cloud", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(float(json.loads(self.fleet.ask("how_high").stdout)["data"]), 0.5)
        self.assertEqual(self.fleet.send("call_it", '"bee"', "--take").returncode, 0)
        drone.wait_line("config general:ardrone_name bee", 5)
        self.fleet.trb("stop", "drone", node="cloud")
        drone.wait_line("state landed", 10)


class EndToEnd(unittest.TestCase):
    """The whole way: trb, router, mode-adapter, and a drone in its maker's protocol on its own ports."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, DroneFleet)
        cls.fleet.start()
        cls.fleet.wait("the cloud knows the drone's node", cls.known, 20)

    @classmethod
    def known(cls):
        done = cls.fleet.trb("route", "list", "--json", node="cloud", check=False)
        return done.returncode == 0 and any(r["id"] == "drone" and r["state"] == "ONLINE"
                                            for r in json.loads(done.stdout)["routes"])

    def setUp(self):
        self.drone = self.fleet.start_drone()
        self.fleet.wait_robot("ONLINE")
        self.addCleanup(self.let_go)

    def let_go(self):
        if "drone" in self.fleet.virtual:
            self.fleet.virtual["drone"].child.send_signal(signal.SIGCONT)
            self.fleet.kill_drone()
        self.fleet.wait_robot("CONNECTION_BROKEN", 10)
        self.fleet.trb("release", "drone", node="drone", check=False)

    def take_off(self):
        done = self.fleet.send("take_off", "", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.fleet.wait("it hovers", lambda: "hovering" in self.fleet.ask("state").stdout, 10)
        self.fleet.pump()

    def run_scenario(self, tasks):
        scenario = {"name": "flight", "tasks": tasks}
        path = self.fleet.root / "flight.json"
        path.write_text(json.dumps(scenario))
        return self.fleet.json("scenario", "run", path, node="cloud")["run"]

    def watch(self, run, timeout=40):
        return self.fleet.trb("scenario", "watch", run, "--until-paused", "--timeout", timeout, node="cloud", check=False)

    def flight(self, hover_s=2):
        return [{"id": "up", "robot": "drone", "skill": "take_off"},
                {"id": "stay", "robot": "drone", "skill": "hover", "data": {"duration": hover_s}, "after": ["up"]},
                {"id": "down", "robot": "drone", "skill": "land", "after": ["stay"]}]

    def hover_as_a_task(self):
        """A run that is in the middle of its hovering."""
        before = self.fleet.counters().get("to_robot.hover", 0)
        run = self.run_scenario(self.flight(60))
        self.fleet.wait("the task hovers", lambda: self.fleet.counters().get("to_robot.hover", 0) > before, 20)
        return run

    def test_take_off_hover_and_land_as_a_scenario(self):
        start = time.monotonic()
        done = self.watch(self.run_scenario(self.flight()))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(time.monotonic() - start, 6)  # 2 s up, 2 s there, 2 s down
        self.fleet.pump()
        lines = [line for line in self.drone.lines if line.startswith("state")]
        self.assertEqual(lines, ["state taking_off", "state hovering", "state landing", "state landed"])
        self.assertIn("command FTRIM", self.drone.lines)

    def test_commands_and_requests_of_a_person(self):
        self.take_off()
        self.assertEqual(self.fleet.send("move", "[0, -0.5, 0, 0, 1]").returncode, 0)
        self.drone.wait_line("state flying", 5)
        at = len(self.drone.lines)
        self.drone.wait_line("state hovering", 5, at - 1)
        self.assertIn(json.loads(self.fleet.ask("battery").stdout)["data"], ("99", "100"))
        self.assertEqual(self.fleet.send("set_altitude_max", "2500").returncode, 0)
        self.drone.wait_line("config control:altitude_max 2500", 5)
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 10)
        self.assertIn("the drone is not in the air", self.fleet.send("move", "[0, -0.5, 0, 0, 1]").stderr)

    def test_a_stop_in_the_air_stands_and_fences(self):
        self.take_off()
        self.assertEqual(self.fleet.send("move", "[0, -1, 0, 0, 60]").returncode, 0)
        self.drone.wait_line("state flying", 5)
        at = len(self.drone.lines)
        done = self.fleet.trb("stop", "drone", node="cloud", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.drone.wait_line("state hovering", 5, at)
        self.assertIn("fenced", self.fleet.send("land").stderr)
        self.assertNotIn("state landing", self.drone.lines)
        self.fleet.trb("release", "drone", node="cloud")
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 10)

    def test_emergency_and_recover(self):
        self.take_off()
        done = self.fleet.send("emergency")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.drone.wait_line("emergency on", 5)
        self.assertIn("motors are cut", self.fleet.send("take_off").stderr)
        self.assertEqual(self.fleet.send("recover").returncode, 0)
        self.drone.wait_line("emergency off", 5)
        self.drone.pump(0.3)
        self.assertEqual(self.drone.lines.count("state taking_off"), 1)  # it does not take off by itself
        self.take_off()

    def test_a_fault_in_the_middle_of_a_task_is_told_and_the_task_fails(self):
        tap = trb_fleet.Process([support.PROGRAMS / "trb", "tap", "--subtype", "robot_fault", "--json", "--node",
                                 self.fleet.dir("drone")], self.fleet.root / "tap.log")
        self.addCleanup(tap.stop)
        run = self.hover_as_a_task()
        self.drone.say("fault fly CRITICAL a bird")
        line, _ = tap.wait_line("robot_fault", 10)
        self.assertIn("emergency: the motors are cut (cutout", line)
        self.assertIn("CRITICAL", line)
        done = self.watch(run)
        self.assertIn("motors were cut", done.stdout)
        self.fleet.trb("scenario", "abort", run, node="cloud", check=False)

    def vanish(self, how, reason):
        run = self.hover_as_a_task()
        start = time.monotonic()
        self.drone.child.send_signal(how)
        self.fleet.wait_robot("CONNECTION_BROKEN", 6)
        print(f"lost by {how.name} after {time.monotonic() - start:.1f} s: {self.fleet.profile()['detail']}", flush=True)
        self.assertIn(reason, self.fleet.profile()["detail"])
        done = self.watch(run)
        self.assertIn("link was lost", done.stdout)
        self.fleet.trb("scenario", "abort", run, node="cloud", check=False)

    def test_a_drone_that_is_killed_in_the_air(self):
        self.vanish(signal.SIGKILL, "refused")

    def test_a_drone_that_hangs_in_the_air_and_goes_on(self):
        self.vanish(signal.SIGSTOP, "no navdata for 2 s")
        self.drone.child.send_signal(signal.SIGCONT)
        self.fleet.wait_robot("ONLINE", 10)

    def test_a_node_that_dies_in_the_air(self):
        self.take_off()
        os.kill(self.fleet.pid("drone", "mode-adapter"), signal.SIGKILL)
        # The new one is there at once, counts from 1 again, and leaves the drone where it is.
        self.fleet.wait("a new adapter", lambda: self.fleet.ask("state").returncode == 0, 10)
        self.assertIn("hovering", self.fleet.ask("state").stdout)
        self.assertNotIn("state landing", self.drone.lines)
        self.assertEqual(self.fleet.send("land", "", "--take").returncode, 0)
        self.drone.wait_line("state landed", 10)

    def test_two_commands_at_once(self):
        self.take_off()
        both = [subprocess.Popen([support.PROGRAMS / "trb", "send", "drone", "command", *words, "--node",
                                  self.fleet.dir("cloud")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                for words in (["hover", "30"], ["move", "[0, -0.5, 0, 0, 2]"])]
        for one in both:
            said, _ = one.communicate(timeout=15)
            self.assertEqual(one.returncode, 0, said)
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 10)


if __name__ == "__main__":
    support.main()
