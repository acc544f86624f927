// A session and a tap over real sockets, against a router's end played by the test.
#include "common/operator/io/bus_session.hpp"

#include "common/operator/io/tap.hpp"
#include "common/operator/io/test/played_router.hpp"

using namespace trb;
using namespace trb::op;

TEST_CASE("a session joins a node's bus, asks its router, and passes on what answers nothing") {
  PlayedRouter node;
  auto bus = BusSession::open("cli");
  REQUIRE(bus.ok());
  CHECK_FALSE((*bus)->is_up());
  const Message hello = node.expect(**bus, ServiceHello::kSubtype);
  CHECK(decode<ServiceHello>(hello.data)->service == "cli");
  node.send(ServiceWelcome{"ant", "robot", 1, 1, 1});
  REQUIRE(PlayedRouter::turn_until(**bus, [&] { return (*bus)->is_up(); }));
  CHECK((*bus)->session().node() == "ant");

  std::optional<Result<RunView>> view;
  (*bus)->session().ask_node<RunView>(RunQuery{"3f2a"},
                                      Callback<RunView>([&](Result<RunView> seen) { view.emplace(std::move(seen)); }));
  const Message question = node.expect(**bus, RunQuery::kSubtype);
  RunView answer;
  answer.run = "3f2a0000";
  node.send(answer, question.id);
  REQUIRE(PlayedRouter::turn_until(**bus, [&] { return view.has_value(); }));
  CHECK((*view)->run == "3f2a0000");

  std::string heard;
  (*bus)->on_message([&](const Message& message) { heard = message.subtype; });
  node.send(SensorReading{});
  CHECK(PlayedRouter::turn_until(**bus, [&] { return heard == SensorReading::kSubtype; }));
}

TEST_CASE("a tap gives the records that its filter lets through") {
  PlayedRouter node;
  auto server = Socket::tap_server(node.context(), "ipc://bus/tap.ipc");
  REQUIRE(server.ok());
  auto bus = BusSession::open("cli");
  REQUIRE(bus.ok());
  std::string records;
  const Tap tap((*bus)->context(), (*bus)->loop(), ipc_bus("tap"), {}, [&](const TapRecord& record) {
    records += record.direction + std::string(record.header.subtype) + " ";
    return true;
  });
  Frame subscription;
  REQUIRE(PlayedRouter::turn_until(**bus, [&] { return server->receive(subscription); }));
  for (const char* subtype : {"greeting", "keep_alive", "farewell"}) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype;
    message.source = message.target = "ant";
    server->send(to_frame("<"), true);
    server->send(to_frame(encode_frame(message)));
  }
  CHECK(PlayedRouter::turn_until(**bus, [&] { return records == "<greeting <farewell "; }));
}
