"""kill -9 of any process: an idle fleet heals within 5 s, and a run neither loses a task nor commands one twice."""
import os
import signal
import time

import support
import trb_fleet
from support import CLOUD, HEAL_S, LONG_S, TRIES

ROBOTS = {
    "ridgeback": ("lines", "ridgeback", ["--skill", "fetch=6", "--skill", "load_out=1"]),
    "ur3": ("ur", "ur3", []),
    "conveyor": ("lines", "conveyor", ["--skill", "run=6"]),
}
# Each robot passes a box on to another: it is fetched, conveyed, picked up and loaded out.
SCENARIO = {
    "name": "kills",
    "tasks": [
        {"id": "fetch", "robot": "ridgeback", "skill": "fetch", "data": {"from": "table1", "to": "conveyor_entry"}},
        {"id": "convey", "robot": "conveyor", "skill": "run", "after": ["fetch"]},
        {"id": "pick", "robot": "ur3", "skill": "pick", "data": {"side": "left"}, "after": ["convey"]},
        {"id": "load", "robot": "ridgeback", "skill": "load_out", "after": ["pick"]},
    ],
}
COMMANDED_ONCE = {"ridgeback": ["fetch", "load_out"], "conveyor": ["run"], "ur3": ["program"]}


class IdleFleet(support.FleetTest):
    """In a fleet of eight nodes one process dies; then its node and the cloud see everything as before."""

    BLOCK = 66

    def all_pids(self):
        return set(support.processes_of(self.root, self.block))

    def heal(self, what, kill, is_back, robot):
        """Kills; the other processes stay; then the table is complete and a message goes to `robot` and back. The fastest of
        three tries counts: other load may delay one."""
        self.in_time(what, lambda: self.healed(what, kill, is_back, robot))

    def in_time(self, what, heal):
        for _ in range(TRIES):
            began = time.monotonic()
            heal()
            seconds = time.monotonic() - began
            support.tell(f"healed in {seconds:.2f} s: {what}")
            if seconds < HEAL_S:
                break
        self.assertLess(seconds, HEAL_S, what)

    def healed(self, what, kill, is_back, robot):
        before = self.all_pids()
        others = [r for r in ("pioneer2", "turtlebot", "drone") if r != robot]
        old = kill()
        self.assertTrue(self.works(others[0], others[1], TRIES), f"{what}: the rest stands still")
        at = robot or CLOUD
        self.fleet.wait(what, lambda: is_back(old) and self.fleet.formed(at) and self.fleet.formed(CLOUD)
                        and self.works(robot or "pioneer1"), LONG_S)
        self.assertEqual(before - self.all_pids(), {old}, f"{what}: another process ended too")

    def test_services(self):
        kinds = {node: ("router", "scheduler", "mode-adapter") for node in ("ridgeback", "ur3")}
        kinds[CLOUD] = ("router", "scheduler")
        for node, services in kinds.items():
            for service in services:
                with self.subTest(node=node, service=service):
                    self.heal(f"{service} of {node}", lambda n=node, s=service: self.kill_service(n, s),
                              lambda old, n=node, s=service: self.is_back(n, s, old), None if node == CLOUD else node)
        # The schedulers' exchange goes on, too.
        self.assertEqual(self.fleet.trb("scenario", "list", node="ridgeback").returncode, 0)

    def test_virtual_robots(self):
        """A robot's own program restarts only when a person switches it on: here at once."""
        for robot in self.fleet.robots:
            def kill_and_restart(name=robot):
                pid = self.fleet.virtual[name].child.pid
                self.kill_robot(name)
                self.fleet.wait("its end is seen", lambda: self.robot_state(name) != "ONLINE", LONG_S)
                self.fleet.start_robot(name)
                return pid

            with self.subTest(robot=robot):
                self.heal(f"virtual robot of {robot}", kill_and_restart, lambda old: True, robot)

    def test_a_whole_node(self):
        for node in ("ridgeback", CLOUD):
            self.in_time(f"node {node}", lambda killed=node: self.kill_and_start(killed))

    def kill_and_start(self, node):
        self.kill_node(node)
        self.assertTrue(self.works("turtlebot", "pioneer2", TRIES))
        self.start_node(node)
        self.fleet.wait("the node is back", lambda: self.fleet.formed(node) and self.fleet.formed("ur3")
                        and self.works("ridgeback", node="ur3"), LONG_S)


class RunFleet(support.FleetTest):
    """One process dies while a run goes on. The virtual robots' output shows how often they were commanded."""

    BLOCK = 68
    ROBOTS = ROBOTS
    SPEED = 1.5  # the test acts while a robot moves: for 3 s at least

    def assert_finished_once(self, run, mark):
        view = self.wait_state(run, "FINISHED", "PAUSED")
        self.assertEqual(view["state"], "FINISHED", view)
        self.assertEqual([t["state"] for t in view["tasks"]], ["FINISHED"] * 4)
        self.assertEqual({robot: self.commanded(mark, robot) for robot in ROBOTS}, COMMANDED_ONCE)

    def started(self):
        mark = self.mark()
        return self.submit(SCENARIO), mark

    def wait_convey_starts(self, mark):
        self.wait_robot(mark, "conveyor", "start run")

    def resume(self, pid):
        os.kill(pid, signal.SIGCONT)

    # ---- the scheduler of the robot that executes

    def test_scheduler_before_the_baton_came(self):
        """Stopped while its predecessor works, so that the baton waits unread; then killed: it is passed again."""
        run, mark = self.started()
        self.wait_robot(mark, "ridgeback", "start fetch")
        self.pause_service("conveyor", "scheduler")
        self.wait_task(run, "fetch", "FINISHED")
        self.kill_service("conveyor", "scheduler")
        self.assert_finished_once(run, mark)

    def test_scheduler_before_the_command(self):
        """The mode-adapter is stopped before the task becomes ready: the start is on record and the command on its way,
        but not read, when the scheduler dies. The new one queries; both messages are then read in their order."""
        run, mark = self.started()
        self.wait_robot(mark, "ridgeback", "start fetch")
        adapter = self.pause_service("conveyor", "mode-adapter")
        self.wait_task(run, "convey", "INITIALIZING")
        old = self.kill_service("conveyor", "scheduler")
        self.fleet.wait("a new scheduler", lambda: self.fleet.pid("conveyor", "scheduler") not in (None, old), LONG_S)
        self.assertEqual(self.commanded(mark, "conveyor"), [])
        self.resume(adapter)
        self.assert_finished_once(run, mark)

    def test_scheduler_while_the_robot_moves(self):
        run, mark = self.started()
        self.wait_convey_starts(mark)
        self.kill_service("conveyor", "scheduler")
        self.assert_finished_once(run, mark)

    def test_scheduler_when_the_outcome_came(self):
        """Stopped while the robot moves, killed once the robot is done: the outcome waits unread and is sent again."""
        run, mark = self.started()
        self.wait_convey_starts(mark)
        self.pause_service("conveyor", "scheduler")
        self.wait_robot(mark, "conveyor", "done run")
        self.kill_service("conveyor", "scheduler")
        self.assert_finished_once(run, mark)

    def test_scheduler_after_the_result(self):
        """Killed as soon as the cloud shows the result; whether the baton had gone is left to chance."""
        run, mark = self.started()
        self.wait_task(run, "convey", "FINISHED")
        self.kill_service("conveyor", "scheduler")
        self.assert_finished_once(run, mark)

    def test_scheduler_at_the_moment_of_done(self):
        run, mark = self.started()
        self.wait_robot(mark, "conveyor", "done run")
        self.kill_service("conveyor", "scheduler")
        self.assert_finished_once(run, mark)

    def test_schedulers_of_the_arm_and_of_the_cloud(self):
        run, mark = self.started()
        self.kill_service(CLOUD, "scheduler")
        self.wait_robot(mark, "ur3", "started")
        self.kill_service("ur3", "scheduler")
        self.assert_finished_once(run, mark)

    # ---- the mode-adapter

    def test_mode_adapter_while_the_robot_moves(self):
        for robot, task, at in (("conveyor", "convey", "start run"), ("ur3", "pick", "started")):
            with self.subTest(robot=robot):
                run, mark = self.started()
                self.wait_robot(mark, robot, at)
                old = self.kill_service(robot, "mode-adapter")
                self.assert_interrupted(run, task, robot)
                self.wait_back(robot, "mode-adapter", old)
                self.fleet.wait("the robot is back", lambda: self.works(robot), LONG_S)
                self.assertEqual(self.view(run)["state"], "PAUSED")
                self.assertEqual(self.commanded(mark, robot), COMMANDED_ONCE[robot])
                self.abort_run(run)
                self.wait_still(mark, robot)
                self.assertEqual(self.commanded(mark, robot), COMMANDED_ONCE[robot])

    def assert_interrupted(self, run, task, robot):
        view = self.wait_state(run, "PAUSED", "FINISHED")
        self.assertEqual(view["state"], "PAUSED")
        self.assertIn(f"'{task}' was interrupted on '{robot}'", view["waits_for"])
        outcome = next(t for t in view["tasks"] if t["id"] == task)
        self.assertEqual((outcome["state"], outcome["outcome"]), ("RETRIABLE", "interrupted"))

    def wait_still(self, mark, robot):
        """The robot is halted by the new process, which did not begin what it does: its next task would find it in motion."""
        ends = ("failed run stopped",) if robot != "ur3" else ("stopped",)
        self.fleet.wait("the robot stands",
                        lambda: any(line.startswith(ends) for line in self.lines_since(mark, robot)), LONG_S)

    # ---- the routers

    def test_router_of_the_robot_that_executes(self):
        run, mark = self.started()
        self.wait_convey_starts(mark)
        self.kill_service("conveyor", "router")
        self.assert_finished_once(run, mark)

    def test_router_of_the_next_robot(self):
        run, mark = self.started()
        self.wait_convey_starts(mark)
        self.kill_service("ur3", "router")
        self.assert_finished_once(run, mark)

    def test_router_of_the_cloud(self):
        run, mark = self.started()
        self.kill_service(CLOUD, "router")
        self.assert_finished_once(run, mark)

    # ---- the submitter

    def test_the_cloud_node_while_the_first_robot_works(self):
        """The run has left the cloud: the robots finish it without the node that it came from."""
        run, mark = self.started()
        self.wait_robot(mark, "ridgeback", "start fetch")
        self.kill_node(CLOUD)
        self.wait_robot(mark, "ridgeback", "done load_out")
        self.assertEqual({robot: self.commanded(mark, robot) for robot in ROBOTS}, COMMANDED_ONCE)
        self.start_node(CLOUD)
        self.assert_known_as_finished(run)
        self.assert_finished_once(run, mark)
        self.fleet.wait_formed(LONG_S)

    def test_the_cloud_node_right_after_submitting(self):
        """Only the acceptance is journaled: whether the run had left is chance. It is finished once either way."""
        run, mark = self.started()
        self.kill_node(CLOUD)
        self.start_node(CLOUD)
        self.assert_known_as_finished(run)
        self.assert_finished_once(run, mark)
        self.fleet.wait_formed(LONG_S)

    def assert_known_as_finished(self, run):
        done = self.fleet.trb("scenario", "watch", run, "--timeout", LONG_S, node=CLOUD, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("FINISHED", done.stdout)

    def test_the_command_line_that_submitted(self):
        mark = self.mark()
        trb = trb_fleet.Process([support.PROGRAMS / "trb", "scenario", "run", self.scenario_file(SCENARIO), "--watch",
                                 "--node", self.fleet.dir(CLOUD)], self.root / "submit.log")
        line = trb.wait_line("run ", LONG_S)[0]
        trb.stop(signal.SIGKILL)
        self.assert_finished_once(line.split()[1], mark)


if __name__ == "__main__":
    support.main()
