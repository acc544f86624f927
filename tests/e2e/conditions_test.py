"""Tasks that depend on a sensor's value: the paper's task 6, its sensor fed by a line of shell over a real D-Bus."""
import json
import os
import subprocess

import support
import private_bus
import trb_fleet
from support import CLOUD

TEMPERATURE = support.REPO / "config" / "scenarios" / "paper-temperature.json"
ROBOTS = {
    "ridgeback": ("lines", "ridgeback", ["--skill", "fetch=1", "--skill", "load_out=1", "--pose", "0,0,0"]),
    "ur3": ("ur", "ur3", []),
    "drone": ("lines", "drone", ["--skill", "take_off=1", "--skill", "land=1"]),
    "conveyor": ("lines", "conveyor", ["--skill", "run=1"]),
}


def over(op):
    return {"sensor": "temperature", "of": "conveyor", "op": op, "value": 20, "unit": "degC"}


# The conditions are evaluated by the ridgeback's node; the tasks are two other nodes'.
TWO_ROBOTS = {
    "name": "left-or-right",
    "tasks": [
        {"id": "bring", "robot": "ridgeback", "skill": "load_out"},
        {"id": "left", "robot": "ur3", "skill": "pick", "data": {"side": "left"}, "after": ["bring"], "when": over("<=")},
        {"id": "right", "robot": "drone", "skill": "take_off", "after": ["bring"], "when": over(">")},
        {"id": "join", "robot": "conveyor", "skill": "run", "after": ["left", "right"]},
    ],
}


class SensorFleet(trb_fleet.Fleet):
    """The conveyor's node has a sensor-bus, on a D-Bus of its own."""

    def __init__(self, *arguments, **more):
        super().__init__(*arguments, **more)
        self.bus = private_bus.PrivateBus(self.root.parent)

    def node_json(self, node):
        out = super().node_json(node)
        if node != "conveyor":
            return out
        return {**out, "services": [*out["services"], "sensor-bus"], "dbus": self.bus.address}


class Conditions(support.FleetTest):
    BLOCK = 74
    ROBOTS = ROBOTS
    SPEED = 4
    FLEET = SensorFleet

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.fleet.bus.start()
        cls.addClassCleanup(cls.fleet.bus.stop)
        cls.values = cls.root / "values"
        cls.values.write_text("15")
        cls.round = cls.root / "round"
        # Any program that emits trbots.* is a sensor: its values come in turn, none while the file is empty.
        emit = f"dbus-send --bus={cls.fleet.bus.address} --type=signal /trbots/temperature trbots.temperature.value"
        line = f'while :; do for v in $(cat {cls.values}); do {emit} double:$v string:degC; sleep 0.1; done; touch {cls.round}; sleep 0.02; done'
        cls.feeder = subprocess.Popen(["sh", "-c", line], preexec_fn=trb_fleet.end_with_parent)
        cls.addClassCleanup(cls.end_feeder)
        cls.fleet.wait("the fleet learns of the sensor", lambda: cls.plugged("ridgeback"), support.LONG_S)

    @classmethod
    def end_feeder(cls):
        cls.feeder.kill()
        cls.feeder.wait()

    @classmethod
    def plugged(cls, node):
        routes = cls.fleet.json("route", "list", node=node)["routes"]
        sensors = next((r["profile"]["plugged"] for r in routes if r["id"] == "conveyor"), [])
        return any(s["name"] == "temperature" and s["state"] == "ok" for s in sensors)

    def setUp(self):
        super().setUp()
        self.feed("15")

    def feed(self, *values):
        path = self.values.with_suffix(".new")
        path.write_text(" ".join(values))
        os.replace(path, self.values)
        for _ in range(2):  # in the first one it may still have told what the file was before
            self.round.unlink(missing_ok=True)
            self.fleet.wait("the sensor has told all", self.round.exists, support.LONG_S)
        if values:
            self.fleet.wait("the sensor tells", lambda: self.plugged("ridgeback"), support.LONG_S)

    def task(self, view, task):
        return next(t for t in view["tasks"] if t["id"] == task)

    def finished(self, run, node=CLOUD):
        view = self.wait_state(run, "FINISHED", "PAUSED", node=node)
        self.assertEqual(view["state"], "FINISHED", view)
        return view

    def assert_one_branch(self, run, mark):
        """By the robots' own output: one of the two was commanded, once; and the view shows it."""
        view = self.finished(run)
        done = {robot: self.commanded(mark, robot) for robot in ROBOTS}
        self.assertEqual((done["ridgeback"], done["conveyor"]), (["load_out"], ["run"]))
        self.assertIn((done["ur3"], done["drone"]), ((["program"], []), ([], ["take_off"])), done)
        left = self.task(view, "left")
        self.assertEqual(left["state"] == "FINISHED", done["ur3"] == ["program"], view)
        states = sorted(self.task(view, task)["state"] for task in ("left", "right"))
        self.assertEqual(states, ["FINISHED", "SKIPPED"])
        # One reading: both views name the same value.
        values = {self.task(view, task)["condition"].split(",")[0] for task in ("left", "right")}
        self.assertEqual(len(values), 1, values)

    def test_a_unit_that_nobody_knows_yet_is_told_before_the_run_would_wait(self):
        line = f"dbus-send --bus={self.fleet.bus.address} --type=signal /trbots/salinity trbots.salinity.value double:3 string:percent"
        feeder = subprocess.Popen(["sh", "-c", f"while :; do {line}; sleep 0.2; done"], preexec_fn=trb_fleet.end_with_parent)
        self.addCleanup(feeder.wait)
        self.addCleanup(feeder.kill)
        path = self.values.with_name("salt.json")
        salty = {"sensor": "salinity", "of": "conveyor", "op": ">", "value": 1, "unit": "degC"}
        path.write_text(json.dumps({"name": "salt", "tasks": [
            {"id": "bring", "robot": "ridgeback", "skill": "load_out", "when": salty}]}))

        def wait_told(status, what):
            def is_told():
                got, answer = self.ask("scenario", "check", path)
                return (got, [fault["what"] for fault in answer["faults"]]) == (status, [what])
            self.fleet.wait(what, is_told, support.LONG_S)

        wait_told(0, "salinity of conveyor: its unit is not known yet")
        self.fleet.trb("sensor", "read", "salinity", "--of", "conveyor", node=CLOUD)
        wait_told(1, "salinity of conveyor has the unit 'percent', not 'degC'")

    def test_the_paper_s_task_six(self):
        self.fleet.trb("sensor", "read", "temperature", "--of", "conveyor", node=CLOUD)
        self.fleet.wait("its unit is known", lambda: not self.ask("scenario", "check", TEMPERATURE)[1]["faults"], support.LONG_S)
        status, answer = self.ask("scenario", "check", TEMPERATURE)
        self.assertEqual(status, 0)
        alone = {one["task"]: one["robot"] for one in answer["no_spare"]}
        self.assertEqual(alone["run_conveyor"], "conveyor")
        for degrees, goes, skipped in (("15.5", "left", "right"), ("25.5", "right", "left")):
            with self.subTest(degrees=degrees):
                self.feed(degrees)
                mark = self.mark()
                done = self.fleet.trb("scenario", "run", TEMPERATURE, "--watch", node=CLOUD)
                self.assertIn(f"pick_{skipped}  SKIPPED", done.stdout)
                run = done.stdout.split()[1]
                view = self.finished(run)
                self.assertEqual(self.task(view, f"pick_{goes}")["state"], "FINISHED")
                reason = self.task(view, f"pick_{skipped}")["reason"]
                op = "<=" if skipped == "left" else ">"
                self.assertEqual(reason, f"temperature of conveyor was {degrees} degC, not {op} 20")
                self.assertIn(reason, done.stdout)
                self.assertEqual(self.commanded(mark, "ur3"), ["program"] * 2)
                self.wait_robot(mark, "ridgeback", "done load_out")

    def test_the_evaluating_scheduler_dies_before_it_has_chosen(self):
        """No value comes: it waits. Killed, it requests again; then the values cross the limit each time."""
        self.feed()
        mark = self.mark()
        run = self.submit(TWO_ROBOTS)
        self.wait_robot(mark, "ridgeback", "done load_out")
        self.fleet.wait("it waits in words", lambda: self.view(run, "ridgeback")["waits_for"].startswith(
            "temperature of conveyor: "), support.LONG_S)
        self.fleet.wait("the cloud says so, too", lambda: self.view(run)["waits_for"].startswith(
            "temperature of conveyor: "), support.LONG_S)
        old = self.kill_service("ridgeback", "scheduler")
        self.feed("19.9", "20.1")
        self.wait_back("ridgeback", "scheduler", old)
        self.assert_one_branch(run, mark)

    def test_the_evaluating_scheduler_dies_while_it_asks(self):
        """Killed right after its task is done: during the request, after signing, or just after passing on."""
        self.feed("19.9", "20.1")
        for looks in (0, 2, 4, 7):
            with self.subTest(looks=looks):
                mark = self.mark()
                run = self.submit(TWO_ROBOTS)
                self.wait_robot(mark, "ridgeback", "done load_out")
                for _ in range(looks):  # some 20 ms each
                    self.view(run, "ridgeback")
                old = self.kill_service("ridgeback", "scheduler")
                self.assert_one_branch(run, mark)
                self.wait_back("ridgeback", "scheduler", old)

    def test_the_evaluating_scheduler_dies_after_it_has_chosen(self):
        """The actors' schedulers are stopped, so that its choice reaches no other node before it is killed."""
        self.feed("19.9", "20.1")
        mark = self.mark()
        run = self.submit(TWO_ROBOTS)
        self.wait_robot(mark, "ridgeback", "start load_out")
        stopped = [self.pause_service(node, "scheduler") for node in ("ur3", "drone")]
        self.fleet.wait("it has chosen", lambda: " was " in self.task(self.view(run, "ridgeback"), "left")["condition"],
                        support.LONG_S)
        chosen = self.task(self.view(run, "ridgeback"), "left")["condition"]
        old = self.kill_service("ridgeback", "scheduler")
        for pid in stopped:
            support.send_signal(pid, support.signal.SIGCONT)
        self.wait_back("ridgeback", "scheduler", old)
        self.assert_one_branch(run, mark)
        self.assertEqual(self.task(self.view(run), "left")["condition"], chosen)

    def test_the_sensor_bus_dies_while_it_is_asked(self):
        self.feed()
        mark = self.mark()
        run = self.submit(TWO_ROBOTS)
        self.wait_robot(mark, "ridgeback", "done load_out")
        old = self.kill_service("conveyor", "sensor-bus")
        self.wait_back("conveyor", "sensor-bus", old)
        self.feed("25")
        self.assert_one_branch(run, mark)

    def test_the_cloud_is_gone(self):
        self.feed("25")
        mark = self.mark()
        run = self.submit(TWO_ROBOTS, node="ridgeback")
        self.wait_robot(mark, "ridgeback", "start load_out")
        self.kill_node(CLOUD)
        self.wait_robot(mark, "conveyor", "done run")
        self.start_node(CLOUD)
        self.assert_one_branch(run, mark)
        view = self.finished(run)
        self.assertEqual(self.task(view, "right")["condition"], "temperature of conveyor was 25 degC, > 20")

    def test_a_sensor_that_is_not_plugged_in(self):
        """The check warns of it and the run starts all the same; the run waits for it; an abort ends the waiting."""
        scenario = json.loads(json.dumps(TWO_ROBOTS).replace('"temperature"', '"humidity"').replace("degC", "percent"))
        status, answer = self.ask("scenario", "check", self.scenario_file(scenario))
        self.assertEqual(status, 0)
        self.assertEqual([fault["may_wait"] for fault in answer["faults"]], [True, True])
        run = self.submit(scenario)
        self.fleet.wait("it waits in words", lambda: self.view(run)["waits_for"] ==
                        "humidity of conveyor: no such sensor is plugged in", support.LONG_S)
        self.abort_run(run)
        self.wait_state(run, "ABORTED")


if __name__ == "__main__":
    support.main()
