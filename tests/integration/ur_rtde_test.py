"""The scenarios of ur_test.py once more, with the joints read by RTDE. Addresses 127.0.132.x and 127.0.133.x."""
import json
import re

import support
import ur_test


class RtdeFleet(ur_test.UrFleet):
    """Its commands.json has "rtde_port"."""

    def __init__(self, root, programs):
        super().__init__(root, programs, block=132)

    def make_node(self, node):
        super().make_node(node)
        path = self.dir(node) / "commands.json"
        if path.exists():
            path.write_text(path.read_text().replace('"language": "urscript",',
                                                     '"language": "urscript", "rtde_port": 30004, "rtde_hz": 50,', 1))


class ByRtde(ur_test.Case):
    FLEET = RtdeFleet

    def test_a_move_is_seen_at_the_rate_and_its_end_is_where_it_should_be(self):
        run = self.run_skill("move_joints", joints=[1.0, -1.57, 0, -1.57, 0, 0])
        self.assert_finished(run)
        self.fleet.wait("the joints are there", lambda: abs(self.joints()[0] - 1.0) < 0.01, 60)
        self.assertIn("robot_connected", self.log())
        self.assertRegex(self.log(), r"robot_connected.*data")

    def joints(self):
        return json.loads(re.search(r"\[[^\]]*\]", self.fleet.ur("request", "ur3", "position").stdout).group())

    def log(self):
        return "\n".join(path.read_text() for path in (self.fleet.dir("ur3") / "log").glob("*.log"))


class Scripts(ur_test.Scripts):
    FLEET = RtdeFleet


class Stops(ur_test.Stops):
    FLEET = RtdeFleet


if __name__ == "__main__":
    support.main()
