"""Programs that the demo and the tests start: they end with who started them, and their output is awaited line by line."""
import ctypes
import os
import pathlib
import select
import signal
import subprocess
import sys
import time


def end_with_parent():
    """In a child: SIGTERM when the parent ends."""
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)


def run_main(main, name):
    """Runs a program's main and ends with its status; a failure is one line that names the program. SIGTERM ends it in
    order, so that what it has started ends, too."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
    except (RuntimeError, TimeoutError) as problem:
        sys.exit(f"{name}: {problem}")


def wait_until(condition, timeout, step=0.05):
    """Seconds until the condition held, looked at every `step`; None: it has not in time."""
    start = time.monotonic()
    while not condition():
        if time.monotonic() - start > timeout:
            return None
        time.sleep(step)
    return time.monotonic() - start


class Process:
    """A child whose standard output is read line by line, with deadlines."""

    def __init__(self, arguments, log_path, stdin=subprocess.DEVNULL, env=None):
        self.log = open(log_path, "ab", buffering=0)
        self.child = subprocess.Popen(
            [str(a) for a in arguments], stdin=stdin, stdout=subprocess.PIPE, stderr=self.log, env=env,
            preexec_fn=end_with_parent)
        self.lines = []
        self.rest = b""

    def pump(self, wait):
        """Reads what there is, waiting at most so long. False at the end of the output, and once it was stopped."""
        if self.child.stdout.closed:
            return False
        ready, _, _ = select.select([self.child.stdout], [], [], max(wait, 0))
        if not ready:
            return True
        data = os.read(self.child.stdout.fileno(), 65536)
        self.log.write(data)
        *lines, self.rest = (self.rest + data).split(b"\n")
        self.lines += [line.decode(errors="replace") for line in lines]
        return bool(data)

    def drain(self):
        """Reads all that is there now."""
        while not self.child.stdout.closed and select.select([self.child.stdout], [], [], 0)[0] and self.pump(0):
            pass

    def wait_line(self, wanted, timeout, start=0):
        """Waits for a line that contains `wanted`; returns (line, index after it)."""
        end = time.monotonic() + timeout
        index = start
        while True:
            while index < len(self.lines):
                index += 1
                if wanted in self.lines[index - 1]:
                    return self.lines[index - 1], index
            left = end - time.monotonic()
            if left <= 0:
                raise TimeoutError(f"{self.child.args[0]}: no line with {wanted!r} in {timeout} s; last: {self.lines[-5:]}")
            if not self.pump(min(left, 0.5)) and self.child.poll() is not None and index == len(self.lines):
                said = pathlib.Path(self.log.name).read_text(errors="replace").strip().splitlines()
                raise RuntimeError(f"{self.child.args[0]} ended with {self.child.returncode}; see {self.log.name}"
                                   + (f"\n  {said[-1]}" if said else ""))

    def say(self, text):
        self.child.stdin.write((text + "\n").encode())
        self.child.stdin.flush()

    def stop(self, how=signal.SIGTERM, timeout=30):
        """Killed only if it does not end by itself: what a supervisor has started would outlive that for a moment."""
        if self.child.poll() is None:
            self.child.send_signal(how)
        end = time.monotonic() + timeout
        while self.child.poll() is None and time.monotonic() < end:
            self.pump(0.05)
        if self.child.poll() is None:
            self.child.kill()
        self.child.wait()
        self.child.stdout.close()
        if self.child.stdin:
            self.child.stdin.close()
        self.log.close()
