// What waits in a service for its router: how much of it, in which order, and for which router.
#include <doctest/doctest.h>

#include <filesystem>
#include <limits>
#include <utility>

#include "common/security/keys.hpp"
#include "common/service/bus_link.hpp"
#include "common/service/test/bus_ends.hpp"

using namespace trb;
using namespace trb::test;

TEST_CASE("of large messages for a router that stands still a few megabytes wait, small ones still have room") {
  init_crypto();
  Ends ends;
  ends.welcome();
  Message picture;
  picture.type = MessageType::information;
  picture.subtype = "picture";
  picture.target = "bee";
  picture.data = Bytes(1'000'000, 'p');
  int sent = 0;
  auto last = ends.link.send(picture);
  for (; last && sent < 2 * kHighWaterMark; ++sent) last = ends.link.send(picture);
  REQUIRE_FALSE(last);
  CHECK(last.error().code == Errc::queue_full);
  // The router's own end has received some as well.
  CHECK(sent < kReceiveHighWaterMark + 16);
  CHECK(ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value() != 0);
}

TEST_CASE("what the socket does not take waits in order, and leaves once the router reads") {
  init_crypto();
  Ends ends;
  ends.welcome();
  std::vector<std::uint64_t> sent;
  while (ends.link.has_room()) {
    sent.push_back(ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value());
  }
  sent.push_back(ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value());
  std::vector<std::uint64_t> heard;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (heard.size() < sent.size() && read_clocks().mono < end) {
    if (const auto next = ends.link.next_deadline(); next && *next <= read_clocks().mono) ends.link.tick(read_clocks());
    if (const auto message = ends.router.receive(); message && message->subtype == Stop::kSubtype)
      heard.push_back(message->id);
  }
  CHECK(heard == sent);
  CHECK(ends.link.has_room());
}

TEST_CASE("of what waits for a router that does not read there is a bound, and the maker is told of it") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const auto send = [&] { return ends.link.send(Send{.target = "bee", .body = Stop{"x"}}); };
  while (ends.link.has_room()) REQUIRE(send().ok());
  std::size_t waits = 1;
  while (waits < 2 * BusLink::kMostWaiting && send().ok()) ++waits;
  CHECK(waits == BusLink::kMostWaiting);
  CHECK(send().error().code == Errc::queue_full);
}

TEST_CASE("what its hearer would have to refuse does not leave, and the maker is told") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const auto refused = [&](Body body, const std::string& target = "bee") {
    return ends.link.send(Send{.type = MessageType::command, .target = target, .body = std::move(body)}).error();
  };
  RobotState state;
  state.values.resize(33);
  CHECK(refused(state).code == Errc::too_large);
  CHECK(refused(state).what == "robot_state: values: list over 32 items");
  SensorImage image;
  image.bytes.bytes.resize(1'000'001);
  CHECK(refused(image).what == "sensor_image: bytes: over 1000000 bytes");
  CHECK(refused(Opaque{"picture", std::string(kMaxDataSize + 1, 'x')}).code == Errc::too_large);
  SensorReading reading;
  reading.number = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(reading).code == Errc::bad_value);
  CHECK(refused(Stop{}, std::string(65, 'b')).code == Errc::malformed);
  // The largest message that may be sent arrives.
  REQUIRE(ends.link.send(Send{.target = "bee", .body = Opaque{"picture", std::string(kMaxDataSize, 'x')}}).value() !=
          0);
  const auto heard = hear(ends.link, ends.router, "picture");
  REQUIRE(heard);
  CHECK(heard->data.size() == kMaxDataSize);
}

TEST_CASE("what waits for a router that ends does not reach the next one, and is counted: hello comes first") {
  init_crypto();
  Folder folder;
  Context context;
  BusLink link(context, ipc_bus("probe"), hello());
  constexpr std::size_t kMany = 3000;
  const auto stop = [&] {
    return link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value();
  };
  {
    Router router;
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
    while (link.has_room()) REQUIRE(stop() != 0);
    for (std::size_t i = 1; i < kMany; ++i) REQUIRE(stop() != 0);
  }
  std::filesystem::remove(folder.path + "/bus/probe.ipc");
  Router again;
  std::optional<Message> first;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!first && read_clocks().mono < end) {
    if (const auto next = link.next_deadline(); next && *next <= read_clocks().mono) link.tick(read_clocks());
    link.receive(read_clocks());
    first = again.receive();
  }
  REQUIRE(first);
  CHECK(first->subtype == ServiceHello::kSubtype);
  CHECK(link.take_lost() == kMany);
  CHECK(stop() == 0);
  again.say(ServiceWelcome{"ant", "robot", 1, 2, 2});
  REQUIRE(link_until(link, [&] { return link.up(); }));
  CHECK(link.has_room());
  const std::uint64_t id = stop();
  const auto heard = hear(link, again, Stop::kSubtype);
  REQUIRE(heard);
  CHECK(heard->id == id);
  CHECK(link.take_lost() == 0);
}

TEST_CASE("what waits while its router's lease ends leaves under the same slot, and under no other") {
  init_crypto();
  Ends ends;
  ends.welcome();
  std::size_t sent = 0;
  for (; ends.link.has_room(); ++sent) REQUIRE(ends.link.send(Send{.target = "bee", .body = Stop{"x"}}).value() != 0);
  const auto later = [] {
    Now now = read_clocks();
    now.mono = now.mono + std::chrono::seconds(4);
    return now;
  };
  ends.link.tick(later());
  REQUIRE_FALSE(ends.link.up());
  ends.link.newly_welcomed = false;
  std::uint16_t slot = 1;
  std::size_t lost = 0;
  SUBCASE("the same") {}
  SUBCASE("another") {
    slot = 2;
    lost = 1;
  }
  std::size_t heard = 0;
  bool is_over = false;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!is_over && read_clocks().mono < end) {
    ends.link.tick(later());
    (void)ends.link.receive(later());
    if (std::exchange(ends.link.newly_welcomed, false))
      REQUIRE(ends.link.send(Send{.target = "bee", .body = Ack{"last", ""}}).value() != 0);
    const auto message = ends.router.receive();
    if (!message) continue;
    if (message->subtype == ServiceHello::kSubtype) ends.router.say(ServiceWelcome{"ant", "robot", slot, 1, 1});
    if (message->subtype == Stop::kSubtype) ++heard;
    is_over = message->subtype == Ack::kSubtype;
  }
  CHECK(is_over);
  CHECK(heard == sent - lost);
  CHECK(ends.link.take_lost() == lost);
}
