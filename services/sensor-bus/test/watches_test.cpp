// Values now and then: leases, rates, ends.
#include "services/sensor-bus/test/bench.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

namespace {

/// "1 2 3": the counts of the readings of that watch since the last call.
std::string counts(Bench& bench, std::uint64_t number = 7) {
  std::string text;
  for (const SensorReading& one : sent<SensorReading>(bench.out)) {
    if (one.watch == number) text += (text.empty() ? "" : " ") + std::to_string(one.count);
  }
  bench.out.clear();
  return text;
}

/// The device tells a value every `period` for `time`.
void run(Bench& bench, Duration time, Duration period) {
  for (const MonotonicTime end = bench.now.mono + time; bench.now.mono < end;) {
    bench.wait(period);
    bench.device_says("usb1#t", 20);
  }
}

}  // namespace

TEST_CASE("a watch is told each value on the lossy lane, numbered, as the answer to its newest request") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  auto request = bench.watch("temperature");
  CHECK(bench.answer(request) == "ack accepted");
  CHECK(bench.rules() == "+temperature");
  run(bench, 3s, 1s);
  for (const Send& send : bench.out.sends) {
    if (!holds_alternative<SensorReading>(send.body)) continue;
    CHECK(send.reply_to == request);
    CHECK(send.flags == kFlagLossy);
    CHECK(send.target == "ur3");
  }
  CHECK(counts(bench) == "1 2 3");
  request = bench.watch("temperature");
  run(bench, 1s, 1s);
  CHECK(bench.out.sends.back().reply_to == request);
  CHECK(counts(bench) == "4");
}

TEST_CASE("without renewal it ends with its lease, and its rule with it") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.watch("temperature", 1, 5);
  run(bench, 4s, 1s);
  CHECK(bench.rules() == "+temperature");
  bench.wait(1100ms);
  CHECK(bench.rules() == "-temperature");
  bench.clear();
  run(bench, 3s, 1s);
  CHECK(counts(bench).empty());
}

TEST_CASE("a lease of 0 ends it at once; that of another asker goes on with the one rule") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.watch("temperature");
  bench.watch("temperature", 1, 10, 8, "pioneer1");
  CHECK(bench.rules() == "+temperature");
  CHECK(bench.answer(bench.watch("temperature", 1, 0)) == "ack accepted");
  CHECK(bench.rules().empty());
  bench.clear();
  run(bench, 1s, 1s);
  CHECK(sent<SensorReading>(bench.out).size() == 1);
  bench.watch("temperature", 1, 0, 8, "pioneer1");
  CHECK(bench.rules() == "-temperature");
}

TEST_CASE("a node that is gone takes its watches and reads along") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.watch("temperature");
  bench.read("temperature");
  CHECK(bench.rules() == "+temperature");
  bench.core.on({MessageType::information, "conveyor", "conveyor", 1, 0, 0, 1000, PeerExpired{"ur3", "silent"}},
                bench.now, bench.out);
  bench.collect();
  CHECK(bench.rules() == "-temperature");
}

TEST_CASE("each watch has its own rate; a value that comes a little early counts") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "", "temperature", 0.1);
  bench.watch("temperature", 1, 60, 1);
  bench.watch("temperature", 0.2, 60, 2);
  bench.watch("temperature", 0, 60, 3);  // as often as it is told
  bench.clear();
  for (int i = 0; i < 10; ++i) run(bench, 990ms, 99ms);  // its clock is fast
  std::map<std::uint64_t, int> told;
  for (const SensorReading& one : sent<SensorReading>(bench.out)) ++told[one.watch];
  CHECK(told[1] == 10);
  CHECK(told[2] == 50);
  CHECK(told[3] == 100);
}

TEST_CASE("when the sensor is unplugged its watchers are told, so that they look for it elsewhere") {
  Bench bench;
  bench.plug("usb1#t", "temperature", "SN1");
  const auto request = bench.watch("temperature");
  bench.clear();
  bench.unplug("usb1#t");
  CHECK(bench.answer(request) == "nack unknown_target: temperature was unplugged");
  CHECK(bench.rules() == "-temperature");
  CHECK(bench.answer(bench.ask(SensorWatch{"", "SN1", 7, 1, 10})) ==
        "nack unknown_target: no sensor here has the identity SN1");
}

TEST_CASE("when it falls silent or fails the last value is told once more, stale, with its age") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.watch("temperature", 1, 60);
  run(bench, 1s, 1s);
  bench.clear();
  bench.wait(3100ms);
  auto readings = sent<SensorReading>(bench.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].quality == "stale");
  CHECK(readings[0].age_s == doctest::Approx(3));
  CHECK(readings[0].count == 2);
  CHECK(bench.info("temperature").state == SensorState::silent);
  bench.clear();
  run(bench, 1s, 1s);
  CHECK(bench.info("temperature").state == SensorState::ok);
  bench.clear();
  bench.fails("usb1#t", "hangs");
  bench.fails("usb1#t", "hangs");
  CHECK(sent<SensorReading>(bench.out).size() == 1);
}

TEST_CASE("what makes no sense is refused with words, and there are 256 watches at most") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(bench.answer(bench.watch("temperature", nan)) == "nack bad_value: every_s: is no number of seconds");
  CHECK(bench.answer(bench.watch("temperature", 1, -1)) == "nack bad_value: lease_s: is no number of seconds");
  CHECK(bench.answer(bench.watch("temperature", 1, std::numeric_limits<double>::infinity())) == "ack accepted");
  bench.wait(61s);
  CHECK(bench.rules() == "+temperature -temperature");  // 60 s at most
  for (std::uint64_t i = 0; i < 256; ++i) bench.watch("temperature", 1, 10, i);
  CHECK(bench.answer(bench.watch("temperature", 1, 10, 999)) ==
        "nack queue_full: the sensors of this node are watched 256 times already");
  CHECK(bench.answer(bench.watch("temperature", 1, 10, 5)) == "ack accepted");  // a renewal
}

TEST_CASE("the bus that comes back gets the rules of those who still watch") {
  Bench bench;
  bench.plug("usb1#t", "temperature");
  bench.watch("temperature", 1, 60);
  bench.news(BusDown{"gone"});
  bench.clear();
  bench.sample("usb1#t", 20);
  CHECK(bench.effects.empty());
  bench.news(BusUp{""});
  CHECK(bench.rules() == "+temperature");
  run(bench, 1s, 1s);
  CHECK(counts(bench) == "1");
}
