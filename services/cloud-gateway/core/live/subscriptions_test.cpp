// What clients of the live stream receive, and when.
#include "services/cloud-gateway/core/live/subscriptions.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

using Rows = std::vector<std::string>;

/// The rows of a client that applies each frame.
struct Shown {
  std::map<std::string, std::string> rows;  ///< by kind, node and name
  void take(const Frame& frame) {
    for (const SharedBlock& block : frame.blocks) {
      if (block->begins) rows.clear();
      for (const SharedBytes& bytes : block->rows) {
        const std::string key = bytes->substr(0, bytes->rfind(" v"));
        if (bytes->find("removed") != std::string::npos) {
          rows.erase(key);
        } else {
          rows[key] = *bytes;
        }
      }
    }
  }
};

std::vector<Route> many(int robots) {
  std::vector<Route> out;
  out.reserve(static_cast<std::size_t>(robots));
  for (int i = 0; i < robots; ++i) out.push_back(route("robot" + std::to_string(i)));
  return out;
}

void tell_all(Hall& hall, int value) {
  for (int i = 0; i < 1200; ++i) hall.tell("robot" + std::to_string(i), "battery", std::to_string(value));
}

}  // namespace

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

TEST_CASE("a client that does not take its frame has its changes joined, and loses none in the end") {
  Hall hall;
  hall.table({route("pioneer1"), route("pioneer2")});
  const ClientId client = hall.client("fleet");
  Shown shown;
  shown.take(*hall.frame(client));
  for (int i = 0; i < 100; ++i) {
    hall.tell("pioneer1", "battery", std::to_string(i));
    if (i == 50) hall.tell("pioneer2", "battery", "1"), hall.table({route("pioneer1"), route("pioneer2")});
    hall.wait(std::chrono::milliseconds(100));
    hall.clients.pump(hall.now);
  }
  while (const auto frame = hall.clients.take(client)) {
    shown.take(*frame);
    hall.wait(std::chrono::milliseconds(100));
    hall.clients.pump(hall.now);
  }
  CHECK(shown.rows["robot pioneer1 "] == "robot pioneer1  v101 live");
  CHECK(shown.rows["robot pioneer2 "] == "robot pioneer2  v2 live");
}

TEST_CASE("over 1 MiB waits for a client: it is dropped, told so, and begins anew; nobody else notices") {
  Hall hall;
  hall.encoder.pad = 1000;
  hall.table(many(1200));
  const ClientId slow = hall.client("fleet");
  const ClientId quick = hall.client("fleet");
  for (int i = 0; i < 12; ++i) hall.frame(slow), hall.clients.take(quick);
  for (int i = 0; i < 40; ++i) {
    tell_all(hall, i);
    const auto frame = hall.frame(quick);
    REQUIRE(frame);
    CHECK(frame->notices.empty());
  }
  // The only frame made for it belongs to its snapshot.
  const auto frame = hall.clients.take(slow);
  REQUIRE(frame);
  CHECK(notices_of(*frame) == std::vector<NoticeKind>{NoticeKind::dropped});
  CHECK(frame->blocks[0]->begins);
  Shown shown;
  shown.take(*frame);
  for (int i = 0; i < 12; ++i) {
    const auto next = hall.frame(slow);
    if (!next) continue;
    shown.take(*next);
    CHECK(next->notices.empty());
  }
  CHECK(shown.rows.size() == 2401);
  CHECK(shown.rows["robot robot7 "].starts_with("robot robot7  v41 live"));
}

TEST_CASE("a client comes back: it is told what it has missed, by its number") {
  Hall hall;
  hall.table({route("pioneer1"), route("pioneer2")});
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  const ClientId client = hall.client("fleet");
  hall.subscribe(client, "alerts");
  const auto seen = hall.frame(client);
  hall.clients.close(client);
  hall.tell("pioneer2", "battery", "80");
  hall.say("cloud", AlertTable{});
  const ClientId again = hall.client("fleet", Resume{42, seen->head});
  hall.subscribe(again, "alerts", Resume{42, seen->head});
  const auto frame = hall.frame(again);
  CHECK(frame->notices.empty());
  CHECK_FALSE(frame->blocks[0]->is_snapshot);
  CHECK(rows_of(*frame) == Rows{"robot pioneer2  v2 live", "alert  a1 v2 removed"});
}

namespace {

/// A change of its fleet leaves no room for one of its alerts in the same frame.
struct CrowdedHall : Hall {
  CrowdedHall() {
    encoder.pad = 3000;
    table(many(100));
    say("cloud", AlertTable{{alert("a1", "robot1")}});
  }
  ClientId client_of_both(std::optional<Resume> resume = {}) {
    const ClientId both = client("fleet", resume);
    subscribe(both, "alerts", resume);
    return both;
  }
  void change_fleet(int value) {
    for (int i = 0; i < 100; ++i) tell("robot" + std::to_string(i), "battery", std::to_string(value));
  }
  void change_both() {
    change_fleet(7);
    say("cloud", AlertTable{{alert("a1", "robot1"), alert("a2", "robot2")}});
  }
  /// Its number once it has all.
  std::uint64_t catch_up(ClientId client) {
    std::uint64_t known = 0;
    while (const auto one = frame(client)) known = one->head;
    CHECK(known == book.head());
    return known;
  }
};

}  // namespace

TEST_CASE("a frame had no room for a topic: who resumes at its number is told that topic's row") {
  CrowdedHall hall;
  const ClientId client = hall.client_of_both();
  const std::uint64_t known = hall.catch_up(client);
  hall.change_both();
  const auto first = hall.frame(client);
  REQUIRE(first);
  REQUIRE(first->blocks.size() == 1);
  REQUIRE_FALSE(first->blocks[0]->more);
  CHECK(first->head == known);
  // The connection is lost twice, each time after the fleet's block.
  const auto second = hall.frame(hall.client_of_both(Resume{42, first->head}));
  REQUIRE(second);
  REQUIRE(second->blocks.size() == 1);
  CHECK(second->head == known);
  const auto rest = hall.frame(hall.client("alerts", Resume{42, second->head}));
  REQUIRE(rest);
  const Rows rows = rows_of(*rest);
  CHECK(std::any_of(rows.begin(), rows.end(), [](const std::string& row) { return row.starts_with("alert  a2 "); }));
  CHECK(hall.frame(client)->head == hall.book.head());
}

TEST_CASE("a frame had no room for a topic: the number of one that was dropped before it does not count") {
  CrowdedHall hall;
  const ClientId client = hall.client_of_both();
  const std::uint64_t known = hall.catch_up(client);
  hall.tell("robot2", "battery", "1");
  hall.wait(std::chrono::milliseconds(100));
  REQUIRE(hall.clients.pump(hall.now).size() == 1);  // which it does not take
  hall.encoder.pad = 12'000;
  hall.change_fleet(2);
  for (int i = 0; i < 6; ++i) {
    hall.wait(std::chrono::milliseconds(200));
    hall.clients.pump(hall.now);
  }
  const auto after = hall.clients.take(client);
  REQUIRE(after);
  REQUIRE(notices_of(*after) == std::vector{NoticeKind::dropped, NoticeKind::dropped});
  REQUIRE(after->blocks.size() == 1);
  CHECK(after->head == known);
}

TEST_CASE("a frame had no room for a topic: who began with nothing, or with what is of no number here, has no number") {
  CrowdedHall hall;
  CHECK(hall.frame(hall.client_of_both())->head == 0);
  CHECK(hall.frame(hall.client_of_both(Resume{41, 1}))->head == 0);
}

TEST_CASE("its number is of another start, is none yet, or is too old: a snapshot, and why") {
  Hall hall;
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  const std::uint64_t old = hall.book.head();
  const auto told = [&](Resume resume) { return *hall.frame(hall.client("alerts", resume)); };
  CHECK(notices_of(told({41, old})) == std::vector<NoticeKind>{NoticeKind::restarted});
  CHECK(notices_of(told({42, old + 1})) == std::vector<NoticeKind>{NoticeKind::restarted});
  CHECK(notices_of(told({42, old})).empty());
  for (int i = 0; i < 1100; ++i) hall.say("cloud", AlertTable{{alert("b" + std::to_string(i), "pioneer1")}});
  const Frame frame = told({42, old});
  CHECK(notices_of(frame) == std::vector<NoticeKind>{NoticeKind::too_old});
  CHECK(frame.blocks[0]->begins);
  CHECK(rows_of(frame).size() == 1);
}

TEST_CASE("who comes back to a topic and leaves it again and again without reading is told of it once") {
  Hall hall;
  const ClientId client = hall.client("alerts", Resume{41, 1});
  hall.wait(std::chrono::milliseconds(100));
  CHECK(hall.clients.pump(hall.now).size() == 1);
  for (int i = 0; i < 1000; ++i) {
    hall.clients.unsubscribe(client, *parse_topic("alerts"));
    hall.subscribe(client, "alerts", Resume{41, 1});
  }
  CHECK(notices_of(*hall.clients.take(client)).size() == 1);
  CHECK(notices_of(*hall.frame(client)) == std::vector<NoticeKind>{NoticeKind::restarted});
}

TEST_CASE("a stalled client whose removals are forgotten begins anew, and is told so") {
  Hall hall;
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1")}});
  const ClientId client = hall.client("alerts");
  hall.frame(client);
  for (int i = 0; i < 1100; ++i) hall.say("cloud", AlertTable{{alert("b" + std::to_string(i), "pioneer1")}});
  const auto frame = hall.frame(client);
  CHECK(notices_of(*frame) == std::vector<NoticeKind>{NoticeKind::too_old});
  CHECK(rows_of(*frame) == Rows{"alert  b1099 v1 live"});
}

TEST_CASE("a node whose sensors come and go takes no removal from the fleet's topic") {
  Hall hall;
  hall.table({route("pioneer1")});
  const std::uint64_t seen = hall.book.head();
  for (int i = 0; i < 1100; ++i) {
    Route flapping = route("pioneer2");
    SensorInfo sensor;
    sensor.name = "s" + std::to_string(i);
    flapping.profile.plugged = {sensor};
    hall.table({route("pioneer1"), flapping});
  }
  CHECK(hall.book.oldest(RowStream::single) > 0);
  CHECK(hall.frame(hall.client("fleet", Resume{42, seen}))->notices.empty());
}

TEST_CASE("messages that pass: from now on, the newest ones, and how many were left out") {
  Hall hall;
  CHECK_FALSE(hall.clients.wants_messages());
  hall.clients.add_message("before");
  const ClientId client = hall.client("messages");
  CHECK(hall.clients.wants_messages());
  hall.frame(client);
  for (int i = 0; i < 250; ++i) hall.clients.add_message("m" + std::to_string(i));
  const auto frame = hall.frame(client);
  REQUIRE(frame->messages.size() == 200);
  CHECK(*frame->messages.back() == "m249");
  CHECK(frame->left_out == 50);
  for (int i = 0; i < 3; ++i) hall.clients.add_message(std::string(400'000, 'x'));
  const auto large = hall.frame(client);
  CHECK(large->messages.size() == 1);
  CHECK(large->left_out == 2);
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

TEST_CASE("a stalled client's messages are counted, whatever becomes of its queue") {
  Hall hall;
  hall.encoder.pad = 1000;
  hall.table(many(1200));
  const ClientId client = hall.client("fleet");
  for (int i = 0; i < 12; ++i) hall.frame(client);
  hall.subscribe(client, "messages");
  for (int i = 0; i < 40; ++i) {
    hall.clients.add_message("one");
    tell_all(hall, i);
    hall.wait(std::chrono::milliseconds(100));
    hall.clients.pump(hall.now);
  }
  std::uint64_t messages = 0;
  for (auto frame = hall.clients.take(client); frame; frame = hall.frame(client)) {
    messages += frame->messages.size() + frame->left_out;
    if (frame->is_empty()) break;
  }
  CHECK(messages == 40);
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

TEST_CASE("the runs that somebody looks at are known, to be asked for") {
  Hall hall;
  const ClientId client = hall.client("run/" + kRun);
  CHECK(hall.clients.watched_runs() == std::set<std::string>{kRun});
  hall.clients.close(client);
  CHECK(hall.clients.watched_runs().empty());
  CHECK_FALSE(hall.clients.next_deadline());
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
