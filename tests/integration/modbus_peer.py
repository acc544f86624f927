"""Modbus TCP by raw sockets: a client, and a device of the tests' own whose answers may go wrong in every way."""
import socket
import struct
import threading

COIL, DISCRETE, INPUT, HOLDING = "coil", "discrete", "input", "holding"
READS = {1: COIL, 2: DISCRETE, 3: HOLDING, 4: INPUT}
WRITES = {5: COIL, 6: HOLDING, 16: HOLDING}


def adu(number, pdu, unit=1):
    return struct.pack(">HHHB", number, 0, len(pdu) + 1, unit) + pdu


def exactly(peer, size):
    data = b""
    while len(data) < size:
        more = peer.recv(size - len(data))
        if not more:
            raise ConnectionError("closed")
        data += more
    return data


def read_adu(peer):
    """(number, unit, pdu)"""
    number, _, size, unit = struct.unpack(">HHHB", exactly(peer, 7))
    return number, unit, exactly(peer, size - 1)


class Client:
    """Sends given bytes unchanged."""

    def __init__(self, address, port):
        self.peer = socket.create_connection((address, port), 60)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.peer.close()

    def ask(self, request):
        """The whole answer to a whole request, both as hexadecimal text."""
        self.peer.sendall(bytes.fromhex(request))
        number, unit, pdu = read_adu(self.peer)
        return adu(number, pdu, unit).hex(" ")

    def pdu(self, request):
        """The same without the header."""
        return self.ask(adu(1, bytes.fromhex(request)).hex())[21:]


class Device:
    """A device with a memory. `mishap`, if set, happens once instead of the answer to the next write."""

    def __init__(self, address, memory):
        self.memory = dict(memory)  # (kind, address) -> value; others are illegal addresses
        self.writes = []
        self.mishap = None
        self.connections = 0
        self.listener = socket.create_server((address, 0))
        self.port = self.listener.getsockname()[1]
        self.ended = threading.Event()
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while not self.ended.is_set():
            try:
                peer, _ = self.listener.accept()
            except OSError:
                return
            self.connections += 1
            peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.serve, args=(peer,), daemon=True).start()

    def serve(self, peer):
        try:
            with peer:
                while not self.ended.is_set():
                    number, unit, pdu = read_adu(peer)
                    self.answer(peer, number, unit, pdu)
        except OSError:
            pass

    def answer(self, peer, number, unit, pdu):
        good = adu(number, self.carry_out(pdu), unit)
        mishap = self.mishap if pdu[0] in WRITES else None
        if mishap is None:
            return peer.sendall(good)
        self.mishap = None
        mishap(peer, good)

    def carry_out(self, pdu):
        function, address = pdu[0], struct.unpack(">H", pdu[1:3])[0]
        if function in READS:
            return self.read(function, READS[function], address, struct.unpack(">H", pdu[3:5])[0])
        if function not in WRITES:
            return bytes([function | 0x80, 1])
        kind = WRITES[function]
        values = struct.unpack(f">{len(pdu[6:]) // 2}H", pdu[6:]) if function == 16 else struct.unpack(">H", pdu[3:5])
        if kind == COIL:
            values = [1 if values[0] == 0xFF00 else 0]
        if any((kind, address + i) not in self.memory for i in range(len(values))):
            return bytes([function | 0x80, 2])
        self.writes.append((kind, address, *values))
        for i, value in enumerate(values):
            self.memory[kind, address + i] = value
        return pdu[:5]

    def read(self, function, kind, address, count):
        values = [self.memory.get((kind, address + i)) for i in range(count)]
        if None in values:
            return bytes([function | 0x80, 2])
        if kind in (COIL, DISCRETE):
            data = sum(value << i for i, value in enumerate(values)).to_bytes((count + 7) // 8, "little")
        else:
            data = struct.pack(f">{count}H", *values)
        return bytes([function, len(data)]) + data

    def close(self):
        self.ended.set()
        self.listener.close()
