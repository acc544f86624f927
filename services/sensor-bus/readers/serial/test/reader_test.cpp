#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>

#include "services/sensor-bus/test/machine.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace trb::sensor::test;

TEST_CASE(
    "a serial line's values are told; a line of 1 MB and noise are errors; it ends at once when it is unplugged") {
  Machine machine;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyUSB0", pty.get(), kThermometer);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 2; }));
  CHECK(running.heard.plugged[tty + "#temperature"].info.identity == "1209:0001:S1/temperature");
  say_line(pty, running, "T=21.5;H=40\n");
  CHECK(running.tells(tty + "#temperature", 21.5));
  CHECK(running.tells(tty + "#humidity", 40));
  say_line(pty, running, std::string(1'000'000, 'x'));
  CHECK(running.fails(tty + "#temperature", "longer than 1024 bytes"));
  say_line(pty, running, "\nx\ny\nz\n");
  CHECK(running.fails(tty + "#temperature", "no line is as the rule says"));
  running.devices->read_now(tty + "#temperature");
  // The question and a line cross: a line that is read before the question is not told, so it goes on talking.
  CHECK(running.until([&] {
    say_line(pty, running, "T=-3;H=41\n");
    return running.heard.samples[tty + "#temperature"].number == doctest::Approx(-3);
  }));
  machine.unplug(tty);
  CHECK(running.until([&] { return running.heard.plugged.empty() && running.devices->counts().threads == 0; }));
}

TEST_CASE("a GPS tells where it is; garbage is its error, and not for ever") {
  Machine machine;
  const Descriptor pty = make_pty();
  const std::string tty = machine.plug_tty("ttyACM0", pty.get(), {"ID_VENDOR_ID", "1546"});
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 5; }));
  say_line(pty, running, "$GPGGA,x*00\n\xff\xfe\n$GPRMC\n");
  CHECK(running.fails(tty + "#latitude", "checksum"));
  say_line(pty, running, "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n");
  CHECK(running.tells(tty + "#latitude", 48.1173));
  CHECK(running.tells(tty + "#altitude", 545.4));
  CHECK(running.heard.samples[tty + "#position"].text == "48.1173000,11.5166667");
}

TEST_CASE("a serial line that hangs up is an error, and is opened again") {
  Machine machine;
  auto pty = std::make_unique<Descriptor>(make_pty());
  const std::string tty = machine.plug_tty("ttyUSB0", pty->get(), kThermometer);
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 2; }));
  say_line(*pty, running, "T=1;H=1\n");
  REQUIRE(running.tells(tty + "#temperature", 1));
  pty.reset();
  CHECK(running.fails(tty + "#temperature", "/dev/ttyUSB0"));
  pty = std::make_unique<Descriptor>(make_pty());
  std::filesystem::remove(machine.file("/dev/ttyUSB0"));
  std::filesystem::create_symlink(::ptsname(pty->get()), machine.file("/dev/ttyUSB0"));
  say_line(*pty, running, "T=2;H=2\n");
  CHECK(running.tells(tty + "#temperature", 2));
}
