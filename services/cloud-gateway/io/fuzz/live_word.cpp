// What a client says on the live stream: refused with a reason, a topic that is followed, or a robot that is driven.
// Whatever was said before, the next frame can be made.
#include "services/cloud-gateway/io/live_word.hpp"

#include "common/base/ids.hpp"
#include "proto/value.hpp"
#include "services/cloud-gateway/core/live/subscriptions.hpp"
#include "services/cloud-gateway/io/drive_words.hpp"
#include "services/cloud-gateway/io/json_rows.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::gateway;

void fill(RowBook& book, Now now) {
  NodeRow node;
  node.state = "ONLINE";
  book.put({RowKind::node, "pioneer1", ""}, node, Live::live, now);
  book.put({RowKind::robot, "pioneer1", ""}, RobotRow{}, Live::live, now);
  Alert alert;
  alert.id = "0123456789abcdef";
  book.put({RowKind::alert, "", alert.id}, AlertRow{alert, {}}, Live::live, now);
}

struct Said {
  Subscriptions& clients;
  Drives& drives;
  ClientId client;
  Now now;

  Status operator()(const Subscribe& word) const {
    require(parse_topic(text_of(word.topic)).ok(), "a topic's text is that topic");
    return clients.subscribe(client, word.topic, word.resume);
  }
  Status operator()(const Unsubscribe& word) const {
    clients.unsubscribe(client, word.topic);
    return Done{};
  }
  Status operator()(const DriveWord& word) const {
    require(check_id("robot", word.robot).ok(), "a robot to drive has a valid id");
    require(!word.speeds.empty() && word.speeds.size() <= kMaxDriveAxes && word.sequence > 0, "a drive is in bounds");
    return drives.drive(driver(), word, now);
  }
  Status operator()(const AskFor& word) const { return drives.ask(driver(), word.robot, now); }
  Status operator()(const LetGo& word) const {
    drives.let_go(client, word.robot, now);
    return Done{};
  }
  [[nodiscard]] Driver driver() const { return {client, "ann", "127.0.0.1"}; }
};

}  // namespace

std::vector<Bytes> seeds() {
  return {R"({"subscribe": "fleet"})",
          R"({"subscribe": "fleet", "instance": 42, "from": 1})",
          R"({"subscribe": "robot/pioneer1", "instance": -1, "from": 18446744073709551615})",
          R"({"subscribe": "run/0123456789abcdef0123456789abcdef"})",
          R"({"subscribe": "sensor/pioneer1/humidity"})",
          R"({"subscribe": "alerts"})",
          R"({"subscribe": "messages"})",
          R"({"subscribe": "teleop"})",
          R"({"unsubscribe": "fleet"})",
          R"({"drive": "pioneer1", "part": "base", "speeds": [0.2], "sequence": 1, "take": true})",
          R"({"drive": "pioneer1", "part": "arm", "speeds": [1e308, -0.0], "sequence": 9007199254740991})",
          R"({"ask_for": "pioneer1"})",
          R"({"let_go": "pioneer1"})",
          R"({"subscribe": 7})",
          R"({"subscribe": "robot/../x", "unsubscribe": null})"};
}

void run(BytesView input) {
  Now now{{1'000'000'000}, {1'700'000'000'000'000'000}};
  RowBook book;
  JsonRows encoder;
  Subscriptions clients(book, encoder, 42);
  Drives drives(book);
  fill(book, now);
  const auto client = clients.open();
  require(client.ok(), "there is room for a client");
  const auto word = read_live_word(input);
  if (!word) return require(!word.error().what.empty(), "a refusal says why");
  if (const Status done = std::visit(Said{clients, drives, *client, now}, *word); !done)
    require(!done.error().what.empty(), "a refusal says why");
  for (int i = 0; i < 3; ++i) {
    now.mono = now.mono + std::chrono::seconds(2);
    drives.tick(now);
    for (const DriveAnswer& one : drives.take_effects().answers)
      require(parse_json(json_drive_answer(one)).ok(), "an answer is JSON");
    static_cast<void>(clients.pump(now));
    static_cast<void>(clients.take(*client));
  }
  drives.leave(*client, now);
  clients.close(*client);
}

}  // namespace trb::fuzz
