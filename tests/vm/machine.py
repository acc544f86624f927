"""A virtual machine (QEMU without acceleration, so that it runs anywhere): orders to its shell, devices into its sockets."""
import json
import select
import socket
import subprocess
import threading
import time

import trb_fleet

SAY_EVERY_S = 0.2


class Lines:
    """A socket's lines, with deadlines."""

    def __init__(self, connected):
        self.socket = connected
        self.rest = b""
        self.lines = []

    def next(self, end):
        while not self.lines:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.socket], [], [], left)[0]:
                raise TimeoutError("it does not answer")
            data = self.socket.recv(65536)
            if not data:
                raise ConnectionError("it has ended")
            *lines, self.rest = (self.rest + data).split(b"\n")
            self.lines += [line.decode(errors="replace").rstrip("\r") for line in lines]
        return self.lines.pop(0)


class Machine:
    def __init__(self, folder, vmlinuz, image, disks=(), memory_mb=512, words="rdinit=/init", clock="utc"):
        """disks: files, /dev/vda first; words: for the kernel; clock: what the machine believes at its start."""
        self.folder = folder
        self.count = 0
        self.log = folder / "console.log"
        self.events = []
        listeners = {name: self.listen(name) for name in ("qmp", "orders")}
        command = ["qemu-system-x86_64", "-accel", "tcg", "-cpu", "max,la57=off", "-m", str(memory_mb), "-display", "none", "-no-reboot",
                   "-nodefaults", "-kernel", vmlinuz, "-initrd", image, "-append", f"console=ttyS0 quiet panic=-1 mitigations=off no_timer_check {words}", "-rtc", f"base={clock}",
                   "-device", "qemu-xhci,id=usb", "-serial", f"file:{self.log}", "-chardev", f"socket,id=orders,path={folder / 'orders'}",
                   "-serial", "chardev:orders", "-qmp", f"unix:{folder / 'qmp'}"]
        # What the machine has written outlives its end; it need not reach our disk.
        for disk in disks:
            command += ["-drive", f"file={disk},format=raw,if=virtio,cache=unsafe"]
        self.child = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, preexec_fn=trb_fleet.end_with_parent)
        self.qmp, self.orders = (Lines(self.accept(listeners[name])) for name in ("qmp", "orders"))
        self.monitor("qmp_capabilities")

    def listen(self, name):
        listener = socket.socket(socket.AF_UNIX)
        (self.folder / name).unlink(missing_ok=True)  # of a machine before it
        listener.bind(str(self.folder / name))
        listener.listen(1)
        listener.settimeout(20)
        return listener

    @staticmethod
    def accept(listener):
        with listener:
            return listener.accept()[0]

    def monitor(self, command, **arguments):
        """A command to QEMU itself."""
        self.qmp.socket.sendall(json.dumps({"execute": command, "arguments": arguments}).encode())
        while True:
            answer = json.loads(self.qmp.next(time.monotonic() + 20))
            if "error" in answer:
                raise RuntimeError(f"QEMU: {command}: {answer['error']['desc']}")
            if "event" in answer:
                self.events.append((answer["event"], answer.get("data", {}).get("device")))
            if "return" in answer:
                return answer["return"]

    def wait_ready(self, timeout):
        end = time.monotonic() + timeout
        while self.orders.next(end) != "ready":
            pass

    def sh(self, order, timeout=60):
        """The output of the command in the machine's shell, and its exit code."""
        self.count += 1
        self.orders.socket.sendall(f"{self.count} {order}\n".encode())
        end = time.monotonic() + timeout
        said = []
        while True:
            try:
                number, _, text = self.orders.next(end).partition(" ")
            except TimeoutError:
                raise TimeoutError(f"{order}: not within {timeout} s") from None
            if number == f"{self.count}=":
                return "\n".join(said), int(text)
            if number == f"{self.count}:":
                said.append(text)

    def plug(self, driver, name, **more):
        self.monitor("device_add", driver=driver, id=name, bus="usb.0", **more)

    def unplug(self, name):
        gone = ("DEVICE_DELETED", name)
        self.monitor("device_del", id=name)
        end = time.monotonic() + 20
        while gone not in self.events:  # its name is free only then
            if time.monotonic() > end:
                raise TimeoutError(f"{name} cannot be unplugged")
            self.monitor("query-status")
        self.events.remove(gone)

    def press(self, keys):
        """On the keyboard that was plugged in last."""
        for key in keys:
            for down in (True, False):
                self.monitor("input-send-event", events=[{"type": "key", "data": {"down": down, "key": {"type": "qcode", "data": key}}}])

    def stop(self):
        self.child.kill()
        self.child.wait()
        self.qmp.socket.close()
        self.orders.socket.close()


class UsbSerial:
    """A device behind a serial line on USB that sends its text again and again, as such devices do."""

    def __init__(self, machine, name, serial, text):
        self.machine, self.name, self.text = machine, name, text
        listener = machine.listen(name)
        path = {"type": "unix", "data": {"path": str(machine.folder / name)}}
        machine.monitor("chardev-add", id=name, backend={"type": "socket", "data": {"addr": path, "server": False}})
        self.line = machine.accept(listener)
        (machine.folder / name).unlink()
        self.line.setblocking(False)
        self.over = threading.Event()
        self.speaker = threading.Thread(target=self.speak, daemon=True)
        self.speaker.start()
        self.began = time.monotonic()
        machine.plug("usb-serial", name, chardev=name, serial=serial)

    def speak(self):
        while not self.over.wait(SAY_EVERY_S):
            try:
                self.line.send(self.text.encode() + b"\r\n")
            except BlockingIOError:
                pass  # not read
            except OSError:
                return

    def unplug(self):
        self.machine.unplug(self.name)
        self.over.set()
        self.speaker.join()
        self.machine.monitor("chardev-remove", id=self.name)
        self.line.close()
