// Values now and then: leases, rates, ends.
#include "services/sensor-bus/test/fixture.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace std::chrono_literals;

namespace {

/// "1 2 3": the counts of the readings of that watch since the last call.
std::string counts(Fixture& fixture, std::uint64_t number = 7) {
  std::string text;
  for (const SensorReading& one : sent<SensorReading>(fixture.out)) {
    if (one.watch == number) text += (text.empty() ? "" : " ") + std::to_string(one.count);
  }
  fixture.out.clear();
  return text;
}

/// The device tells a value every `period` for `time`.
void run(Fixture& fixture, Duration time, Duration period) {
  for (const MonotonicTime end = fixture.now.mono + time; fixture.now.mono < end;) {
    fixture.wait(period);
    fixture.device_sends("usb1#t", 20);
  }
}

}  // namespace

TEST_CASE("a watch is told each value on the lossy lane, numbered, as the answer to its newest request") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  auto request = fixture.watch("temperature");
  CHECK(fixture.answer(request) == "ack accepted");
  CHECK(fixture.rules() == "+temperature");
  run(fixture, 3s, 1s);
  for (const Send& send : fixture.out.sends) {
    if (!holds_alternative<SensorReading>(send.body)) continue;
    CHECK(send.reply_to == request);
    CHECK(send.flags == kFlagLossy);
    CHECK(send.target == "ur3");
  }
  CHECK(counts(fixture) == "1 2 3");
  request = fixture.watch("temperature");
  run(fixture, 1s, 1s);
  CHECK(fixture.out.sends.back().reply_to == request);
  CHECK(counts(fixture) == "4");
}

TEST_CASE("without renewal it ends with its lease, and its rule with it") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.watch("temperature", 1, 5);
  run(fixture, 4s, 1s);
  CHECK(fixture.rules() == "+temperature");
  fixture.wait(1100ms);
  CHECK(fixture.rules() == "-temperature");
  fixture.clear();
  run(fixture, 3s, 1s);
  CHECK(counts(fixture).empty());
}

TEST_CASE("a lease of 0 ends it at once; that of another requester goes on with the one rule") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.watch("temperature");
  fixture.watch("temperature", 1, 10, 8, "pioneer1");
  CHECK(fixture.rules() == "+temperature");
  CHECK(fixture.answer(fixture.watch("temperature", 1, 0)) == "ack accepted");
  CHECK(fixture.rules().empty());
  fixture.clear();
  run(fixture, 1s, 1s);
  CHECK(sent<SensorReading>(fixture.out).size() == 1);
  fixture.watch("temperature", 1, 0, 8, "pioneer1");
  CHECK(fixture.rules() == "-temperature");
}

TEST_CASE("a node that is gone takes its watches and reads along") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.watch("temperature");
  fixture.read("temperature");
  CHECK(fixture.rules() == "+temperature");
  fixture.core.on({MessageType::information, "conveyor", "conveyor", 1, 0, 0, 1000, PeerExpired{"ur3", "silent"}},
                  fixture.now, fixture.out);
  fixture.collect();
  CHECK(fixture.rules() == "-temperature");
}

TEST_CASE("each watch has its own rate; a value that comes a little early counts") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "", "temperature", 0.1);
  fixture.watch("temperature", 1, 60, 1);
  fixture.watch("temperature", 0.2, 60, 2);
  fixture.watch("temperature", 0, 60, 3);  // as often as it is told
  fixture.clear();
  for (int i = 0; i < 10; ++i) run(fixture, 990ms, 99ms);  // its clock is fast
  std::map<std::uint64_t, int> told;
  for (const SensorReading& one : sent<SensorReading>(fixture.out)) ++told[one.watch];
  CHECK(told[1] == 10);
  CHECK(told[2] == 50);
  CHECK(told[3] == 100);
}

TEST_CASE("when the sensor is unplugged its watchers are told, so that they look for it elsewhere") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature", "SN1");
  const auto request = fixture.watch("temperature");
  fixture.clear();
  fixture.unplug("usb1#t");
  CHECK(fixture.answer(request) == "nack unknown_target: temperature was unplugged");
  CHECK(fixture.rules() == "-temperature");
  CHECK(fixture.answer(fixture.ask(SensorWatch{"", "SN1", 7, 1, 10})) ==
        "nack unknown_target: no sensor here has the identity SN1");
}

TEST_CASE("when it falls silent or fails the last value is told once more, stale, with its age") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.watch("temperature", 1, 60);
  run(fixture, 1s, 1s);
  fixture.clear();
  fixture.wait(3100ms);
  auto readings = sent<SensorReading>(fixture.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].quality == "stale");
  CHECK(readings[0].age_s == doctest::Approx(3));
  CHECK(readings[0].count == 2);
  CHECK(fixture.info("temperature").state == SensorState::silent);
  fixture.clear();
  run(fixture, 1s, 1s);
  CHECK(fixture.info("temperature").state == SensorState::ok);
  fixture.clear();
  fixture.fails("usb1#t", "hangs");
  fixture.fails("usb1#t", "hangs");
  CHECK(sent<SensorReading>(fixture.out).size() == 1);
}

TEST_CASE(
    "of a program that falls silent, too: its value has the age since it came, or since the program measured it") {
  Fixture fixture;
  fixture.watch("humidity", 1, 60);
  for (int i = 0; i < 3; ++i) {
    fixture.program("humidity", 47, "percent");
    fixture.wait(1s);
  }
  const UtcTime last = fixture.now.utc - 1s;
  fixture.clear();
  fixture.wait(2100ms);
  auto readings = sent<SensorReading>(fixture.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].quality == "stale");
  CHECK(readings[0].age_s == doctest::Approx(3));
  CHECK(readings[0].time == last.ns);
  BusValue old;
  old.number = 48;
  old.time = (fixture.now.utc - 10s).ns;
  fixture.bus_event(SignalHeard{"humidity", false, old});
  fixture.clear();
  fixture.wait(10s);
  readings = sent<SensorReading>(fixture.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].time == *old.time);
  CHECK(readings[0].age_s > 13);
  BusValue ahead = old;
  ahead.time = (fixture.now.utc + 3600s).ns;
  fixture.bus_event(SignalHeard{"humidity", false, ahead});
  const UtcTime came = fixture.now.utc;
  fixture.clear();
  fixture.wait(50s);
  readings = sent<SensorReading>(fixture.out);
  REQUIRE(readings.size() == 1);
  CHECK(readings[0].time == came.ns);
  CHECK(readings[0].age_s > 3);
}

TEST_CASE("what makes no sense is refused with words, and there are 256 watches at most") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(fixture.answer(fixture.watch("temperature", nan)) == "nack bad_value: every_s: is no number of seconds");
  CHECK(fixture.answer(fixture.watch("temperature", 1, -1)) == "nack bad_value: lease_s: is no number of seconds");
  CHECK(fixture.answer(fixture.watch("temperature", 1, std::numeric_limits<double>::infinity())) == "ack accepted");
  fixture.wait(61s);
  CHECK(fixture.rules() == "+temperature -temperature");  // 60 s at most
  for (std::uint64_t i = 0; i < 256; ++i) fixture.watch("temperature", 1, 10, i);
  CHECK(fixture.answer(fixture.watch("temperature", 1, 10, 999)) ==
        "nack queue_full: the sensors of this node are watched 256 times already");
  CHECK(fixture.answer(fixture.watch("temperature", 1, 10, 5)) == "ack accepted");  // a renewal
  // Who has them all takes no other's place: one of its watches ends, and it is told so.
  fixture.out.clear();
  CHECK(fixture.answer(fixture.watch("temperature", 1, 10, 1, "pioneer1")) == "ack accepted");
  CHECK(sent<Nack>(fixture.out).size() == 1);
  CHECK(fixture.answer(fixture.watch("temperature", 1, 10, 999)) ==
        "nack queue_full: the sensors of this node are watched 256 times already");
}

TEST_CASE("the bus that comes back gets the rules of those who still watch") {
  Fixture fixture;
  fixture.plug("usb1#t", "temperature");
  fixture.watch("temperature", 1, 60);
  fixture.bus_event(BusDown{"gone"});
  fixture.clear();
  fixture.sample("usb1#t", 20);
  CHECK(fixture.effects.empty());
  fixture.bus_event(BusUp{""});
  CHECK(fixture.rules() == "+temperature");
  run(fixture, 1s, 1s);
  CHECK(counts(fixture) == "1");
}
