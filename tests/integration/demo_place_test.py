"""The demonstration's place: addresses that another one holds, folders whose paths a socket or a D-Bus address cannot hold.

Addresses 127.0.242.x to 127.0.245.x.
"""
import os
import pathlib
import socket
import stat
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import support  # noqa: F401
import demo_fleet
import demo_place
import private_bus
import trb_fleet


class Place(unittest.TestCase):
    def setUp(self):
        self.folder = support.temporary_folder(self)
        self.said = []
        patch = mock.patch.object(demo_place, "BLOCKS", range(242, 246, 2))
        patch.start()
        self.addCleanup(patch.stop)

    def take(self, block=None):
        place = demo_place.take(block, None, self.folder, self.said.append)
        self.addCleanup(place.close)
        return place

    def other(self, script):
        """A process of another folder; it says when it is ready."""
        child = subprocess.Popen([sys.executable, "-c", script + "\nprint('ready', flush=True)\nimport sys\nsys.stdin.read()"],
                                 cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                 env=dict(os.environ, PYTHONPATH=os.path.dirname(demo_place.__file__)))
        self.addCleanup(child.stdout.close)
        self.addCleanup(child.stdin.close)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        self.assertEqual(child.stdout.readline(), "ready\n")
        return child

    def test_the_next_block_is_taken_and_it_says_who_holds_the_first(self):
        child = self.other("import demo_place; held = demo_place.hold(242)")
        place = self.take()
        self.assertEqual(place.block, 244)
        self.assertEqual(place.udp_port, 50243)
        self.assertEqual(self.said, [f"== the addresses 127.0.242.x are held by pid {child.pid} in {self.folder}: "
                                     "this demonstration takes 127.0.244.x"])

    def test_whoever_waits_for_a_block_hears_of_its_holders_end(self):
        child = self.other("import demo_place; held = demo_place.hold(242)")
        self.assertFalse(demo_place.wait_for_end(242, 0.05))
        child.kill()
        self.assertTrue(demo_place.wait_for_end(242, 10))
        self.assertTrue(demo_place.wait_for_end(242, 10))  # it has ended before
        self.assertEqual(self.take().block, 242)

    def test_who_holds_an_address_without_saying_so_is_found(self):
        child = self.other("import socket; held = socket.create_server(('127.0.242.3', 45000))")
        self.assertEqual(self.take().block, 244)
        self.assertIn(f"pid {child.pid} in {self.folder}, ".rstrip(", "), self.said[0])

    def test_without_a_free_block_it_says_who_holds_them(self):
        first, second = self.take(), self.take()
        self.assertEqual((first.block, second.block), (242, 244))
        with self.assertRaisesRegex(RuntimeError, f"127.0.242.x are held by pid {os.getpid()} in "):
            self.take()
        with self.assertRaisesRegex(RuntimeError, "127.0.242.x are held by"):
            self.take(242)
        for _ in range(50):
            self.assertEqual(demo_place.pid_of_holder(244), os.getpid())
        first.close()
        self.assertEqual(self.take().block, 242)


class Bus(unittest.TestCase):
    def start(self, below):
        path = support.temporary_folder(self) / below
        path.mkdir(parents=True)
        bus = private_bus.PrivateBus(path)
        self.addCleanup(bus.stop)
        bus.start()
        done = subprocess.run(["dbus-send", f"--bus={bus.address}", "--print-reply", "--dest=org.freedesktop.DBus", "/",
                               "org.freedesktop.DBus.GetId"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path, bus

    def test_a_space_and_other_characters_in_the_path(self):
        path, bus = self.start("a b,c;d=e%f&g~h")
        self.assertEqual(bus.socket.parent, path)

    def test_a_path_that_is_too_long_for_a_socket(self):
        path, bus = self.start("x" * 120)
        self.assertNotEqual(bus.socket.parent, path)
        self.assertLessEqual(len(os.fsencode(bus.socket)), private_bus.LONGEST)
        self.assertEqual(stat.S_IMODE(bus.socket.parent.stat().st_mode), 0o700)
        bus.stop()
        self.assertFalse(bus.socket.parent.exists())

    def test_a_folder_of_that_name_that_others_may_enter_is_not_used(self):
        path = pathlib.Path("/tmp") / ("x" * 120)
        with mock.patch.dict(os.environ, {"XDG_RUNTIME_DIR": ""}):
            taken = private_bus.socket_of(path, "bus").parent
            self.addCleanup(taken.rmdir)
            taken.chmod(0o755)
            with self.assertRaisesRegex(RuntimeError, "is not a folder of"):
                private_bus.socket_of(path, "bus")


class Paths(unittest.TestCase):
    def test_paths_are_short_behind_a_link(self):
        with tempfile.TemporaryDirectory(prefix="trb-") as folder:
            real = pathlib.Path(folder) / "some" / "where" / "deep"
            (real / "bin").mkdir(parents=True)
            link = pathlib.Path(folder) / "link"
            link.symlink_to(real)
            self.addCleanup(os.chdir, os.getcwd())
            os.chdir(link)
            self.assertEqual(trb_fleet.short(link / "bin" / "trb"), "bin/trb")
            self.assertEqual(trb_fleet.short("/usr"), "/usr")
            self.assertEqual(demo_fleet.below(os.path.realpath("."), link / "bin"), '"$PWD"/bin')
            self.assertEqual(demo_fleet.below(os.path.realpath("."), "/a b"), "'/a b'")


if __name__ == "__main__":
    support.main()
