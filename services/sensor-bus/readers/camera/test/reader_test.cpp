#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "services/sensor-bus/test/machine.hpp"

using namespace trb;
using namespace trb::sensor;
using namespace trb::sensor::test;

TEST_CASE("a camera that takes no picture says why, at each request") {
  Machine machine;
  const std::string camera = machine.plug("video4linux", "video0", {"name", "cam"},
                                          {"DEVNAME", "/dev/video0", "ID_V4L_CAPABILITIES", ":capture:"});
  std::filesystem::remove(machine.file("/dev/video0"));
  std::ofstream(machine.file("/dev/video0")) << "no camera";
  Running running;
  REQUIRE(running.until([&] { return running.heard.plugged.size() == 1; }));
  for (std::size_t i = 1; i < 3; ++i) {
    running.devices->take_picture(camera + "#camera");
    CHECK(running.until([&] { return running.heard.pictures.size() == i; }));
    REQUIRE(running.heard.pictures.back().error.has_value());
    CHECK(running.heard.pictures.back().error->what.find("/dev/video0 is no camera") != std::string::npos);
  }
}
