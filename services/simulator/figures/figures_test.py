"""The arithmetic of the counted and measured figures."""
import collections
import struct
import types
import unittest

import paper_count
import seal_times
import tapped


def packet(protocol, inner, data, options=b""):
    """An IPv4 packet from 127.0.1.1:45000 to 127.0.1.2:40000."""
    head = 20 + len(options)
    length = head + len(inner) + data
    fields = struct.pack(">BBHHHBBH4s4s", 0x40 | head // 4, 0, length, 0, 0, 64, protocol, 0, bytes([127, 0, 1, 1]), bytes([127, 0, 1, 2]))
    return fields + options + inner + bytes(data)


PORTS = struct.pack(">HH", 45000, 40000)
TCP_HEAD = PORTS + bytes(8) + bytes([8 << 4]) + bytes(19)  # 32 bytes: with options


class Packets(unittest.TestCase):
    def test_what_tcp_and_udp_carry(self):
        ends = (("127.0.1.1", 45000), ("127.0.1.2", 40000))
        self.assertEqual(tapped.payload(packet(6, TCP_HEAD, 100)), (6, *ends, 100))
        self.assertEqual(tapped.payload(packet(6, TCP_HEAD, 0, options=bytes(8))), (6, *ends, 0))
        self.assertEqual(tapped.payload(packet(17, PORTS + bytes(4), 365)), (17, *ends, 365))

    def test_the_length_is_the_packets_own_if_its_end_was_not_read(self):
        self.assertEqual(tapped.payload(packet(6, TCP_HEAD, 60_000)[:tapped.HEAD])[3], 60_000)

    def test_what_is_neither_is_left_out(self):
        self.assertIsNone(tapped.payload(packet(1, bytes(8), 50)))
        self.assertIsNone(tapped.payload(b"\x45" + bytes(10)))
        self.assertIsNone(tapped.payload(packet(6, TCP_HEAD, 0)[:30]))

    def test_a_message_on_the_wire(self):
        # As services/simulator/world/wire_bytes.hpp has it.
        self.assertEqual([tapped.wire_size(size) for size in (0, 222, 223)], [35, 257, 265])


class Phases(unittest.TestCase):
    def test_words_have_the_phase_of_their_table(self):
        phases = tapped.phases()
        self.assertEqual([phases[word] for word in ("hello", "node_profile", "baton", "robot_fault", "keep_alive", "seal")],
                         ["identification", "devices", "forward", "fail", "upkeep", "upkeep"])
        self.assertEqual(phases["sensor_reading"], "updates")
        self.assertNotIn("position", phases)


class Rows(unittest.TestCase):
    def test_upkeep_is_apart_and_beacons_are_identification(self):
        taps = types.SimpleNamespace(
            messages=collections.Counter({("task", "results"): 3, ("updates", "sensor_reading"): 5, ("upkeep", "seal"): 7}),
            bytes=collections.Counter({("task", "results"): 300, ("updates", "sensor_reading"): 500, ("upkeep", "seal"): 700}))
        capture = types.SimpleNamespace(tcp=1600, udp=40, datagrams=2)
        said = collections.Counter(task=10, sensor=6, identification=4, upkeep=9)
        terms = {"boot": 16, "identification": 15, "devices": 182, "task": 36, "forward": 8, "sensor": 4, "fail": 2}
        rows = {row[0]: row[1:] for row in paper_count.rows_of({"said": said, "taps": taps, "capture": capture}, terms, 180)}
        self.assertEqual(rows["devices"][0], 2)
        self.assertEqual(rows["updates"], (180, 5, 5, 500, 3))
        self.assertEqual(rows["sensor"][:3], (4, 1, 0))
        self.assertEqual(rows["identification"][2:4], (2, 40))
        self.assertEqual(rows["total"], (263, 20, 10, 840, 5))
        self.assertEqual(rows["upkeep"][1:4], (9, 7, 700))
        self.assertEqual(rows["connections"][3], 1640 - 840 - 700)


class Waits(unittest.TestCase):
    def test_each_message_waits_for_the_next_seal(self):
        times = [(1.0, False), (1.005, False), (1.02, True), (2.0, False), (2.02, True), (3.0, False)]
        self.assertEqual([round(wait, 6) for wait in sorted(seal_times.waits(times))], [15, 20, 20])


if __name__ == "__main__":
    unittest.main()
