#include "services/sensor-bus/core/bus_value.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace trb;
using namespace trb::sensor;

namespace {

Errc code_of(const std::vector<BusArgument>& arguments) {
  const auto value = read_bus_value(arguments);
  return value ? Errc::ok : value.error().code;
}

}  // namespace

TEST_CASE("a value with all four arguments, or with the first alone, of any type") {
  const auto full = read_bus_value({21.5, "degC", std::int64_t{1'700'000'000'000'000'000}, "good"});
  REQUIRE(full);
  CHECK(full->number == 21.5);
  CHECK(full->unit == "degC");
  CHECK(full->time == 1'700'000'000'000'000'000);
  CHECK(full->quality == "good");
  for (const BusArgument& one :
       {BusArgument(true), BusArgument(std::int64_t{1}), BusArgument(std::uint64_t{1}), BusArgument(1.0)}) {
    const auto value = read_bus_value({one});
    REQUIRE(value);
    CHECK(value->number == 1);
    CHECK_FALSE(value->is_text);
    CHECK_FALSE(value->time);
  }
  const auto text = read_bus_value({"04A1B2"});
  REQUIRE(text);
  CHECK(text->is_text);
  CHECK(text->text == "04A1B2");
  CHECK(read_bus_value({1.0, "m", std::int64_t{0}, "uncertain", std::monostate{}})->quality == "bad");
}

TEST_CASE("what is no value is refused, naming the argument") {
  CHECK(code_of({}) == Errc::missing);
  CHECK(code_of({std::monostate{}}) == Errc::bad_value);
  CHECK(code_of({std::numeric_limits<double>::quiet_NaN()}) == Errc::bad_value);
  CHECK(code_of({std::numeric_limits<double>::infinity()}) == Errc::bad_value);
  // NOLINTNEXTLINE(bugprone-string-constructor): it is to be large
  CHECK(code_of({std::string(10'000'000, 'x')}) == Errc::too_large);
  CHECK(code_of({"\xff\xfe"}) == Errc::bad_value);
  CHECK(code_of({1.0, 2.0}) == Errc::bad_value);
  CHECK(code_of({1.0, std::string(17, 'm')}) == Errc::bad_value);
  CHECK(code_of({1.0, "m", "now"}) == Errc::bad_value);
  CHECK(code_of({1.0, "m", std::int64_t{-1}}) == Errc::bad_value);
  CHECK(code_of({1.0, "m", std::numeric_limits<std::uint64_t>::max()}) == Errc::bad_value);
  CHECK(code_of({1.0, "m", std::int64_t{0}, 4.0}) == Errc::bad_value);
  CHECK(read_bus_value({1.0, 2.0}).error().what == "unit: is no text of at most 16 bytes");
}

TEST_CASE("path and interface must be those of one sensor") {
  CHECK(sensor_of("/trbots/humidity", "trbots.humidity") == "humidity");
  CHECK_FALSE(sensor_of("/trbots/humidity", "trbots.pressure"));
  CHECK_FALSE(sensor_of("/trbots", "trbots.humidity"));
  CHECK_FALSE(sensor_of("/trbots/a/b", "trbots.a.b"));
  CHECK_FALSE(sensor_of("/trbots/2nd", "trbots.2nd"));
  CHECK_FALSE(sensor_of("/org/humidity", "org.humidity"));
  CHECK_FALSE(is_sensor_name(""));
  CHECK_FALSE(is_sensor_name(std::string(65, 'a')));
  CHECK(is_sensor_name(std::string(64, 'a')));
}
