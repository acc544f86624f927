#include <doctest/doctest.h>

#include "services/sensor-bus/test/machine.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace trb::sensor::test;

TEST_CASE("a device that is plugged in is told once, however often udev says it") {
  Machine machine;
  Running running;
  REQUIRE(running.until([&] { return running.heard.times_plugged == 0; }));
  const std::string chip = machine.plug_hwmon("hwmon0", "1000\n");
  for (const char* action : {"add", "change", "bind", "add"}) machine.say(chip, action);
  CHECK(running.tells(chip + "#temp1_input", 1));
  machine.say(chip, "change");
  machine.unplug(chip);
  CHECK(running.until([&] { return running.heard.plugged.empty(); }));
  CHECK(running.heard.times_plugged == 1);
  CHECK(running.until([&] { return running.devices->counts().threads == 0; }));
}

TEST_CASE("a hundred devices at once come and go") {
  Machine machine;
  Running running;
  std::vector<std::string> chips;
  for (int i = 0; i < 100; ++i) {
    chips.push_back(machine.plug_hwmon("hwmon" + std::to_string(i), "5000\n"));
    // The real udev has room for more; umockdev's socket for ten.
    if (i % 8 == 7) REQUIRE(running.until([&] { return running.heard.times_plugged == i + 1; }));
  }
  CHECK(running.until([&] { return running.heard.samples.size() == 100; }));
  CHECK(running.devices->counts().threads == 100);
  for (std::size_t i = 0; i < chips.size(); ++i) {
    machine.unplug(chips[i]);
    if (i % 8 == 7) REQUIRE(running.until([&] { return running.heard.plugged.size() == 99 - i; }));
  }
  CHECK(running.until([&] { return running.heard.plugged.empty() && running.devices->counts().threads == 0; }));
  CHECK(running.heard.times_plugged == 100);
}

TEST_CASE("two devices of one serial number are two sensors") {
  Machine machine;
  const Descriptor one = make_pty();
  const Descriptor two = make_pty();
  machine.plug_tty("ttyUSB0", one.get(), kThermometer);
  machine.plug_tty("ttyUSB1", two.get(), kThermometer);
  Running running;
  CHECK(running.until([&] { return running.heard.plugged.size() == 4; }));
}

TEST_CASE("a device that no rule knows is listed while it is there") {
  Machine machine;
  Running running;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyUSB5", pty.get(), {"ID_VENDOR_ID", "2341", "ID_MODEL", "Uno"});
  REQUIRE(running.until([&] { return running.heard.unknown.size() == 1; }));
  CHECK(running.heard.unknown[0].device == tty);
  CHECK(running.heard.unknown[0].properties.find("ID_MODEL=Uno") != std::string::npos);
  machine.unplug(tty);
  CHECK(running.until([&] { return running.heard.unknown.empty(); }));
  CHECK(running.heard.plugged.empty());
}
