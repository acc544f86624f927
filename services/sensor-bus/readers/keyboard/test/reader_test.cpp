#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "services/sensor-bus/test/machine.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace trb::sensor::test;

TEST_CASE("a reader of tags that types tells its tags") {
  Machine machine;
  const std::string node = machine.file("/dev/input/event7");
  std::filesystem::create_directories(machine.file("/dev/input"));
  const std::string keys =
      machine.plug("input", "event7", {},
                   {"DEVNAME", "/dev/input/event7", "ID_INPUT_KEYBOARD", "1", "ID_VENDOR_ID", "08ff", "ID_BUS", "usb"});
  std::filesystem::remove(node);
  REQUIRE(::mkfifo(node.c_str(), 0600) == 0);
  const Descriptor fifo(::open(node.c_str(), O_RDWR | O_NONBLOCK));
  REQUIRE(fifo);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  CHECK(running.heard.plugged.begin()->second.every_s == 0);
  for (const std::uint16_t code : {std::uint16_t{KEY_4}, std::uint16_t{KEY_2}, std::uint16_t{KEY_ENTER}}) {
    for (const int value : {1, 0}) {
      input_event event{};
      event.type = EV_KEY;
      event.code = code;
      event.value = value;
      REQUIRE(::write(fifo.get(), &event, sizeof event) == sizeof event);
    }
  }
  CHECK(running.until([&] { return running.heard.samples[keys + "#tag"].text == "42"; }));
}
