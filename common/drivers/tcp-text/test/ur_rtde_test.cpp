// A controller's RTDE: the handshake, the samples, and what the driver makes of both.
#include "common/drivers/tcp-text/ur_rtde.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

std::string package(char type, const std::string& body) {
  return big_endian(3 + body.size(), 2) + type + body;
}

std::string sample(double joint, double tool) {
  std::string body = "\1";
  for (const double value : {joint, tool}) {
    for (int i = 0; i < 6; ++i) body += big_endian(std::bit_cast<std::uint64_t>(value), 8);
  }
  return package('U', body);
}

const std::string kSpoken = package('V', "\1");
const std::string kTypes = package('O', "\1VECTOR6D,VECTOR6D");
const std::string kRunning = package('S', "\1");

/// An arm whose commands.json has "rtde_port".
struct RtdeFixture : UrFixture {
  RtdeFixture() : UrFixture(with_rtde()) {}
  static Settings with_rtde() {
    Settings settings = ur3();
    settings.commands.data_port = 30004;
    return settings;
  }
  void connect() {
    up(Channel::data);
    hear(Channel::data, kSpoken + kTypes + kRunning);
  }
  std::string joints() { return answer(send(MessageType::request, "position", "")); }
};

}  // namespace

TEST_CASE("rtde: version 2, the outputs at their rate, and the start are asked for, one after the other") {
  UrRtde rtde(20);
  std::vector<UrSample> samples;
  Bytes said = rtde.begin();
  CHECK(said == package('V', std::string("\0\2", 2)));
  said.clear();
  CHECK(rtde.add(kSpoken, samples, said));
  CHECK(said == package('O', big_endian(std::bit_cast<std::uint64_t>(20.0), 8) + "actual_q,actual_TCP_pose"));
  said.clear();
  CHECK(rtde.add(kTypes, samples, said));
  CHECK(said == package('S', ""));
  CHECK(rtde.add(kRunning + sample(0.5, 0.25) + package('M', "\2hi\1c\3"), samples, said));
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].joints[5] == 0.5);
  CHECK(samples[0].tool[0] == 0.25);
}

TEST_CASE("rtde: what is refused or is not of its form is an error, numbers that are none are skipped") {
  const auto error_of = [](const std::string& heard) {
    UrRtde rtde(10);
    std::vector<UrSample> samples;
    Bytes said = rtde.begin();
    const Status read = rtde.add(heard, samples, said);
    CHECK(samples.empty());
    return read ? std::string() : read.error().what;
  };
  CHECK(error_of(package('V', std::string(1, '\0'))) == "the controller's RTDE does not speak version 2");
  CHECK(error_of(kSpoken + package('O', std::string("\0VECTOR6D,NOT_FOUND", 19))) ==
        "the controller's RTDE does not have actual_q,actual_TCP_pose");
  CHECK(error_of(kSpoken + kTypes + package('S', std::string(1, '\0'))) == "the controller's RTDE does not start");
  CHECK(error_of(kSpoken + kTypes + kRunning + package('U', "\1short")) == "an RTDE sample of 6 bytes");
  CHECK(error_of(std::string("\0\2V", 3)) == "an RTDE package of 2 bytes");
  CHECK(error_of("\xff\xffU") == "an RTDE package of 65535 bytes");
  CHECK(error_of(kSpoken + kTypes + kRunning + sample(std::numeric_limits<double>::quiet_NaN(), 0)).empty());
}

TEST_CASE("rtde: the joints are those that it has measured, and the monitor's again when it is gone") {
  RtdeFixture fixture;
  fixture.state({.joint = 0.5});
  CHECK(fixture.joints() == "[0.5000,0.5000,0.5000,0.5000,0.5000,0.5000]");
  fixture.connect();
  CHECK(fixture.written(Channel::data).starts_with(package('V', std::string("\0\2", 2))));
  fixture.hear(Channel::data, sample(0.75, 0.25));
  fixture.state({.joint = 0.5});
  CHECK(fixture.joints() == "[0.7500,0.7500,0.7500,0.7500,0.7500,0.7500]");
  fixture.down(Channel::data);
  fixture.live(3.1, {.joint = 0.5});
  CHECK(fixture.joints() == "[0.5000,0.5000,0.5000,0.5000,0.5000,0.5000]");
}

TEST_CASE("rtde: a refusal or a silence of 3 s closes it, and the robot stays online") {
  RtdeFixture fixture;
  fixture.up(Channel::data);
  fixture.hear(Channel::data, package('V', std::string(1, '\0')));
  CHECK(fixture.counted("refused.rtde") == 1);
  fixture.collect();
  REQUIRE(fixture.robot.closes.size() == 1);
  CHECK(fixture.robot.closes[0].channel == Channel::data);
  fixture.up(Channel::data);
  fixture.live(3.1);
  CHECK(fixture.counted("refused.rtde") == 2);
  CHECK_FALSE(fixture.joints().starts_with("nack"));
}
