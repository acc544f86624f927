"""Robots and nodes that come late, hang, leave and come back: the run waits for them and shows it."""
import os
import signal

import support
import trb_fleet
from support import CLOUD

ROBOTS = {
    "ridgeback": ("lines", "ridgeback", ["--skill", "fetch=6", "--skill", "load_out=1"]),
    "ur3": ("ur", "ur3", []),
    "conveyor": ("lines", "conveyor", ["--skill", "run=6"]),
}
SCENARIO = {
    "name": "late",
    "tasks": [
        {"id": "fetch", "robot": "ridgeback", "skill": "fetch", "data": {"from": "table1", "to": "conveyor_entry"}},
        {"id": "convey", "robot": "conveyor", "skill": "run", "after": ["fetch"]},
        {"id": "pick", "robot": "ur3", "skill": "pick", "data": {"side": "left"}, "after": ["convey"]},
    ],
}


class Late(support.FleetTest):
    BLOCK = 70
    ROBOTS = ROBOTS
    SPEED = 1.5  # the test acts while a robot moves: for 3 s at least

    def started(self):
        mark = self.mark()
        return self.submit(SCENARIO), mark

    def assert_finished_once(self, run, mark):
        view = self.wait_state(run, "FINISHED", "PAUSED")
        self.assertEqual(view["state"], "FINISHED", view)
        self.assertEqual({robot: self.commanded(mark, robot) for robot in ROBOTS},
                         {"ridgeback": ["fetch"], "conveyor": ["run"], "ur3": ["program"]})

    def wait_robot_state(self, robot, state, node=CLOUD):
        self.fleet.wait(f"{robot} is {state}", lambda: self.robot_state(robot, node) == state, support.LONG_S)

    def start_robot(self, robot):
        self.fleet.start_robot(robot)
        self.wait_robot_state(robot, "ONLINE")

    # ---- robots

    def test_a_robot_that_connects_late(self):
        """Its task is ready long before it; its node shows what it waits for, and the command comes once."""
        for robot, task in (("conveyor", "convey"), ("ur3", "pick")):
            with self.subTest(robot=robot):
                self.kill_robot(robot)
                self.wait_robot_state(robot, "CONNECTION_BROKEN")
                mark = {r: (p, len(p.lines)) for r, p in self.fleet.virtual.items()}
                mark[robot] = (None, 0)
                run = self.submit(SCENARIO)

                def waits():
                    view = self.view(run, robot)
                    return f"'{task}'" in view["waits_for"] and "CONNECTION_BROKEN" in view["waits_for"]

                self.fleet.wait("its node says what it waits for", waits, support.LONG_S)
                self.assertEqual(self.view(run)["state"], "RUNNING")
                self.start_robot(robot)
                self.assert_finished_once(run, mark)

    def test_a_robot_that_hangs_while_it_moves(self):
        """It only takes longer than it should: no other robot gets its task."""
        run, mark = self.started()
        self.wait_robot(mark, "conveyor", "start run")
        pid = self.pause_robot("conveyor")
        self.assertTrue(self.works("ridgeback", "ur3", support.TRIES), "the others go on")
        self.assertEqual(self.view(run)["state"], "RUNNING")
        os.kill(pid, signal.SIGCONT)
        self.assert_finished_once(run, mark)

    def test_a_robot_that_hangs_before_its_command(self):
        """It does not acknowledge the fields. Whether it has read them is not known: a person has to decide."""
        run, mark = self.started()
        self.wait_robot(mark, "ridgeback", "start fetch")
        pid = self.pause_robot("conveyor")
        view = self.wait_state(run, "PAUSED", "FINISHED")
        self.assertEqual(view["state"], "PAUSED")
        self.assertIn("'convey' was interrupted on 'conveyor'", view["waits_for"])
        os.kill(pid, signal.SIGCONT)
        self.fleet.wait("it is back", lambda: self.works("conveyor"), support.LONG_S)
        self.assertLessEqual(len(self.commanded(mark, "conveyor")), 1)
        self.assertEqual(self.commanded(mark, "ur3"), [])
        self.abort_run(run)
        self.stand("conveyor")

    def stand(self, robot):
        """Ends whatever the robot is still doing."""
        for word in ("stop", "release"):
            status, answer = self.ask(word, robot)
            self.assertEqual(status, 0, answer)

    def test_an_arm_that_hangs_while_it_moves(self):
        """Its controller is silent for 3 s: the connection counts as lost, and the task as interrupted."""
        run, mark = self.started()
        self.wait_robot(mark, "ur3", "started")
        pid = self.pause_robot("ur3")
        view = self.wait_state(run, "PAUSED", "FINISHED")
        self.assertEqual(view["state"], "PAUSED")
        self.assertIn("'pick' was interrupted on 'ur3'", view["waits_for"])
        self.wait_robot_state("ur3", "CONNECTION_BROKEN")
        os.kill(pid, signal.SIGCONT)
        self.wait_robot_state("ur3", "ONLINE")
        self.abort_run(run)
        self.stand("ur3")
        self.assertEqual(self.commanded(mark, "ur3"), ["program"])

    def test_a_robot_that_leaves_and_comes_back(self):
        for how in ("drop", "quit"):
            with self.subTest(how=how):
                mark = self.mark()
                self.fleet.virtual["conveyor"].say(how)
                if how == "quit":
                    self.wait_robot_state("conveyor", "CONNECTION_BROKEN")
                    self.assertEqual(self.refusal("send", "conveyor", "command", "wave")["code"], "no_field_channel")
                    self.fleet.virtual.pop("conveyor").stop()
                    self.fleet.start_robot("conveyor")
                self.wait_robot(mark, "conveyor", "connected")
                self.fleet.wait("messages go again", lambda: self.works("conveyor"), support.LONG_S)
                self.wait_robot_state("conveyor", "ONLINE", "ur3")

    def test_a_robot_that_leaves_while_it_moves(self):
        run, mark = self.started()
        self.wait_robot(mark, "conveyor", "start run")
        self.fleet.virtual["conveyor"].say("drop")
        view = self.wait_state(run, "PAUSED", "FINISHED")
        self.assertEqual(view["state"], "PAUSED")
        self.assertIn("'convey' was interrupted on 'conveyor'", view["waits_for"])
        self.wait_robot_state("conveyor", "ONLINE")
        self.wait_robot(mark, "conveyor", "failed run stopped")  # it went on: halted before anything else may begin
        self.assertTrue(self.works("conveyor", tries=support.TRIES))
        self.assertEqual(self.view(run)["state"], "PAUSED")
        self.assertEqual(self.commanded(mark, "conveyor"), ["run"])
        self.assertEqual(self.commanded(mark, "ur3"), [])
        self.abort_run(run)

    # ---- nodes

    def test_a_node_restarted_while_a_run_waits_for_it(self):
        """Once by command, once as if its power failed."""
        ways = {"ended": lambda: self.fleet.nodes.pop("ur3").stop(), "killed": lambda: self.kill_node("ur3")}
        for how, end in ways.items():
            with self.subTest(how=how):
                run, mark = self.started()
                self.wait_robot(mark, "ridgeback", "start fetch")
                end()
                self.wait_robot(mark, "conveyor", "done run")
                self.wait_task(run, "convey", "FINISHED")
                self.assertEqual(self.view(run)["state"], "RUNNING")
                self.assertEqual(self.commanded(mark, "ur3"), [])
                self.start_node("ur3")
                self.assert_finished_once(run, mark)
                self.fleet.wait_formed(support.LONG_S)

    def test_a_node_that_leaves_before_a_run_is_submitted(self):
        """Its certificate is known, so the run takes it as a member and waits for it."""
        self.kill_node("conveyor")
        run, mark = self.started()
        self.wait_task(run, "fetch", "FINISHED")
        self.start_node("conveyor")
        self.assert_finished_once(run, mark)
        self.fleet.wait_formed(support.LONG_S)


class Join(support.FleetTest):
    """A running fleet admits a node that was made later, whose robot is switched on last."""

    BLOCK = 72
    ROBOTS = {"ridgeback": ROBOTS["ridgeback"]}

    def test_a_node_that_joins(self):
        fleet = self.fleet
        fleet.robots["pioneer1"] = trb_fleet.ROBOTS["pioneer1"]
        fleet.node_names.append("pioneer1")
        scenario = {"name": "join", "tasks": [
            {"id": "there", "robot": "pioneer1", "skill": "go_to", "data": {"place": "table1"}},
            {"id": "load", "robot": "ridgeback", "skill": "load_out", "after": ["there"]}]}
        file = self.scenario_file(scenario)

        def refused():
            """Not in the first seconds of a router: the robot may be there, and not heard yet."""
            exit_code, said = self.ask("scenario", "run", file)
            self.assertEqual(exit_code, 1)
            if "peer_unreachable" in str(said):
                return False
            self.assertIn("pioneer1", str(said))
            return True

        fleet.wait("the scenario is refused", refused, support.LONG_S)
        fleet.make_node("pioneer1")
        fleet.trb("fleet", "sign", fleet.authority_dir(), fleet.dir("pioneer1") / "keys" / "request.json")
        self.start_node("pioneer1")
        self.fleet.wait("its node is known", lambda: self.robot_state("pioneer1") == "OFFLINE", support.LONG_S)
        run = self.submit(scenario)
        self.fleet.wait("its node says what it waits for", lambda: "OFFLINE" in self.view(run, "pioneer1")["waits_for"],
                        support.LONG_S)
        mark = self.mark()
        mark["pioneer1"] = (None, 0)
        fleet.start_robot("pioneer1")
        support.tell(f"a new robot is known to all: {fleet.wait_formed(support.LONG_S):.2f} s")
        self.wait_state(run, "FINISHED")
        self.assertEqual(self.commanded(mark, "pioneer1"), ["go_to"])
        self.assertEqual(self.commanded(mark, "ridgeback"), ["load_out"])


if __name__ == "__main__":
    support.main()
