// A client of the live stream that comes back: what it has missed by its number, or a snapshot and why.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/cloud-gateway/core/live/test/shown.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

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
