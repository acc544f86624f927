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

namespace {

/// A reader of tags whose events the test writes.
class TagReader {
 public:
  TagReader() {
    const std::string node = machine_.file("/dev/input/event7");
    std::filesystem::create_directories(machine_.file("/dev/input"));
    key = machine_.plug(
              "input", "event7", {},
              {"DEVNAME", "/dev/input/event7", "ID_INPUT_KEYBOARD", "1", "ID_VENDOR_ID", "08ff", "ID_BUS", "usb"}) +
          "#tag";
    std::filesystem::remove(node);
    REQUIRE(::mkfifo(node.c_str(), 0600) == 0);
    fifo_ = Descriptor(::open(node.c_str(), O_RDWR | O_NONBLOCK));
    REQUIRE(fifo_);
  }

  void write(int type, int code, int value) {
    input_event event{};
    event.type = static_cast<std::uint16_t>(type);
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    REQUIRE(::write(fifo_.get(), &event, sizeof event) == sizeof event);
  }
  void press(int code) {
    for (const int value : {1, 0}) {
      write(EV_KEY, code, value);
      write(EV_SYN, SYN_REPORT, 0);
    }
  }

  std::string key;

 private:
  Machine machine_;
  Descriptor fifo_;
};

}  // namespace

TEST_CASE("a reader of tags that types tells its tags") {
  TagReader reader;
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  CHECK(running.heard.plugged.begin()->second.every_s == 0);
  for (const int code : {KEY_4, KEY_2, KEY_ENTER}) reader.press(code);
  CHECK(running.until([&] { return running.heard.samples[reader.key].text == "42"; }));
}

TEST_CASE("a tag of whose keys the kernel has dropped some is an error, and the next one is whole") {
  TagReader reader;
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  reader.press(KEY_4);
  reader.write(EV_KEY, KEY_LEFTSHIFT, 1);  // its release is among what is lost
  reader.write(EV_SYN, SYN_DROPPED, 0);
  for (const int code : {KEY_2, KEY_ENTER, KEY_A, KEY_7, KEY_ENTER}) reader.press(code);
  REQUIRE(running.until([&] { return running.heard.samples.contains(reader.key); }));
  CHECK(running.heard.samples[reader.key].text == "a7");
  CHECK(running.heard.errors[reader.key].what.find("keys were lost") != std::string::npos);
  CHECK(running.heard.counts[reader.key] == 2);  // the error, the whole tag
}
