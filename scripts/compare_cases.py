"""Fleets and scenarios that the simulator's world is held against: the demonstration, and five others."""
import dataclasses
import json
import pathlib

import trb_fleet

REPO = pathlib.Path(__file__).resolve().parent.parent


@dataclasses.dataclass
class Case:
    name: str
    robots: dict  # as trb_fleet has them
    scenario: dict = None  # None: `path` has it
    path: pathlib.Path = None
    degrees: float = None  # that a thermometer at the conveyor's PC shows
    fault: tuple = None  # (robot, seconds behind the first baton): it breaks before it has anything to do

    def write(self, folder):
        """The scenario's file."""
        if self.path:
            return self.path
        path = pathlib.Path(folder) / "scenario.json"
        path.write_text(json.dumps({"name": self.name, "tasks": self.scenario}))
        return path


def belts(*seconds):
    """r0, r1 ...: conveyors that need so long to run."""
    return {f"r{i}": ("lines", "conveyor", ["--skill", f"run={one}"]) for i, one in enumerate(seconds)}


def run(task, robot, *after):
    return {"id": task, "robot": f"r{robot}", "skill": "run", "after": list(after)}


def in_turn(robots, tasks):
    return [run(f"t{i}", i % robots, *([f"t{i - 1}"] if i else [])) for i in range(tasks)]


def drive(task, place, *after):
    """By whichever can."""
    return {"id": task, "requires": ["mobile"], "skill": "go_to", "data": {"place": place}, "after": list(after)}


def go(task, cart):
    return {"id": task, "robot": f"cart{cart}", "skill": "go_to", "data": {"place": "table1" if cart == 1 else "dock"}}


CARTS = {"r0": ("lines", "conveyor", ["--skill", "run=1.5"]),
         **{f"cart{i}": ("lines", "pioneer", ["--pose", f"{i},3,0", "--skill", "go_to=2.5"]) for i in (1, 2)}}

CASES = [
    Case("demonstration", trb_fleet.DEMO_ROBOTS, path=REPO / "config" / "scenarios" / "paper-nine-tasks.json"),
    Case("demonstration, a sensor", trb_fleet.DEMO_ROBOTS, path=REPO / "config" / "scenarios" / "paper-temperature.json", degrees=15),
    Case("in turn, kept", belts(2, 1.5, 2.5), in_turn(3, 6)),
    Case("in turn, let go", belts(3, 3.5, 4, 3, 3), in_turn(5, 7)),
    Case("one robot", belts(1.5), in_turn(1, 4)),
    Case("apart and together", belts(1, 2, 3.5, 1.5),
         [run("a", 0), run("b", 1, "a"), run("c", 2, "a"), run("d", 3, "b", "c"), run("e", 0, "d")]),
    Case("blocks", belts(1.2, 1.7, 2.3),
         [run("a1", 0), run("a2", 0, "a1"), run("b1", 1), run("b2", 1, "b1"), run("c1", 2), run("c2", 2, "c1"),
          run("end", 0, "a2", "b2", "c2")]),
    # The carts know the run before the cloud decides: else it is a matter of milliseconds whom they ask for its definition.
    Case("two at once, one behind them", belts(1.6, 2.4, 1.3), [run("a", 0), run("b", 1), run("c", 2, "a", "b")]),
    Case("from one to all", belts(1, 1.4, 1.9, 2.3), [run("a", 0), run("b", 1, "a"), run("c", 2, "a"), run("d", 3, "a")]),
    Case("two robots", belts(1.4, 0.9), in_turn(2, 6)),
    # Each robot knows the run before the cloud decides: else it is a matter of milliseconds whom it asks for its definition.
    Case("a robot that breaks", belts(3, 0.6, 0.9),
         [run("a0", 0), run("a1", 1), run("a2", 2), run("b", 1, "a0"), run("c", 2, "b"), run("d", 1, "c")], fault=("r1", 1.5)),
    Case("bound by what they can", CARTS,
         [run("begin", 0), go("from1", 1), go("from2", 2), drive("go", "conveyor_entry", "begin", "from1", "from2"), run("end", 0, "go")]),
]
