"""The sums of every message type that Debian ships, ours compared with those of genmsg, ROS's own generator."""
import os
import subprocess
import sys
import unittest

import support
try:
    import genmsg
    import genmsg.gentools
    import genmsg.msg_loader
except ImportError:
    genmsg = None

PROGRAM = os.path.join(os.environ["TRB_BIN_DIR"], "..", "tests", "test_ros_types")
SHARE = "/usr/share"


def their_sum(name):
    context = genmsg.msg_loader.MsgContext.create_default()
    packages = sorted(p for p in os.listdir(SHARE) if os.path.isdir(os.path.join(SHARE, p, "msg")))
    search = {p: [os.path.join(SHARE, p, "msg")] for p in packages}
    spec = genmsg.msg_loader.load_msg_by_type(context, name, search)
    genmsg.msg_loader.load_depends(context, spec, search)
    return genmsg.gentools.compute_md5(context, spec)


@unittest.skipIf(genmsg is None, "python3-genmsg is not installed")
class Sums(unittest.TestCase):
    def test_every_type_has_the_sum_that_ros_computes(self):
        lines = subprocess.run([PROGRAM, "--sums"], check=True, capture_output=True, text=True).stdout.splitlines()
        self.assertGreater(len(lines), 100, "Debian's ros-…-msgs packages are installed")
        for line in lines:
            name, ours = line.split()
            with self.subTest(name):
                self.assertEqual(ours, their_sum(name))
        print(f"{len(lines)} message types have the sum that genmsg computes", file=sys.stderr)


if __name__ == "__main__":
    support.main()
