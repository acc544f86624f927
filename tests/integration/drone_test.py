"""The drone over its maker's protocol in a fleet: router, scheduler, mode-adapter and the virtual drone. Addresses 127.0.144.x
and 127.0.145.x; one side at a time: drone_wire_test.py."""
import json
import os
import signal
import subprocess
import time
import unittest

import support
import trb_fleet
from drone_fleet import DroneFleet


class EndToEnd(unittest.TestCase):
    """The whole way: trb, router, mode-adapter, and a drone in its maker's protocol on its own ports."""

    @classmethod
    def setUpClass(cls):
        cls.fleet = support.make_fleet(cls, DroneFleet)
        cls.fleet.start()
        cls.fleet.wait("the cloud knows the drone's node", cls.known, 60)

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
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)
        self.fleet.trb("release", "drone", node="drone", check=False)

    def take_off(self):
        done = self.fleet.send("take_off", "", "--take")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.fleet.wait("it hovers", lambda: "hovering" in self.fleet.ask("state").stdout, 60)
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
        self.fleet.wait("the task hovers", lambda: self.fleet.counters().get("to_robot.hover", 0) > before, 60)
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
        self.drone.wait_line("state flying", 60)
        at = len(self.drone.lines)
        self.drone.wait_line("state hovering", 60, at - 1)
        self.assertGreater(int(json.loads(self.fleet.ask("battery").stdout)["data"]), 90)  # one percent in 7 s in the air
        self.assertEqual(self.fleet.send("set_altitude_max", "2500").returncode, 0)
        self.drone.wait_line("config control:altitude_max 2500", 60)
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 60)
        self.assertIn("the drone is not in the air", self.fleet.send("move", "[0, -0.5, 0, 0, 1]").stderr)

    def test_a_stop_in_the_air_stands_and_fences(self):
        self.take_off()
        self.assertEqual(self.fleet.send("move", "[0, -1, 0, 0, 60]").returncode, 0)
        self.drone.wait_line("state flying", 60)
        at = len(self.drone.lines)
        done = self.fleet.trb("stop", "drone", node="cloud", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.drone.wait_line("state hovering", 60, at)
        self.assertIn("fenced", self.fleet.send("land").stderr)
        self.assertNotIn("state landing", self.drone.lines)
        self.fleet.trb("release", "drone", node="cloud")
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 60)

    def test_emergency_and_recover(self):
        self.take_off()
        done = self.fleet.send("emergency")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.drone.wait_line("emergency on", 60)
        self.assertIn("motors are cut", self.fleet.send("take_off").stderr)
        self.assertEqual(self.fleet.send("recover").returncode, 0)
        self.drone.wait_line("emergency off", 60)
        self.drone.pump(0.3)
        self.assertEqual(self.drone.lines.count("state taking_off"), 1)  # it does not take off by itself
        self.take_off()

    def test_a_fault_in_the_middle_of_a_task_is_told_and_the_task_fails(self):
        tap = trb_fleet.Process([support.PROGRAMS / "trb", "tap", "--subtype", "robot_fault", "--json", "--node",
                                 self.fleet.dir("drone")], self.fleet.root / "tap.log")
        self.addCleanup(tap.stop)
        run = self.hover_as_a_task()
        self.drone.say("fault fly CRITICAL a bird")
        line, _ = tap.wait_line("robot_fault", 60)
        self.assertIn("emergency: the motors are cut (cutout", line)
        self.assertIn("CRITICAL", line)
        done = self.watch(run)
        self.assertIn("motors were cut", done.stdout)
        self.fleet.trb("scenario", "abort", run, node="cloud", check=False)

    def vanish(self, how, reason):
        run = self.hover_as_a_task()
        start = time.monotonic()
        self.drone.child.send_signal(how)
        self.fleet.wait_robot("CONNECTION_BROKEN", 60)
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
        self.fleet.wait_robot("ONLINE", 60)

    def test_a_node_that_dies_in_the_air(self):
        self.take_off()
        os.kill(self.fleet.pid("drone", "mode-adapter"), signal.SIGKILL)
        # The new one is there at once, counts from 1 again, and leaves the drone where it is.
        self.fleet.wait("a new adapter", lambda: self.fleet.ask("state").returncode == 0, 60)
        self.assertIn("hovering", self.fleet.ask("state").stdout)
        self.assertNotIn("state landing", self.drone.lines)
        self.assertEqual(self.fleet.send("land", "", "--take").returncode, 0)
        self.drone.wait_line("state landed", 60)

    def test_two_commands_at_once(self):
        self.take_off()
        both = [subprocess.Popen([support.PROGRAMS / "trb", "send", "drone", "command", *words, "--node",
                                  self.fleet.dir("cloud")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                for words in (["hover", "30"], ["move", "[0, -0.5, 0, 0, 2]"])]
        for one in both:
            said, _ = one.communicate(timeout=15)
            self.assertEqual(one.returncode, 0, said)
        self.assertEqual(self.fleet.send("land").returncode, 0)
        self.drone.wait_line("state landed", 60)

if __name__ == "__main__":
    support.main()
