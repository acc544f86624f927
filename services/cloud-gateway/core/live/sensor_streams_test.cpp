// Who watches a sensor gets its values, and when nobody does any more its node is told.
#include "services/cloud-gateway/core/live/sensor_streams.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

Route sensor_node(const std::string& id, const std::string& state = "ONLINE", const std::string& kind = "humidity") {
  Route out = route(id, state);
  SensorInfo sensor;
  sensor.name = "dht22";
  sensor.kind = kind;
  out.profile.plugged = {sensor};
  return out;
}

/// A hall whose clients' topics are followed as the process does it.
struct Watched : Hall {
  Watched() { table({sensor_node("pioneer1")}); }
  /// The leases of the orders that were sent since the last call.
  std::vector<double> orders() {
    if (clients.take_topics_changed()) view.watch_sensors(clients.watched_sensors(now), now);
    view.tick(now, out);
    std::vector<double> leases;
    for (const SensorWatch& order : sent<SensorWatch>(out)) leases.push_back(order.lease_s);
    out.clear();
    return leases;
  }
};

using Leases = std::vector<double>;

}  // namespace

TEST_CASE("the first client starts the stream, a second one shares it, the last one's leaving ends it") {
  Watched hall;
  const ClientId one = hall.client("sensor/pioneer1/dht22");
  CHECK(hall.orders() == Leases{10});
  const ClientId two = hall.client("sensor/pioneer1/dht22");
  CHECK(hall.orders() == Leases{});
  hall.clients.unsubscribe(one, *parse_topic("sensor/pioneer1/dht22"));
  CHECK(hall.orders() == Leases{});
  hall.clients.close(two);
  CHECK(hall.orders() == Leases{0});
  hall.wait(seconds(60));
  CHECK(hall.orders() == Leases{});
}

TEST_CASE("the order names sensor, stream and period; the end names the same stream") {
  Watched hall;
  hall.watch("pioneer1", "dht22");
  hall.wait({});
  hall.view.watch_sensors({}, hall.now);
  hall.wait({});
  const auto orders = sent<SensorWatch>(hall.out);
  REQUIRE(orders.size() == 2);
  CHECK(orders[0].sensor == "dht22");
  CHECK(orders[0].every_s == 0.1);
  CHECK(orders[1].watch == orders[0].watch);
}

TEST_CASE("a stream is renewed every 3 s, and ordered anew of a router that has forgotten it") {
  Watched hall;
  hall.client("sensor/pioneer1/dht22");
  CHECK(hall.orders() == Leases{10});
  hall.now.mono = hall.now.mono + seconds(2.9);
  CHECK(hall.orders() == Leases{});
  hall.now.mono = hall.now.mono + seconds(0.2);
  CHECK(hall.orders() == Leases{10});
  hall.view.on_welcome("cloud", hall.now);
  CHECK(hall.orders() == Leases{10});
}

TEST_CASE("a node that is away is asked nothing, its rows say so, and the stream begins when it is back") {
  Watched hall;
  hall.table({sensor_node("pioneer1", "OFFLINE")});
  const ClientId client = hall.client("sensor/pioneer1/dht22");
  CHECK(hall.orders() == Leases{});
  CHECK(hall.live(RowKind::sensor, "pioneer1", "dht22") == Live::not_heard);
  CHECK(rows_of(*hall.frame(client)) == std::vector<std::string>{"sensor pioneer1 dht22 v1 not_heard"});
  hall.table({sensor_node("pioneer1")});
  hall.now.mono = hall.now.mono + SensorStreams::kLook;
  CHECK(hall.orders() == Leases{10});
}

TEST_CASE("a watch that may be a new one has a new number: its count begins at 1 again") {
  Watched hall;
  hall.watch("pioneer1", "dht22");
  const auto orders = [&](Duration time) {
    hall.wait(time);
    auto out = sent<SensorWatch>(hall.out);
    hall.out.clear();
    return out;
  };
  const auto first = orders({});
  REQUIRE(first.size() == 1);
  CHECK(orders(SensorStreams::kRenew).at(0).watch == first[0].watch);
  hall.view.on_welcome("cloud", hall.now);
  const auto second = orders({});
  REQUIRE(second.size() == 1);
  CHECK(second[0].watch != first[0].watch);
  hall.table({sensor_node("pioneer1", "CONNECTION_BROKEN")});
  CHECK(orders(SensorStreams::kRenew).empty());
  hall.table({sensor_node("pioneer1")});
  const auto third = orders(SensorStreams::kLook);  // the old one may still be there
  REQUIRE(third.size() == 2);
  CHECK(third[0].watch == second[0].watch);
  CHECK(third[0].lease_s == 0);
  CHECK(third[1].watch != second[0].watch);
  CHECK(third[1].watch != first[0].watch);
  CHECK(third[1].lease_s == SensorStreams::kLease_s);
  CHECK(orders(SensorStreams::kRenew).at(0).watch == third[1].watch);
}

TEST_CASE("an unknown sensor and a camera are not ordered") {
  Watched hall;
  hall.client("sensor/pioneer1/made_up");
  hall.client("sensor/nobody/dht22");
  CHECK(hall.orders() == Leases{});
  hall.table({sensor_node("pioneer2", "ONLINE", "image")});
  hall.client("sensor/pioneer2/dht22");
  CHECK(hall.orders() == Leases{});
}

TEST_CASE("a client that takes no frame for 10 s keeps no stream; when it does it has it again") {
  Watched hall;
  const ClientId stalled = hall.client("sensor/pioneer1/dht22");
  hall.clients.pump(hall.now);
  CHECK(hall.orders() == Leases{10});
  hall.wait(ClientFeed::kStalled);
  hall.view.watch_sensors(hall.clients.watched_sensors(hall.now), hall.now);
  hall.out.clear();
  CHECK(hall.orders() == Leases{0});
  hall.table({sensor_node("pioneer1")});  // the router tells its table every 2 s
  CHECK(hall.clients.take(stalled));
  hall.view.watch_sensors(hall.clients.watched_sensors(hall.now), hall.now);
  CHECK(hall.orders() == Leases{10});
}

TEST_CASE("once nobody watches, the last value is gone, and one that was under way does not bring it back") {
  Watched hall;
  const ClientId client = hall.client("sensor/pioneer1/dht22");
  hall.orders();
  hall.say("pioneer1", reading(21, 1));
  REQUIRE(hall.row(RowKind::reading, "pioneer1", "dht22") != nullptr);
  hall.clients.close(client);
  hall.orders();
  hall.say("pioneer1", reading(22, 2));
  CHECK(hall.row(RowKind::reading, "pioneer1", "dht22") == nullptr);
  CHECK(hall.counted("dropped.not_watched") == 1);
}

TEST_CASE("256 sensors are watched at most; the next client is told") {
  Watched hall;
  std::vector<Route> nodes{sensor_node("pioneer1")};
  for (std::size_t i = 0; i < SensorStreams::kMaxStreams; ++i) nodes.push_back(sensor_node("n" + std::to_string(i)));
  hall.table(nodes);
  const auto topic = [](std::size_t i) { return *parse_topic("sensor/n" + std::to_string(i) + "/dht22"); };
  ClientId client = 0;
  for (std::size_t i = 0; i < SensorStreams::kMaxStreams; ++i) {
    if (i % ClientFeed::kMaxTopics == 0) client = *hall.clients.open();
    REQUIRE(hall.clients.subscribe(client, topic(i)).ok());
  }
  const ClientId late = *hall.clients.open();
  CHECK(hall.clients.subscribe(late, topic(0)).ok());
  const Status refused = hall.clients.subscribe(late, *parse_topic("sensor/pioneer1/dht22"));
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::queue_full);
}

TEST_CASE("who watches sensors that nobody has takes no place; one that comes is streamed from then on") {
  Watched hall;
  ClientId client = 0;
  for (std::size_t i = 0; i < SensorStreams::kMaxStreams; ++i) {
    if (i % ClientFeed::kMaxTopics == 0) client = *hall.clients.open();
    REQUIRE(hall.clients.subscribe(client, *parse_topic("sensor/ant/s" + std::to_string(i))).ok());
  }
  hall.client("sensor/ant/dht22");
  CHECK(hall.orders() == Leases{});
  const ClientId late = *hall.clients.open();
  REQUIRE(hall.clients.subscribe(late, *parse_topic("sensor/pioneer1/dht22")).ok());
  CHECK(hall.orders() == Leases{10});
  hall.table({sensor_node("pioneer1"), sensor_node("ant")});
  hall.view.watch_sensors(hall.clients.watched_sensors(hall.now), hall.now);
  CHECK(hall.orders() == Leases{10});
}
