// What clients of the live stream receive, and when.
#include "services/cloud-gateway/core/live/subscriptions.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/shown.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

TEST_CASE("a client is told a snapshot first, then what changes, with the numbers rising") {
  Hall hall;
  hall.table({route("pioneer1")});
  const ClientId client = hall.client("fleet");
  const auto first = hall.frame(client);
  REQUIRE(first);
  REQUIRE(first->blocks.size() == 1);
  CHECK(first->blocks[0]->begins);
  CHECK_FALSE(first->blocks[0]->more);
  CHECK(rows_of(*first).size() == 3);
  hall.tell("pioneer1", "battery", "80");
  const auto second = hall.frame(client);
  REQUIRE(second);
  CHECK_FALSE(second->blocks[0]->is_snapshot);
  CHECK(rows_of(*second) == Rows{"robot pioneer1  v2 live"});
  CHECK(second->count == first->count + 1);
  CHECK(second->head > first->head);
}

TEST_CASE("ten frames a second at most, and of a row that changes more often the newest value") {
  Hall hall;
  hall.table({route("pioneer1")});
  const ClientId client = hall.client("robot/pioneer1");
  hall.frame(client);
  int frames = 0;
  Rows last;
  for (int i = 0; i < 1000; ++i) {
    hall.tell("pioneer1", "battery", std::to_string(i));
    hall.wait(std::chrono::milliseconds(1));
    for (const ClientId id : hall.clients.pump(hall.now)) ++frames, last = rows_of(*hall.clients.take(id));
  }
  CHECK(frames == 10);
  CHECK(last == Rows{"robot pioneer1  v1001 live"});
}

TEST_CASE("nothing changes: a frame a second says that the line lives") {
  Hall hall;
  const ClientId client = hall.client("alerts");
  CHECK(hall.frame(client)->blocks[0]->begins);
  int frames = 0;
  for (int i = 0; i < 30; ++i) {
    const auto frame = hall.frame(client);
    if (!frame) continue;
    ++frames;
    CHECK(frame->blocks.empty());
  }
  CHECK(frames == 3);
}

TEST_CASE("a topic brings its own rows alone") {
  Hall hall;
  hall.table({route("pioneer1"), route("pioneer2")});
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  CHECK(rows_of(*hall.frame(hall.client("alerts"))) == Rows{"alert  a1 v1 live"});
  CHECK(rows_of(*hall.frame(hall.client("robot/pioneer2"))).size() == 3);
  CHECK(rows_of(*hall.frame(hall.client("sensor/pioneer1/dht22"))).empty());
  hall.book.put({RowKind::teleop, "pioneer1", {}}, TeleopRow{"ann", {}, {}, 0.02}, Live::live, hall.now);
  CHECK(rows_of(*hall.frame(hall.client("teleop"))) == Rows{"teleop pioneer1  v1 live"});
}

TEST_CASE("what goes away is told to who has seen it, and is in no later snapshot") {
  Hall hall;
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  const ClientId client = hall.client("alerts");
  hall.frame(client);
  hall.say("cloud", AlertTable{});
  CHECK(rows_of(*hall.frame(client)) == Rows{"alert  a1 v2 removed"});
  CHECK(rows_of(*hall.frame(hall.client("alerts"))).empty());
}

TEST_CASE("a change is encoded once for all clients, and those who keep up share the block") {
  Hall hall;
  hall.table(many(100));
  std::vector<ClientId> clients;
  clients.reserve(50);
  for (int i = 0; i < 50; ++i) clients.push_back(hall.client("fleet"));
  hall.wait(std::chrono::milliseconds(100));
  CHECK(hall.clients.pump(hall.now).size() == 50);
  CHECK(hall.encoder.count == 201);
  const Block* shared = hall.clients.take(clients[0])->blocks[0].get();
  for (std::size_t i = 1; i < clients.size(); ++i) CHECK(hall.clients.take(clients[i])->blocks[0].get() == shared);
}

TEST_CASE("a large snapshot comes in blocks of 768 kB; changes meanwhile are not lost") {
  Hall hall;
  hall.encoder.pad = 1000;
  hall.table(many(1000));
  const ClientId client = hall.client("fleet");
  Shown shown;
  for (int i = 0; i < 12; ++i) {
    hall.tell("robot5", "battery", std::to_string(i));
    const auto frame = hall.frame(client);
    REQUIRE(frame);
    CHECK(frame->size <= (768U << 10U));
    shown.take(*frame);
  }
  CHECK(shown.rows.size() == 2001);
  CHECK(shown.rows["robot robot5 "].starts_with("robot robot5  v13 live"));
}

TEST_CASE("several large topics: no frame is larger than what may wait, and each has its turn") {
  Hall hall;
  hall.encoder.pad = 4000;
  hall.table(many(400));
  AlertTable alerts;
  for (int i = 0; i < 128; ++i) alerts.alerts.push_back(alert("a" + std::to_string(i), "robot1"));
  hall.say("cloud", alerts);
  const ClientId client = hall.client("fleet");
  REQUIRE(hall.clients.subscribe(client, *parse_topic("alerts"), std::nullopt).ok());
  std::size_t rows = 0;
  for (int i = 0; i < 16; ++i) {
    const auto frame = hall.frame(client);
    if (!frame) continue;
    CHECK(frame->size <= (1U << 20U));
    rows += rows_of(*frame).size();
  }
  CHECK(rows == 801 + 128);
}

TEST_CASE("a frame says who tells nothing: an empty snapshot of alerts is not yet that there is none") {
  Hall hall;
  hall.table({});
  hall.say("cloud", RunTable{});
  const ClientId client = hall.client("alerts");
  const auto first = hall.frame(client);
  REQUIRE(first->blocks.size() == 1);
  CHECK(first->blocks[0]->rows.empty());
  CHECK(first->silent == RowSources{RowSource::resilience});
  hall.say("cloud", AlertTable{});
  for (int i = 0; i < 9; ++i) CHECK_FALSE(hall.frame(client));
  CHECK(hall.frame(client)->silent.empty());
}

TEST_CASE("what a frame says of the silent was so when its rows were looked at") {
  Hall hall;
  hall.table({});
  hall.say("cloud", RunTable{});
  const ClientId client = hall.client("alerts");
  hall.wait(std::chrono::milliseconds(100));
  hall.clients.pump(hall.now, hall.view.silent());
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  CHECK(hall.clients.take(client)->silent == RowSources{RowSource::resilience});
  const auto next = hall.frame(client);
  CHECK(next->silent.empty());
  CHECK(rows_of(*next).size() == 1);
}

TEST_CASE("subscribing twice changes nothing, unsubscribing ends it; clients and topics are bounded") {
  Hall hall;
  hall.table({route("pioneer1")});
  const ClientId client = hall.client("fleet");
  hall.subscribe(client, "fleet");
  CHECK(hall.frame(client)->blocks.size() == 1);
  hall.subscribe(client, "fleet");
  CHECK_FALSE(hall.frame(client));
  hall.clients.unsubscribe(client, *parse_topic("fleet"));
  hall.tell("pioneer1", "battery", "80");
  CHECK_FALSE(hall.frame(client));
  for (std::size_t i = 0; i < 64; ++i) hall.subscribe(client, "robot/r" + std::to_string(i));
  const auto one_more = hall.clients.subscribe(client, *parse_topic("robot/one-more"));
  CHECK(one_more.error().code == Errc::queue_full);
  CHECK(hall.clients.subscribe(99, *parse_topic("fleet")).error().code == Errc::unknown_target);
  while (hall.clients.open().ok()) continue;
  CHECK(hall.clients.open().error().code == Errc::queue_full);
}

TEST_CASE("the runs that somebody looks at are known once they are there, to be asked for") {
  Hall hall;
  const ClientId client = hall.client("run/" + kRun);
  CHECK(hall.clients.watched_runs().empty());
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  CHECK(hall.clients.watched_runs() == std::set<std::string>{kRun});
  hall.clients.close(client);
  CHECK(hall.clients.watched_runs().empty());
  CHECK_FALSE(hall.clients.next_deadline());
}

TEST_CASE("whoever makes up ids of runs keeps none that is there from being asked for") {
  Hall hall;
  const auto follow = [&] {
    hall.view.watch_runs(hall.clients.watched_runs(), hall.now);
    hall.wait({});
  };
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  for (int i = 0; i < 5; ++i) {
    const ClientId client = *hall.clients.open();
    for (int j = 0; j < 64; ++j)
      hall.subscribe(client, "run/" + std::to_string(100 + i * 64 + j) + std::string(29, 'f'));
  }
  follow();
  hall.client("run/" + kRun);
  follow();
  const auto asked = sent<RunQuery>(hall.out);
  CHECK(std::ranges::count(asked, kRun, &RunQuery::run) == 1);
}

TEST_CASE("1,000 robots with 10 changes a second and 50 clients: each change encoded once, all end at the same") {
  Hall hall;
  hall.table(many(1000));
  std::vector<Shown> shown(50);
  for (int i = 0; i < 50; ++i) hall.client("fleet");
  for (int step = 0; step < 10; ++step) {
    for (int i = 0; i < 1000; ++i) hall.tell("robot" + std::to_string(i), "x", std::to_string(step));
    hall.wait(std::chrono::milliseconds(100));
    for (const ClientId id : hall.clients.pump(hall.now)) shown[id - 1].take(*hall.clients.take(id));
  }
  CHECK(hall.encoder.count == 2001 + 9 * 1000);
  for (const Shown& one : shown) CHECK(one.rows == shown[0].rows);
  CHECK(shown[0].rows["robot robot999 "] == "robot robot999  v11 live");
}
