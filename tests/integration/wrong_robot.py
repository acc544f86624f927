"""Robots that violate the field channel, each in one way: what `trb robot conform` must find.

    wrong_robot.py NODE PORT FAULT
"""
import pathlib
import select
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "config" / "robots" / "python"))
import field_client  # noqa: E402
from field_client import Channel, ExampleRobot  # noqa: E402

FAULTS = {}  # name: (the case that finds it, the channel's class, the robot's class)


def fault(case, channel=Channel, robot=ExampleRobot):
    """Registers a class as a fault: of the channel or of the robot, by its base class."""
    def register(kind):
        is_channel = issubclass(kind, Channel)
        FAULTS[kind.__name__] = (case, kind if is_channel else channel, robot if is_channel else kind)
        return kind
    return register


def is_ok(data):
    return data == b"ok\n"


@fault("acknowledge")
class NoOk(Channel):
    def _write(self, data):
        if not is_ok(data):
            super()._write(data)


@fault("acknowledge")
class TwoOks(Channel):
    def _write(self, data):
        super()._write(data * 2 if is_ok(data) else data)


@fault("acknowledge")
class OkForAMessage(Channel):
    def _write(self, data):
        if not is_ok(data) or len(self.data) == int((self.head + ["0"] * 4)[3]) > 0:
            super()._write(data)


@fault("no-acknowledge")
class OkUnasked(Channel):
    pass


@fault("answer")
class FieldsSwapped(Channel):
    def send(self, type_, subtype, target, data=""):
        super().send(type_, target, subtype, data)


@fault("answer")
class AnswersNobody(ExampleRobot):
    def told(self, request):
        self.channel.send("information", request.subtype, "", "x")
        return "x"


@fault("answer")
class AnswersAsCommand(Channel):
    def answer(self, request, data):
        self.send("command", request.subtype, request.peer, data)


@fault("unknown-request")
class SilentOnUnknown(Channel):
    def answer(self, request, data):
        if data != "unknown":
            super().answer(request, data)


@fault("unknown-command")
class FleesFromUnknown(ExampleRobot):
    def begin(self, command):
        if command.subtype != "wave":
            self.channel._hang_up()


@fault("information")
class AnswersInformation(Channel):
    def _take(self, field):
        message = super()._take(field)
        return message._replace(type="request") if message and message.type == "information" else message


@fault("empty")
class NoEmptyChunk(Channel):
    def _chunks(self, raw):
        return super()._chunks(raw) if raw else []


@fault("empty")
class EmptyEndsWithSize(Channel):
    def _whole(self, last):
        return len(self.data) >= int(self.head[3])


@fault("escapes")
class LeavesEscapes(Channel):
    def _next_field(self, end):
        field = super()._next_field(end)
        return field and field_client.escape(field)


@fault("escapes")
class DoesNotEscape(Channel):
    def answer(self, request, data):
        raw = data.encode()
        self._write(f"information\n{request.subtype}\n{request.peer}\n{len(raw)}\n".encode() + raw + b"\n")


@fault("quotes")
class ManglesQuotes(ExampleRobot):
    def told(self, request):
        return super().told(request).replace('"', "'")


@fault("utf8")
class CountsCharacters(Channel):
    def answer(self, request, data):
        self._write(f"information\n{request.subtype}\n{request.peer}\n{len(data)}\n{data}\n".encode())


@fault("numbers")
class Numeric(Channel):
    """Uses the numeric encoding; the words are those of the test's description. It answers only in integers."""

    WORDS = {"1": "command", "2": "request", "3": "information"}
    CODES = {"done": 1, "failed": 2, "wave": 3, "echo": 4, "conform_unknown": 5, "unknown": 0}

    def _take(self, field):
        order = {b"-1": b"!stop", b"-2": b"!release"}.get(field)
        return super()._take(order or field)

    def _write(self, data):
        super()._write({b"ok\n": b"0\n", b"!stopped\n": b"-1\n", b"!released\n": b"-2\n"}.get(data, data))

    def receive(self, timeout):
        message = super().receive(timeout)
        words = {str(code): word for word, code in self.CODES.items()}
        return message and message._replace(type=self.WORDS[message.type], subtype=words[message.subtype])

    def answer(self, request, data):
        whole = "0" if data == "unknown" else " ".join(str(int(float(number))) for number in data.split())
        self.send("3", str(self.CODES[request.subtype]), request.peer, whole)


@fault("chunks")
class ChunkTooLong(Channel):
    def __init__(self, host, port, _, **more):
        super().__init__(host, port, 0, **more)


@fault("chunks")
class FirstChunkOnly(Channel):
    def _whole(self, last):
        return len(self.data) > 0 or int(self.head[3]) == 0 and last == b""


@fault("like-an-order")
class StopsOnData(ExampleRobot):
    def told(self, request):
        if request.data == "!stop":
            self.channel._write(b"!stopped\n")
        return super().told(request)


@fault("large")
class SmallBuffer(ExampleRobot):
    def told(self, request):
        return super().told(request)[:65536]


@fault("slow-sender")
class ReadIsAField(Channel):
    def _next_field(self, end):
        self.searched = 0
        if not self.socket and not self._dial(end):
            return None
        if not self.input and not select.select([self.socket], [], [], max(0, end - time.monotonic()))[0]:
            return None
        if not self.input:
            self.input += self.socket.recv(65536)
        if not self.input:
            raise ConnectionError
        if b"\n" not in self.input:
            self.input += b"\n"
        return super()._next_field(end)


@fault("back-to-back")
class ForgetsWhatFollows(Channel):
    def _take(self, field):
        message = super()._take(field)
        if message:
            self.input.clear()
        return message

    def _write(self, data):
        if not is_ok(data):
            super()._write(data)


@fault("while-it-talks")
class OkWhileItTalks(Channel):
    def answer(self, request, data):
        if len(data) < 1000:
            return super().answer(request, data)
        self._write(f"information\n{request.subtype}\n".encode())
        message = self._take(self._next_field(time.monotonic() + 1))
        assert message is None
        self._write(f"{request.peer}\n{len(data)}\n{data}\n".encode())


@fault("stop")
class DeafToStop(Channel):
    def _take_order(self, order):
        self._begin_message()


@fault("stop-twice")
class AnswersOneStop(Channel):
    def _take_order(self, order):
        if not (self.stopped and order == b"!stop"):
            super()._take_order(order)


@fault("stop-in-message")
class KeepsPartOverStop(Channel):
    def _take_order(self, order):
        kept = self.head, self.data
        super()._take_order(order)
        self.head, self.data = kept


@fault("stop-crosses-ok")
class LateOk(Channel):
    late = False

    def _write(self, data):
        if is_ok(data):
            self.late = bool(self.input or select.select([self.socket], [], [], 0.05)[0])
            if self.late:
                return
        super()._write(data)
        if self.late and data == b"!stopped\n":
            self.late = False
            super()._write(b"ok\n")


@fault("broken-field")
class KeepsHalfAField(Channel):
    def _forget(self):
        if not hasattr(self, "input"):
            super()._forget()


@fault("broken-message")
class KeepsPartOverConnection(Channel):
    def _forget(self):
        kept = getattr(self, "head", []), getattr(self, "data", bytearray())
        super()._forget()
        self.head, self.data = kept


@fault("broken-message")
class DialsOnce(Channel):
    def _dial(self, end):
        if hasattr(self, "dialled"):
            sys.exit(0)
        self.dialled = super()._dial(end)
        return self.dialled


@fault("done")
class NeverDone(Channel):
    def done(self, skill, result=""):
        pass


@fault("done")
class DoneOfNothing(Channel):
    def done(self, skill, result=""):
        super().done("it", result)


@fault("stop-ends-skill")
class MovesOn(ExampleRobot):
    def stop(self):
        pass


@fault("stopped-refuses")
class DoesNotRefuse(ExampleRobot):
    def begin(self, command):
        self.channel.stopped = False
        super().begin(command)


@fault("connect")
class NeverDials(Channel):
    def _dial(self, end):
        time.sleep(max(0, end - time.monotonic()))
        return False


def main():
    _, channel, robot = FAULTS[sys.argv[3]]
    field_client.Channel = channel
    robot(sys.argv[1], int(sys.argv[2]), 40).run()


if __name__ == "__main__":
    main()
