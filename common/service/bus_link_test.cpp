// The bus link against a router's end played by the test: hello, welcome, restarts, refusals.
#include "common/service/bus_link.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <set>
#include <utility>

#include "common/security/keys.hpp"
#include "common/service/test/bus_ends.hpp"

using namespace trb;
using namespace trb::test;

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
