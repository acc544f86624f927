// Who listens to a topic, without the bridge around it: bounds, ends, and what comes with a message.
#include "services/ros-bridge/core/listeners.hpp"

#include <doctest/doctest.h>

#include "services/ros-bridge/core/message_codec.hpp"

using namespace trb;
using namespace trb::ros;

namespace {

struct ListenersFixture {
  Listeners listeners;
  Now now{{1'000'000'000}, {}};
  Outbox outbox;
  WorkerOutput worker;
  std::string node = "ridgeback";
  BridgeOut out{node, 7, outbox, worker};

  void listen(BridgeAction action, std::uint64_t token, const std::string& topic, std::vector<std::string> paths = {}) {
    const BridgeCommand command{7, token, action, topic, "", "", std::move(paths), 0};
    listeners.listen(command, now.mono + std::chrono::seconds(5), now, out);
  }
  /// A message of demo/Row on the topic, of that many numbers, all the same.
  void message(const std::string& topic, double number, std::size_t count = 1, const std::string& sum = "") {
    const std::string definition = "float64 first\nfloat64[] all\n";
    const auto type = *type_from_full_definition("demo/Row", definition);
    const Value row{Value::Object{{"first", Value{number}}, {"all", Value{Value::List(count, Value{number})}}}};
    WorkerMessage one{Word::message,
                      {topic, "demo/Row", sum.empty() ? type->md5 : sum, definition, *to_wire(*type, row)}};
    listeners.on_message(one, now, out);
  }
  /// A message of the type demo/Row, as that definition has it, all zero.
  void message_of(const std::string& definition, const std::string& name = "demo/Row") {
    const auto type = *type_from_full_definition(name, definition);
    WorkerMessage one{Word::message, {"/rows", name, type->md5, definition, *to_wire(*type, Value{Value::Object{}})}};
    listeners.on_message(one, now, out);
  }
  void wait(Duration time) {
    now.mono = now.mono + time;
    listeners.tick(now, out);
  }
  /// The worker could not take a message of the topic.
  void unread(const std::string& topic) {
    WorkerMessage one{Word::unread, {topic, "too_large", topic + ": a message of over 1 MiB", ""}};
    listeners.on_message(one, now, out);
  }
  /// "TOKEN DATA", "TOKEN CODE", or of a watch that goes on "TOKEN unknown: CODE", since the last call, a line each.
  std::string told() {
    std::string text;
    for (const BridgeEvent& event : sent<BridgeEvent>(outbox)) {
      const bool has_value = event.result == BridgeResult::value;
      const bool is_unknown = has_value && event.data.empty();
      text += std::to_string(event.token) + (is_unknown ? " unknown: " : " ");
      text += (has_value && !is_unknown ? event.data : event.code) + "\n";
    }
    outbox.sends.clear();
    return text;
  }
  /// What the worker gets since the last call.
  std::vector<WorkerMessage> orders() {
    std::vector<WorkerMessage> messages;
    REQUIRE(WorkerReader().add(std::exchange(worker.bytes, {}), messages));
    return messages;
  }
};

}  // namespace

TEST_CASE("of a map with more cells than are taken, the fields that are named are told") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::ask, 1, "/map", {"first"});
  fixture.listen(BridgeAction::ask, 2, "/map", {"all[7]"});
  fixture.listen(BridgeAction::ask, 3, "/map");
  fixture.listen(BridgeAction::watch, 4, "/map", {"second"});
  fixture.message("/map", 0.125, 120'000);
  CHECK(fixture.told() == "1 0.125\n2 too_large\n3 too_large\n4 unknown: bad_value\n");
}

TEST_CASE("an ask fails at its deadline, a watch waits on") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::ask, 1, "/odom");
  fixture.listen(BridgeAction::watch, 2, "/odom");
  CHECK(fixture.listeners.next_deadline() == fixture.now.mono + std::chrono::seconds(5));
  fixture.wait(std::chrono::milliseconds(4999));
  CHECK(fixture.told().empty());
  fixture.wait(std::chrono::milliseconds(1));
  CHECK(fixture.told() == "1 timeout\n");
  CHECK_FALSE(fixture.listeners.next_deadline());
  fixture.wait(std::chrono::hours(1));
  fixture.message("/odom", 3);
  CHECK(fixture.told() == "2 {\"first\":3.0,\"all\":[3.0]}\n");
}

TEST_CASE("topics, and the listeners of one, are bounded") {
  ListenersFixture fixture;
  for (std::size_t i = 0; i < Listeners::kMaxOfTopic; ++i) fixture.listen(BridgeAction::ask, i, "/odom");
  CHECK(fixture.told().empty());
  fixture.listen(BridgeAction::ask, 1000, "/odom");
  CHECK(fixture.told() == "1000 queue_full\n");
  for (std::size_t i = 1; i < Listeners::kMaxTopics; ++i) {
    fixture.listen(BridgeAction::ask, i, "/t" + std::to_string(i));
  }
  CHECK(fixture.told().empty());
  fixture.listen(BridgeAction::ask, 1001, "/one_more");
  CHECK(fixture.told() == "1001 queue_full\n");
  fixture.orders();
}

TEST_CASE("a topic is unsubscribed from once nobody has listened to it for a while") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::watch, 1, "/odom");
  fixture.wait(2 * Listeners::kIdle);
  fixture.orders();
  fixture.listeners.forget(1, fixture.now);
  fixture.wait(Listeners::kIdle - std::chrono::seconds(1));
  fixture.listen(BridgeAction::watch, 2, "/odom");
  fixture.wait(Listeners::kIdle);
  auto orders = fixture.orders();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].word == Word::subscribe);
  fixture.listeners.forget_all();
  fixture.wait({});  // since then nobody listens
  fixture.wait(Listeners::kIdle - std::chrono::seconds(1));
  CHECK(fixture.orders().empty());
  fixture.wait(std::chrono::seconds(1));
  orders = fixture.orders();
  REQUIRE(orders.size() == 1);
  CHECK(orders[0].word == Word::unsubscribe);
  CHECK(orders[0].parts == std::vector<Bytes>{"/odom"});
}

TEST_CASE("a message over 64 kB of JSON fails who asks for all of it, and not who names a field") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::ask, 1, "/rows");
  fixture.listen(BridgeAction::ask, 2, "/rows", {"first"});
  fixture.message("/rows", 0.125, 20'000);
  CHECK(fixture.told() == "1 too_large\n2 0.125\n");
}

TEST_CASE("a message that cannot be used makes a watch's value unknown, and does not end the watch") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::watch, 1, "/rows");
  fixture.listen(BridgeAction::watch, 2, "/rows", {"first"});
  fixture.listen(BridgeAction::watch, 3, "/rows", {"all[1]"});
  fixture.message("/rows", 0.125, 20'000);
  CHECK(fixture.told() == "1 unknown: too_large\n2 0.125\n3 0.125\n");
  fixture.wait(std::chrono::seconds(1));
  fixture.message("/rows", 0.5);
  CHECK(fixture.told() == "1 {\"first\":0.5,\"all\":[0.5]}\n2 0.5\n3 unknown: bad_value\n");
  fixture.wait(std::chrono::seconds(1));
  fixture.message("/rows", 0.5, 2);
  CHECK(fixture.told() == "1 {\"first\":0.5,\"all\":[0.5,0.5]}\n2 0.5\n3 0.5\n");
  CHECK(std::ranges::count(fixture.outbox.counts, "refused.bad_value") == 1);
  CHECK(std::ranges::count(fixture.outbox.counts, "refused.too_large") == 1);
}

TEST_CASE("what the worker cannot take is as a message that cannot be used: also told ten times a second at most") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::watch, 1, "/rows", {"first"});
  fixture.listen(BridgeAction::ask, 2, "/rows");
  fixture.unread("/rows");
  CHECK(fixture.told() == "1 unknown: too_large\n2 too_large\n");
  fixture.message("/rows", 1);
  fixture.unread("/rows");
  CHECK(fixture.told().empty());
  fixture.wait(std::chrono::milliseconds(100));
  CHECK(fixture.told() == "1 unknown: too_large\n");  // it is the newest
  fixture.message("/rows", 2);
  fixture.wait(std::chrono::milliseconds(100));
  CHECK(fixture.told() == "1 2.0\n");
  fixture.wait(std::chrono::hours(1));
  CHECK(fixture.orders().size() == 2);  // nothing is unsubscribed from
}

TEST_CASE("a type that came with a message is known from then on; one whose sum is another's is refused") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::watch, 1, "/rows");
  fixture.message("/rows", 1, 1, std::string(32, 'a'));
  CHECK(fixture.told() == "1 unknown: version_mismatch\n");
  CHECK(fixture.listeners.heard_type("demo/Row") == nullptr);
  fixture.listen(BridgeAction::ask, 2, "/rows", {"first"});
  fixture.message("/rows", 1);
  CHECK(fixture.told() == "2 1.0\n");
  fixture.wait(std::chrono::milliseconds(100));
  CHECK(fixture.told() == "1 {\"first\":1.0,\"all\":[1.0]}\n");
  fixture.listeners.clear();
  REQUIRE(fixture.listeners.heard_type("demo/Row"));
  CHECK(fixture.listeners.heard_type("demo/Row")->name == "demo/Row");
}

TEST_CASE("a type that has changed at run time is known as it was heard last") {
  ListenersFixture fixture;
  const auto size_of = [&] {
    fixture.listen(BridgeAction::ask, 1, "/rows");
    const RosTypePtr heard = fixture.listeners.heard_type("demo/Row");
    return heard ? heard->fields.size() : 0;
  };
  fixture.listen(BridgeAction::ask, 1, "/rows");
  // By turns: no order of the sums may decide.
  for (int turn = 0; turn < 2; ++turn) {
    fixture.message_of("float64 x\n");
    CHECK(fixture.told() == "1 {\"x\":0.0}\n");
    CHECK(size_of() == 1);
    fixture.message_of("float64 x\nfloat64 y\n");
    CHECK(fixture.told() == "1 {\"x\":0.0,\"y\":0.0}\n");
    CHECK(size_of() == 2);
  }
  // Two names of one sum.
  fixture.message_of("float64 x\n", "demo/Line");
  CHECK(size_of() == 2);
  REQUIRE(fixture.listeners.heard_type("demo/Line"));
  CHECK(fixture.listeners.heard_type("demo/Line")->name == "demo/Line");
}

TEST_CASE("with the subscriptions go the listeners: what comes later is nobody's") {
  ListenersFixture fixture;
  fixture.listen(BridgeAction::watch, 1, "/rows");
  fixture.listeners.clear();
  fixture.message("/rows", 1);
  fixture.listeners.on_failed("/rows", fail(Errc::too_large, "over 1 MiB"), fixture.now, fixture.out);
  fixture.wait(std::chrono::hours(1));
  CHECK(fixture.told().empty());
  CHECK_FALSE(fixture.listeners.next_deadline());
}
