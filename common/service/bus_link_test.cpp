// The bus link against a router's end played by the test: hello, welcome, restarts, refusals.
#include "common/service/bus_link.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "common/security/keys.hpp"
#include "common/service/test/router_end.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// Advances time on the link, in steps of 20 ms without waiting, until the router's end has received one of the
/// subtypes.
std::optional<Message> hear(BusLink& link, Router& router, const std::set<std::string_view>& subtypes) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  for (Now now = read_clocks(); now.mono < end; now = read_clocks()) {
    link.tick(now);
    link.receive(now);
    zmq::pollitem_t items[] = {{router.socket->handle(), 0, ZMQ_POLLIN, 0}, {link.handle(), 0, ZMQ_POLLIN, 0}};
    zmq::poll(items, 2, std::chrono::milliseconds(20));
    if (auto message = router.receive(); message && subtypes.count(message->subtype) != 0) return message;
  }
  return std::nullopt;
}

std::optional<Message> hear(BusLink& link, Router& router, std::string_view subtype) {
  return hear(link, router, std::set{subtype});
}

template <class Condition>
bool link_until(BusLink& link, Condition condition) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!condition() && read_clocks().mono < end) {
    zmq::pollitem_t item{link.handle(), 0, ZMQ_POLLIN, 0};
    zmq::poll(&item, 1, std::chrono::milliseconds(20));
    link.receive(read_clocks());
  }
  return condition();
}

ServiceHello hello() {
  return {"cli", {"wave"}, 7, 1, "test"};
}

/// A service's link and its router's end of it.
struct Ends {
  Folder folder;
  Router router;
  Context context;
  BusLink link{context, ipc_bus("probe"), hello()};

  void welcome() {
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
  }
};

}  // namespace

TEST_CASE("a service says hello until it is welcomed, then its messages bear its slot") {
  init_crypto();
  Ends ends;
  CHECK(ends.link.send(Send{.target = "ant", .body = Stop{}}).value() == 0);
  const auto first = hear(ends.link, ends.router, ServiceHello::kSubtype);
  REQUIRE(first);
  CHECK(decode<ServiceHello>(first->data)->subtypes == std::vector<std::string>{"wave"});
  ends.router.say(ServiceWelcome{"ant", "robot", 0x1234, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up(); }));
  const std::uint64_t id =
      ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value();
  CHECK((id >> 48U) == 0x1234);
  const auto heard = hear(ends.link, ends.router, Stop::kSubtype);
  REQUIRE(heard);
  CHECK(heard->source == "ant");
  CHECK(heard->target == "bee");
  CHECK(heard->id == id);
}

TEST_CASE("a router that stands still is told from one that is not there") {
  init_crypto();
  Ends ends;
  CHECK(link_until(ends.link, [&] { return ends.link.was_reached(); }));
  CHECK_FALSE(ends.link.up());

  const Folder nobody;
  Context context;
  BusLink alone{context, ipc_bus("probe"), hello()};
  alone.tick(read_clocks());
  CHECK_FALSE(alone.was_reached());
}

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

TEST_CASE("a note goes out at once, and with each sign of life until it is another one") {
  Ends ends;
  ends.welcome();
  const auto noted = [&] {
    const auto alive = hear(ends.link, ends.router, ServiceAlive::kSubtype);
    REQUIRE(alive);
    const auto body = decode<ServiceAlive>(alive->data);
    REQUIRE(body.ok());
    return body->note;
  };
  ends.link.set_note("cannot write x; make room" + std::string(kDefaultMaxSize, '!'));
  for (int i = 0; i < 2; ++i) CHECK(noted().starts_with("cannot write x; make room!"));
  ends.link.set_note("");
  CHECK(noted().empty());
}

TEST_CASE("a router that was started again is told hello again") {
  init_crypto();
  Folder folder;
  Context context;
  BusLink link(context, ipc_bus("probe"), hello());
  {
    Router router;
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
  }
  std::filesystem::remove(folder.path + "/bus/probe.ipc");
  Router again;
  // Once its lease has ended, it says hello unasked.
  const auto first = hear(link, again, {ServiceAlive::kSubtype, ServiceHello::kSubtype});
  REQUIRE(first);
  if (first->subtype == ServiceAlive::kSubtype) {
    again.say(HelloWanted{});
    REQUIRE(hear(link, again, ServiceHello::kSubtype));
  }
  again.say(ServiceWelcome{"ant", "robot", 2, 2, 2});
  REQUIRE(link_until(link, [&] { return link.up(); }));
  CHECK(link.welcome()->slot == 2);
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

TEST_CASE("a router that asks for a hello again and again is told it once") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const auto hellos_before = [&](const std::string& text) {
    REQUIRE(ends.link.send(Send{.target = "bee", .body = Stop{text}}).value() != 0);
    int hellos = 0;
    for (const MonotonicTime end = read_clocks().mono + kPatience; read_clocks().mono < end;) {
      const auto message = ends.router.receive();
      if (message && message->subtype == ServiceHello::kSubtype) ++hellos;
      if (message && message->subtype == Stop::kSubtype) return hellos;
    }
    return -1;
  };
  REQUIRE(hellos_before("first") >= 0);
  for (int i = 0; i < 64; ++i) ends.router.say(HelloWanted{});
  ends.router.say(ServiceWelcome{"ant", "robot", 2, 1, 1});
  const Now at = read_clocks();
  const MonotonicTime end = at.mono + kPatience;
  while (!(ends.link.up() && ends.link.welcome()->slot == 2) && read_clocks().mono < end) {
    (void)ends.link.receive(at);
    ends.link.tick(at);
  }
  CHECK(hellos_before("last") == 1);
}

TEST_CASE("a router whose messages come is there, though its answer to the keep-alive still waits behind them") {
  init_crypto();
  Ends ends;
  ends.welcome();
  Now later = read_clocks();
  for (int i = 0; i < 8; ++i) {
    later.mono = later.mono + std::chrono::seconds(1);
    ends.router.say(Ack{"done", ""});
    std::optional<Message> got;
    const MonotonicTime end = read_clocks().mono + kPatience;
    while (!got && read_clocks().mono < end) got = ends.link.receive(later);
    REQUIRE(got);
    ends.link.tick(later);
    CHECK(ends.link.up());
  }
  later.mono = later.mono + std::chrono::seconds(4);
  ends.link.tick(later);
  CHECK_FALSE(ends.link.up());
}

TEST_CASE("a router whose messages wait unread is there, though the service was busy for longer than its lease") {
  init_crypto();
  Ends ends;
  ends.welcome();
  ends.router.say(Ack{"done", ""});
  zmq::pollitem_t waits{ends.link.handle(), 0, ZMQ_POLLIN, 0};
  REQUIRE(zmq::poll(&waits, 1, std::chrono::duration_cast<std::chrono::milliseconds>(kPatience)) == 1);
  Now later = read_clocks();
  later.mono = later.mono + std::chrono::seconds(10);
  ends.link.tick(later);
  CHECK(ends.link.up());
  CHECK(ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value() != 0);
  CHECK(ends.link.receive(later));
  later.mono = later.mono + std::chrono::seconds(4);
  ends.link.tick(later);
  CHECK_FALSE(ends.link.up());
}

TEST_CASE("a link by which something far too large came is made again") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const Bytes first = ends.router.peer;
  REQUIRE(ends.router.socket->send_to(ends.router.peer, to_frame(Bytes(2U << 20U, 'x'))) == SendResult::sent);
  // Its libzmq closes the connection and never reopens it: the service notices when its lease ends.
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (ends.router.peer == first && read_clocks().mono < end) {
    ends.link.tick(read_clocks());
    (void)ends.link.receive(read_clocks());
    (void)ends.router.receive();
  }
  REQUIRE(ends.router.peer != first);
  ends.router.say(ServiceWelcome{"ant", "robot", 2, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up() && ends.link.welcome()->slot == 2; }));
}

TEST_CASE("an answer that comes before the router's welcome goes to the one who waits: it refuses no service") {
  init_crypto();
  Ends ends;
  REQUIRE(hear(ends.link, ends.router, ServiceHello::kSubtype));
  ends.router.say(Nack{"peer_unreachable", "task_offer", "bee", "no link", ""});
  std::optional<Message> got;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!got && read_clocks().mono < end) got = ends.link.receive(read_clocks());
  REQUIRE(got);
  CHECK(got->subtype == "nack");
  CHECK(ends.link.refusal().empty());
}

TEST_CASE("a refusal is kept for the person, an answer goes to the one who waits") {
  init_crypto();
  Ends ends;
  REQUIRE(hear(ends.link, ends.router, ServiceHello::kSubtype));
  ends.router.say(Nack{"already_claimed", "service_hello", "ant", "service 'cli' is running already", ""});
  REQUIRE(link_until(ends.link, [&] { return !ends.link.refusal().empty(); }));
  CHECK(ends.link.refusal().find("already_claimed") == 0);
  ends.router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up(); }));
  CHECK(ends.link.refusal().empty());
  ends.router.say(Ack{"stopped", ""});
  std::optional<Message> got;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!got && read_clocks().mono < end) got = ends.link.receive(read_clocks());
  REQUIRE(got);
  CHECK(got->subtype == "ack");
}
