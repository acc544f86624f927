#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "common/fleet/sensor_rule.hpp"
#include "services/sensor-bus/test/machine.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace trb::sensor::test;

namespace {

/// One that is to fail, and one beside it: 1 and 2 degrees.
struct Thermometers {
  Machine machine;
  std::string one = machine.plug_hwmon("hwmon0", "1000\n");
  std::string good = machine.plug_hwmon("hwmon1", "2000\n");
  Running running;
};

}  // namespace

TEST_CASE("what is plugged in already is found, and read in SI units") {
  Machine machine;
  const std::string chip = machine.plug_hwmon("hwmon0", "21500\n");
  const std::string iio = machine.plug("iio", "iio:device0",
                                       {"name", "hts221", "in_temp_raw", "100\n", "in_temp_offset", "20\n",
                                        "in_temp_scale", "250\n", "in_humidityrelative_input", "40000\n"},
                                       {"DEVTYPE", "iio_device"});
  const std::string wire =
      machine.plug("w1", "28-0001", {"name", "28-0001", "w1_slave", "x : crc=57 YES\nx t=23125\n"});
  Running running;
  CHECK(running.tells(chip + "#temp1_input", 21.5));
  CHECK(running.tells(iio + "#in_temp", 30));
  CHECK(running.tells(iio + "#in_humidityrelative", 40));
  CHECK(running.tells(wire + "#temperature", 23.125));
  CHECK(running.heard.times_plugged == 4);
}

TEST_CASE("a value is read again at its period, and at once when it is asked for") {
  Machine machine;
  const std::string chip = machine.plug_hwmon("hwmon0", "1000\n");
  const std::string key = chip + "#temp1_input";
  const auto json = parse_json(R"({"match": {"subsystem": "hwmon"}, "read": "attributes",
    "sensors": [{"kind": "temperature", "attribute": "temp1_input", "scale": 0.001, "every_s": 3600}]})");
  ConfigFaults faults;
  std::vector<SensorRule> rules;
  rules.push_back(read_sensor_rule(*json, "r", faults));
  Running running(std::move(rules));
  REQUIRE(running.tells(key, 1));
  machine.set(chip, "temp1_input", "2000\n");
  running.devices->read_now(key);
  CHECK(running.tells(key, 2));
  CHECK(running.heard.counts[key] == 2);
}

TEST_CASE("a file that vanishes, is empty or holds no number is an error of its sensor alone") {
  Thermometers two;
  REQUIRE(two.running.tells(two.one + "#temp1_input", 1));
  for (const auto& [text, error] : {std::pair{"", "there is no number"}, std::pair{"12x\n", "'12x' is no number"}}) {
    two.machine.set(two.one, "temp1_input", text);
    two.running.devices->read_now(two.one + "#temp1_input");
    CHECK(two.running.fails(two.one + "#temp1_input", error));
  }
  std::filesystem::remove(two.machine.file(two.one + "/temp1_input"));
  two.running.devices->read_now(two.one + "#temp1_input");
  CHECK(two.running.fails(two.one + "#temp1_input", "No such file"));
  two.machine.set(two.one, "temp1_input", "3000\n");
  CHECK(two.running.tells(two.one + "#temp1_input", 3));
  CHECK_FALSE(two.running.heard.errors.contains(two.good + "#temp1_input"));
}

TEST_CASE("a reader that hangs is told as failed, holds up nothing, and is left behind at unplugging") {
  Thermometers two;
  CHECK(two.running.tells(two.good + "#temp1_input", 2));
  CHECK(two.running.tells(two.one + "#temp1_input", 1));
  const std::string file = two.machine.file(two.one + "/temp1_input");
  std::filesystem::remove(file);
  REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
  const Descriptor fifo(::open(file.c_str(), O_RDWR));  // it opens at once, and does not answer
  REQUIRE(fifo);
  two.running.devices->read_now(two.one + "#temp1_input");
  CHECK(two.running.fails(two.one + "#temp1_input", "hangs: no answer for 3 s"));
  two.machine.set(two.good, "temp1_input", "4000\n");
  CHECK(two.running.tells(two.good + "#temp1_input", 4));
  // Only what its syspath says goes: the file stays, so that the thread stays in it.
  two.machine.say(two.one, "remove");
  CHECK(two.running.until([&] { return two.running.heard.plugged.size() == 1; }));
  CHECK(two.running.devices->counts().left_behind == 1);
  CHECK(two.running.devices->counts().threads == 2);
  REQUIRE(::write(fifo.get(), "1\n", 2) == 2);
  CHECK(two.running.until([&] { return two.running.devices->counts().left_behind == 0; }));
  CHECK(two.running.devices->counts().threads == 1);
}
