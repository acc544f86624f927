"""Devices that are plugged into a hall (`udev_hall`): their files, events, and what one behind a terminal sends."""
import os
import select
import struct
import time
import tty


class Plugged:
    """A device that is plugged in. `path` is its path below /sys."""

    def __init__(self, hall, path, folders, attribute=None, factor=1):
        self.hall, self.path, self.folders = hall, path, folders
        self.attribute, self.factor = attribute, factor
        self.properties = {}

    def set(self, value):
        """Its value, in the unit that it was plugged in with."""
        self.write(self.attribute, f"{round(value * self.factor)}\n")

    def write(self, attribute, content):
        """What a file of it holds from now on; None: it vanishes."""
        self.hall.ask(do="write", path=f"{self.path}/{attribute}", content=content)

    def freeze(self, attribute):
        """Whoever reads that file waits, as with a device that hangs; until thaw()."""
        self.hall.ask(do="freeze", path=f"{self.path}/{attribute}")

    def thaw(self, attribute, content):
        self.hall.ask(do="thaw", path=f"{self.path}/{attribute}", content=content)

    def event(self, action):
        self.hall.ask(do="event", action=action, path=self.path, properties=self.properties)

    def unplug(self):
        self.hall.ask(do="unplug", path=self.path, folders=self.folders, properties=self.properties, node=None)


class Serial(Plugged):
    """A device behind a terminal; `say` is what it sends."""

    def __init__(self, hall, path, folders, node):
        super().__init__(hall, path, folders)
        self.node = node
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)

    def say(self, data, timeout=60):
        data = data.encode() if isinstance(data, str) else data
        end = time.monotonic() + timeout
        while data:
            _, ready, _ = select.select([], [self.master], [], max(0, end - time.monotonic()))
            if not ready:
                raise TimeoutError(f"{self.node}: nobody reads what is said")
            data = data[os.write(self.master, data):]

    def press(self, code):
        """A key, down and up, as the kernel's input layer tells it."""
        for value in (1, 0):
            self.say(struct.pack("llHHi", 0, 0, 1, code, value))

    def hang_up(self):
        """The line is dead, though udev has not said so."""
        for end in (self.master, self.slave):
            if end is not None:
                os.close(end)
        self.master = self.slave = None

    def unplug(self):
        self.hall.ask(do="unplug", path=self.path, folders=self.folders, properties=self.properties, node=self.node)
        if self.master is not None:
            self.hang_up()
