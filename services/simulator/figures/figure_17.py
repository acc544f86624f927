"""Figure 17: what signatures and encryption add to the delay of a message, from before it is signed until it is validated."""
import os
import statistics
import tempfile

import measured
import roads  # found by measured
from seal_times import SealTimes, check_ms, waits

WARM, MESSAGES, ALONE = 200, 1000, 25
UNSIGNED = "unsigned, encrypted"
EACH = "one signature a message"  # delivered once it is validated
PAPER = (("paper: unsigned 0.8", 0.8), ("signed 1.4", 1.4))


def delivered(road):
    """The median of a round, one message in flight."""
    def measure():
        road.order(f"latency {WARM}")
        return road.order(f"latency {MESSAGES}")["median_us"] / 1000
    return measure


def validated(road, fleet, messages, repeats):
    """A seal follows its messages: their delay, the wait for it, and its check. The median over `repeats` orders."""
    def measure():
        taps = SealTimes(fleet.dir("a") / "bus")
        try:
            road.order("latency 5")
            taps.wait_seal(0, 1)  # the tap listens
            seconds = []
            for _ in range(repeats):
                start = len(taps.times)
                delay = road.order(f"latency {messages}")["median_us"] / 1000
                seconds.append(delay + statistics.median(waits(taps.wait_seal(start, messages))))
        finally:
            taps.end()
        return statistics.median(seconds) + check_ms()
    return measure


def measure(arguments):
    with tempfile.TemporaryDirectory(prefix="trb-figure-") as root, \
            roads.Roads(root, arguments.programs, 64 + os.getpid() % 128) as built:
        plain, floor = built.plain(), built.floor()
        unsealed, sealed, each = (built.road(name) for name in ("unsealed", "sealed", "each"))
        fleet = built.fleets["sealed"]
        return measured.in_turns({
            "bare floor, not encrypted": delivered(plain),
            "bare floor, encrypted": delivered(floor),
            UNSIGNED: delivered(unsealed),
            EACH: delivered(each),
            "sealed: delivered": delivered(sealed),
            "sealed: validated, in a stream": validated(sealed, fleet, 640, 1),
            "sealed: validated, alone": validated(sealed, fleet, 1, ALONE)}, arguments.rounds)


def draw(arguments):
    measured.draw(arguments, 17, "Figure 17: delay with signatures and encryption on and off", measure, PAPER,
                  {UNSIGNED: 0.8, EACH: 1.4})
