"""`trb stop` while a scenario runs: each robot stands, fenced until it is released, and the run shows its wait."""
import json
import time

import support
import trb_fleet
from support import CLOUD

# It does not end by itself: each test stops it first.
ROBOTS = {**trb_fleet.ROBOTS, "ridgeback": ("lines", "ridgeback", ["--skill", "fetch=60", "--skill", "load_out=2", "--pose", "0,0,0"])}
FAR = [6.0, -1.2, 1.0, -1.4, -1.57, 0]
STOP_S = 3.0  # how long `trb stop` waits for confirmations


class Stop(support.FleetTest):
    BLOCK = 64
    ROBOTS = ROBOTS

    def order(self, word):
        """(exit status, robot -> state, seconds) of `trb stop --all` or `trb release --all`"""
        began = time.monotonic()
        status, answer = self.ask(word, "--all")
        return status, {r["robot"]: r["state"] for r in answer["robots"]}, time.monotonic() - began

    def stop_all(self, wanted):
        """Exit status. A stop may be said again: other load may delay one try."""
        for _ in range(support.TRIES):
            status, states, seconds = self.order("stop")
            if states == wanted and seconds < STOP_S + 1:
                break
        support.tell(f"trb stop --all, {states}: {seconds:.2f} s")
        self.assertEqual(states, wanted)
        self.assertLess(seconds, STOP_S + 1)
        return status

    def release_all(self):
        self.fleet.wait("all are released", lambda: self.order("release")[0] == 0, support.LONG_S)

    def start_run_and_arm(self):
        """The Ridgeback fetches the box while the UR moves by a person's command."""
        mark = self.mark()
        run = self.submit(support.PAPER)
        self.wait_robot(mark, "ridgeback", "start fetch")
        status, answer = self.ask("send", "ur3", "command", "move", json.dumps(FAR))
        self.assertEqual(status, 0, answer)
        self.wait_robot(mark, "ur3", "move movej 6.0000")
        return run, mark

    def assert_paused(self, run):
        view = self.wait_state(run, "PAUSED")
        self.assertIn("'fetch_box'", view["waits_for"])
        self.assertIn("'ridgeback'", view["waits_for"])
        self.assertIn("person", view["waits_for"])
        self.assertEqual([t["state"] for t in view["tasks"]], ["RETRIABLE"] + ["WAITING"] * 8)
        self.assertEqual(view["tasks"][0]["outcome"], "interrupted")

    def assert_fenced(self, robot):
        words = ["move", json.dumps(FAR)] if robot == "ur3" else ["wave", "hello"]
        error = self.refusal("send", robot, "command", *words)
        self.assertEqual(error["code"], "fenced")
        self.assertIn(f"trb release {robot}", error["cure"])

    def abort(self, run):
        done = self.abort_run(run, "--reason", "test")
        self.assertIn("every member that is not revoked has confirmed", done.stdout)
        for member in ("ridgeback", "conveyor", "ur3", "drone", CLOUD):
            self.wait_state(run, "ABORTED", node=member)  # each once all have confirmed to it, in any order

    def test_1_all_robots_stop_and_stay_fenced(self):
        run, mark = self.start_run_and_arm()
        self.assertEqual(self.stop_all({robot: "confirmed" for robot in self.fleet.robots}), 0)
        for robot in self.fleet.robots:
            self.wait_robot(mark, robot, "stopped")
        self.wait_robot(mark, "ridgeback", "failed fetch stopped")
        arm = self.lines_since(mark, "ur3")
        self.assertTrue([line for line in arm if line.startswith("program") and line.endswith(" stopped")], arm)
        self.assertFalse([line for line in arm if line.startswith("text") and line.endswith("done")], arm)
        self.assert_paused(run)
        for robot in self.fleet.robots:
            self.assert_fenced(robot)
        self.fence_survives_kill("ridgeback")
        self.fence_survives_kill("ur3")
        self.release_all()
        for robot in ("ridgeback", "pioneer1"):
            self.wait_robot(mark, robot, "released")
        self.command_works()
        self.abort(run)
        self.assertEqual(self.commanded(mark, "ridgeback"), ["fetch"])
        self.assertEqual(self.commanded(mark, "conveyor"), [])

    def fence_survives_kill(self, robot):
        mark = self.mark()
        old = self.kill_service(robot, "mode-adapter")
        self.wait_back(robot, "mode-adapter", old)
        self.assert_fenced(robot)
        self.fleet.wait("the robot is connected again", lambda: self.robot_state(robot) == "ONLINE", support.LONG_S)
        self.assertTrue(self.is_fenced(robot))
        self.assert_fenced(robot)
        # Until the new process has told its first word, the tables go on with the last one of the killed process.
        self.fleet.wait("requests go while it is fenced", lambda: self.works(robot), support.LONG_S)
        self.assertEqual(self.commanded(mark, robot), [])

    def command_works(self):
        mark = self.mark()
        status, answer = self.ask("send", "ur3", "command", "move", "[0,-1.57,0,-1.57,0,0]", "--take")
        self.assertEqual(status, 0, answer)
        self.wait_robot(mark, "ur3", "move movej 0.0000 -1.5700")
        status, answer = self.ask("send", "ridgeback", "command", "wave", "hello", "--take")
        self.assertEqual(status, 0, answer)
        self.wait_robot(mark, "ridgeback", "message command wave")

    def test_2_a_dead_node_and_a_hung_robot_are_told_apart(self):
        run, mark = self.start_run_and_arm()
        self.kill_node("drone")
        self.fleet.wait("the cloud has lost it", lambda: self.robot_state("drone") == "no node", support.LONG_S)
        hung = self.pause_robot("turtlebot")
        hung_arm = self.pause_robot("ur3")
        wanted = {robot: "confirmed" for robot in self.fleet.robots}
        wanted.update(drone="unreachable", turtlebot="sent", ur3="sent")
        self.assertEqual(self.stop_all(wanted), 1)
        self.wait_robot(mark, "ridgeback", "failed fetch stopped")
        self.assert_paused(run)
        self.assert_fenced("turtlebot")
        # A hung process finds the stop when it wakes.
        for robot, pid in (("turtlebot", hung), ("ur3", hung_arm)):
            support.send_signal(pid, support.signal.SIGCONT)
            self.wait_robot(mark, robot, "stopped")
        self.abort_waits_for_the_dead(run)
        self.release_all()
        self.fleet.wait_formed(support.LONG_S)
        self.command_works()
        self.assertEqual(self.commanded(mark, "drone"), [])

    def abort_waits_for_the_dead(self, run):
        done = self.fleet.trb("scenario", "abort", run, "--timeout", "1", node=CLOUD, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("ABORTING", done.stdout)
        self.assertIn("'drone'", done.stdout)
        self.start_node("drone")
        self.wait_state(run, "ABORTED")
        self.fleet.wait("the drone is connected", lambda: self.robot_state("drone") == "ONLINE", support.LONG_S)

    def test_3_stop_of_one_robot_leaves_the_others_alone(self):
        mark = self.mark()
        status, answer = self.ask("stop", "pioneer1", "--reason", "hand in the cell")
        self.assertEqual((status, answer["robots"][0]["state"]), (0, "confirmed"))
        self.wait_robot(mark, "pioneer1", "stopped")
        self.assert_fenced("pioneer1")
        self.command_works()
        self.assertEqual(self.lines_since(mark, "pioneer2"), [])
        self.release_all()


if __name__ == "__main__":
    support.main()
