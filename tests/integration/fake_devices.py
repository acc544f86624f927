"""Devices that are not there: umockdev stands in for udev and /sys. Run as a program it holds one machine's devices."""
import os
import pathlib
import subprocess
import sys

if __name__ != "__main__":
    import trb_fleet


class Devices:
    """The chips of one machine; what runs with `env` sees them and no others."""

    def __init__(self, log):
        self.process = trb_fleet.Process(["umockdev-wrapper", sys.executable, pathlib.Path(__file__)],
                                         log, stdin=subprocess.PIPE)
        line, self.heard = self.process.wait_line("devices in ", 60)
        asan = os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"  # the preloaded library comes first
        self.env = {"LD_PRELOAD": "libumockdev-preload.so.0", "UMOCKDEV_DIR": line.split()[-1], "ASAN_OPTIONS": asan}

    def order(self, *words):
        self.process.say(" ".join(map(str, words)))
        _, self.heard = self.process.wait_line("done", 60, self.heard)

    def plug(self, name, serial, milli_degrees):
        self.order("plug", name, serial, milli_degrees)

    def unplug(self, name):
        self.order("unplug", name)

    def stop(self):
        self.process.stop()


def main():
    import gi
    gi.require_version("UMockdev", "1.0")
    from gi.repository import UMockdev
    bed = UMockdev.Testbed.new()
    print("devices in", bed.get_root_dir(), flush=True)
    paths = {}
    for line in sys.stdin:
        what, name, *more = line.split()
        if what == "plug":
            serial, value = more
            paths[name] = bed.add_device("hwmon", name, None, ["name", "lm75", "temp1_input", value], ["ID_SERIAL_SHORT", serial])
        elif name in paths:
            bed.uevent(paths[name], "remove")
            bed.remove_device(paths.pop(name))
        print("done", flush=True)


if __name__ == "__main__":
    main()
