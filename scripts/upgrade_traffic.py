"""A hundred messages a second between robots, each numbered: which came, which came twice, which did not."""
import itertools
import threading
import time
from collections import Counter

A_SECOND = 100
MARGIN_S = 2.0  # before a node is stopped and after it is whole again, for what is under way


class Traffic:
    """Each robot sends to the next one, without asking for control of it. A robot whose own node is away waits, as its program would."""

    numbers = itertools.count(1)

    def __init__(self, fleet, robots):
        self.fleet = fleet
        self.word = f"count{next(self.numbers)}"  # of this traffic alone
        self.pairs = list(zip(robots, robots[1:] + robots[:1]))
        self.sent = {pair: [] for pair in self.pairs}  # when, by number
        self.away = []  # (node, from, until)
        self.problem = None
        self.end = threading.Event()
        self.thread = threading.Thread(target=self.run)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.end.set()
        self.thread.join()

    def run(self):
        try:
            due = time.monotonic()
            while not self.end.wait(max(0.0, due - time.monotonic())):
                due += len(self.pairs) / A_SECOND
                for pair in self.pairs:
                    self.say(pair)
                self.pump()
        except (OSError, ValueError) as problem:
            self.problem = problem

    def pump(self):
        for robot, _ in self.pairs:
            self.fleet.virtual[robot].pump(0)

    def say(self, pair):
        robot, to = pair
        links = [line for line in self.fleet.virtual[robot].lines if line == "connected" or line.startswith("disconnected ")]
        if not links or links[-1] != "connected":
            return
        self.fleet.virtual[robot].say(f"say information {self.word} {to} {len(self.sent[pair])}")
        self.sent[pair].append(time.monotonic())

    def note_away(self, node, since, until):
        self.away.append((node, since - MARGIN_S, until + MARGIN_S))

    def is_away(self, pair, at):
        return any(node in pair and since <= at <= until for node, since, until in self.away)

    def tally(self):
        """What has become of each: by then nothing may be under way."""
        out = Counter(sent=0, came=0, twice=0, lost=0, refused_or_lost_while_away=0)
        for pair in self.pairs:
            robot, to = pair
            came = Counter(int(words[5]) for words in map(str.split, self.fleet.virtual[to].lines)
                           if words[:4] == ["message", "information", self.word, robot])
            out["sent"] += len(self.sent[pair])
            out["came"] += len(came)
            out["twice"] += sum(count - 1 for count in came.values())
            for number, at in enumerate(self.sent[pair]):
                if number not in came:
                    out["refused_or_lost_while_away" if self.is_away(pair, at) else "lost"] += 1
        return out
