// A client of the live stream that does not take its frames in time, and messages of which it gets the newest.
#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/shown.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

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
