// The road of a message: where it goes, who is refused, who is told.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using Seconds = std::chrono::seconds;
using To = Routing::To;

namespace {

/// Two linked nodes; ant has a mode-adapter (connection 1) and a scheduler (connection 2) that takes "baton".
struct Pair {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");

  Pair() {
    fleet.run(Seconds(1));
    hello(1, "mode-adapter", {"stop"});
    hello(2, "scheduler", {"baton", "execution_state"});
  }
  void hello(ConnectionId from, const std::string& service, std::vector<std::string> subtypes, bool probe = false) {
    Effects effects;
    ant.core->bus().on_hello(from, {service, std::move(subtypes), 5, 100, "1"},
                             probe ? kProbe : std::string_view(service), fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  std::uint64_t slot(std::size_t welcome) const {
    std::vector<std::uint64_t> slots;
    for (const BusSend& send : ant.bus) {
      if (send.message.subtype == ServiceWelcome::kSubtype)
        slots.push_back(decode<ServiceWelcome>(send.message.data)->slot);
    }
    return slots.at(welcome);
  }
  Message local(const std::string& target, const std::string& subtype, MessageType type = MessageType::command) const {
    return {.type = type, .subtype = subtype, .source = "ant", .target = target, .id = slot(0) << 48U | 9U, .data = {}};
  }
  Message remote(const std::string& subtype, MessageType type = MessageType::command) const {
    return {.type = type, .subtype = subtype, .source = "bee", .target = "ant", .id = 9, .data = {}};
  }
  /// A service asks; what it asks goes out.
  Routing ask(ConnectionId from, std::uint64_t id, const std::string& target, const std::string& subtype = "move",
              MessageType type = MessageType::command) {
    Message question{.type = type, .subtype = subtype, .source = "ant", .target = target, .id = id, .data = {}};
    return ant.core->routing().from_bus(from, header_of(question));
  }
  Routing route(const Message& message) { return ant.core->routing().from_bus(1, header_of(message)); }
  Routing come(const Message& message) {
    const LinkId link = ant.link_to("bee");
    return fleet.arrive(ant, link, ant.core->table().link(link)->heard + 1, message);
  }
  std::size_t nacks() const { return ant.told(Nack::kSubtype); }
};

}  // namespace

TEST_CASE("a message that cannot go out is refused with the reason") {
  Pair pair;
  CHECK(pair.route(pair.local("bee", "move")).to == To::peer);
  CHECK(pair.route(pair.local("cat", "move")).reason == Errc::unknown_target);
  Message late = pair.local("bee", "move");
  late.remaining_ms = 0;
  CHECK(pair.route(late).reason == Errc::expired);
  Message forged = pair.local("bee", "move");
  forged.source = "cat";
  CHECK(pair.route(forged).reason == Errc::source_mismatch);
  Message other_slot = pair.local("bee", "move");
  other_slot.id += 1ULL << 48U;
  CHECK(pair.route(other_slot).reason == Errc::malformed);
  CHECK(pair.route(pair.local("*", "move")).reason == Errc::bad_value);
  CHECK(pair.route(pair.local("*", "noise", MessageType::information)).to == To::every_peer);
  CHECK(pair.route(pair.local("bee", "goodbye", MessageType::information)).reason == Errc::not_permitted);
  pair.fleet.stop("bee");
  CHECK(pair.route(pair.local("bee", "move")).reason == Errc::peer_unreachable);
  pair.fleet.run(Seconds(11));
  CHECK(pair.route(pair.local("bee", "move")).reason == Errc::peer_expired);
}

TEST_CASE("an unclaimed word of the user's goes to the mode-adapter, an unclaimed typed one to nobody") {
  Pair pair;
  CHECK(pair.come(pair.remote("move")).connection == 1);
  CHECK(pair.come(pair.remote("baton")).connection == 2);
  CHECK(pair.come(pair.remote("run_query", MessageType::request)).reason == Errc::no_service);
}

TEST_CASE("a peer may not use what is between services of one node, nor bring it as an answer") {
  Pair pair;
  const auto subtypes = {"adapter_state",   "adapter_state_request", "cancel_execution", "execute",
                         "execution_query", "execution_state",       "outcome",          "outcome_journaled",
                         "run_submit",      "service_alive",         "service_hello",    "sign_request"};
  for (const char* subtype : subtypes) {
    CAPTURE(subtype);
    CHECK(pair.come(pair.remote(subtype)).reason == Errc::not_permitted);
    Message answer = pair.remote(subtype);
    answer.reply_to = pair.slot(1) << 48U | 1U;
    CHECK(pair.come(answer).reason == Errc::not_permitted);
  }
  CHECK(pair.ant.count("refused.not_permitted") == 24);
  Message command = pair.remote("move");
  command.reply_to = pair.slot(1) << 48U | 1U;
  CHECK(pair.come(command).reason == Errc::bad_value);
}

TEST_CASE("an answer goes to the slot that asked, and to no other") {
  Pair pair;
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = pair.slot(1) << 48U | 4U;
  CHECK(pair.ask(2, answer.reply_to, "bee").to == To::peer);
  CHECK(pair.come(answer).connection == 2);
  CHECK(pair.come(answer).connection == 2);  // a second one: done, after handed_over
  answer.reply_to = (pair.slot(1) + 1) << 48U | 4U;
  CHECK(pair.come(answer).reason == Errc::no_service);
}

TEST_CASE("a member that floods answers to what another was asked is refused, the one that was asked is heard") {
  Pair pair;
  pair.fleet.start("cat");
  pair.fleet.run(Seconds(2));
  const std::uint64_t first = pair.slot(0) << 48U;
  CHECK(pair.ask(1, first | 9U, "bee", "stop").to == To::peer);
  const LinkId link = pair.ant.link_to("cat");
  const auto from_cat = [&](const std::string& subtype, std::uint64_t id) {
    Message answer{.type = MessageType::information,
                   .subtype = subtype,
                   .source = "cat",
                   .target = "ant",
                   .id = 3,
                   .reply_to = id,
                   .data = {}};
    return pair.fleet.arrive(pair.ant, link, pair.ant.core->table().link(link)->heard + 1, answer);
  };
  for (std::uint64_t guess = 0; guess < 16; ++guess) CHECK(from_cat("ack", first | guess).reason == Errc::not_asked);
  CHECK(from_cat("nack", first | 9U).reason == Errc::not_asked);
  CHECK(from_cat("position", first | 9U).reason == Errc::not_asked);
  CHECK(pair.ant.count("refused.not_asked") == 18);
  CHECK(pair.ant.link_to("cat") == link);
  CHECK(pair.ant.log.back() ==
        "not_asked cat sent position as an answer to what 'mode-adapter' of ant did not ask of it");
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = first | 9U;
  CHECK(pair.come(answer).connection == 1);
  answer.reply_to = first | 8U;  // asked, but not that
  CHECK(pair.come(answer).reason == Errc::not_asked);
}

TEST_CASE("on the bus only the connection that got the question answers it") {
  Pair pair;
  pair.hello(3, "fault-tally", {"tally"});
  const std::uint64_t id = pair.slot(1) << 48U | 77U;
  CHECK(pair.ask(2, id, "ant", "stop").connection == 1);
  const auto from = [&](ConnectionId connection, std::size_t welcome) {
    Message answer{.type = MessageType::information,
                   .subtype = "ack",
                   .source = "ant",
                   .target = "ant",
                   .id = pair.slot(welcome) << 48U | 5U,
                   .reply_to = id,
                   .data = {}};
    const Routing way = pair.ant.core->routing().from_bus(connection, header_of(answer));
    Effects effects;
    if (way.to == To::drop) pair.ant.core->bus().nack(connection, header_of(answer), way.reason, effects);
    pair.fleet.carry_out(pair.ant, effects);
    return way;
  };
  CHECK(from(3, 2).reason == Errc::not_asked);
  CHECK(pair.ant.count("refused.not_asked") == 1);
  CHECK(pair.ant.log.back() ==
        "not_asked service 'fault-tally' (pid 100) said ack as an answer to what 'scheduler' did not ask of it");
  CHECK(pair.nacks() == 0);
  CHECK(from(1, 0).connection == 2);
  CHECK(from(1, 0).connection == 2);
  Message remote = pair.remote("ack", MessageType::information);
  remote.reply_to = id;
  CHECK(pair.come(remote).reason == Errc::not_asked);
}

TEST_CASE("who comes anew has asked nothing; who says hello again still waits") {
  Pair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = id;
  CHECK(pair.ask(2, id, "bee").to == To::peer);
  pair.hello(2, "scheduler", {"baton", "execution_state"});  // its router's answer was slow
  CHECK(pair.slot(2) == pair.slot(1));
  CHECK(pair.come(answer).connection == 2);
  pair.ant.core->on_connection_gone(2, pair.fleet.now, *std::make_unique<Effects>());
  CHECK(pair.come(answer).reason == Errc::no_service);
  // Its slot is given again when 65,535 others have been: whoever has it then has asked nothing.
  for (int i = 0; i < 65'535; ++i) {
    Effects effects;
    pair.ant.core->bus().on_hello(100, {"cli", {}, static_cast<std::uint64_t>(i) + 10, 100, "1"}, kProbe,
                                  pair.fleet.now, effects);
    const auto slot = decode<ServiceWelcome>(std::get<BusSend>(effects.list.at(0)).message.data)->slot;
    REQUIRE(slot != 0);
    if (slot != id >> 48U) continue;
    CHECK(pair.come(answer).reason == Errc::not_asked);
    return;
  }
  FAIL("the slot was not given again");
}

TEST_CASE("a user's information may be Nacked by whom it went to, and is answered by nobody") {
  Pair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  CHECK(pair.ask(2, id, "bee", "greeting", MessageType::information).to == To::peer);
  Message answer = pair.remote("nack", MessageType::information);
  answer.reply_to = id;
  CHECK(pair.come(answer).connection == 2);
  answer.subtype = "ack";
  CHECK(pair.come(answer).reason == Errc::not_asked);
  CHECK(pair.ask(2, id + 1, "bee", "task_progress", MessageType::information).to == To::peer);
  answer.subtype = "nack";
  answer.reply_to = id + 1;
  CHECK(pair.come(answer).reason == Errc::not_asked);
  CHECK(pair.ask(2, id + 2, "*", "greeting", MessageType::information).to == To::every_peer);
  answer.reply_to = id + 2;
  CHECK(pair.come(answer).reason == Errc::not_asked);
}

TEST_CASE("by a relay, too, only whom was asked answers, and not the relay itself") {
  TestFleet fleet;
  for (const char* one : {"ant", "bee", "cat"}) {
    for (const char* other : {"ant", "bee", "cat"}) {
      if (one != other) fleet.cut(one, other);
    }
  }
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("cat", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(5));
  Effects effects;
  ant.core->bus().on_hello(1, {"scheduler", {"baton"}, 5, 100, "1"}, "scheduler", fleet.now, effects);
  const auto slot = decode<ServiceWelcome>(std::get<BusSend>(effects.list.back()).message.data)->slot;
  const std::uint64_t id = static_cast<std::uint64_t>(slot) << 48U | 9U;
  Message stop{.type = MessageType::command, .subtype = "stop", .source = "ant", .target = "bee", .id = id, .data = {}};
  REQUIRE(ant.core->routing().from_bus(1, header_of(stop)).to == To::relay);
  const auto by_relay = [&](const std::string& from, const std::string& subtype) {
    Message answer{.type = MessageType::information,
                   .subtype = subtype,
                   .source = from,
                   .target = "ant",
                   .id = 3,
                   .reply_to = id,
                   .data = {}};
    auto relaying = fleet.at(from).core->relays().wrap(0, "ant", header_of(answer), encode_frame(answer), fleet.now);
    REQUIRE(relaying.ok());
    Effects out;
    out.add(LinkSend{relaying->link, relaying->message});
    fleet.carry_out(fleet.at(from), out);
    fleet.run(Seconds(1));
    return ant.told(subtype);
  };
  CHECK(by_relay("cat", "ack") == 0);
  CHECK(ant.count("refused.not_asked") == 1);
  CHECK(by_relay("bee", "ack") == 1);
  const auto by_cloud = [&](const std::string& subtype) {
    Message answer{.type = MessageType::information,
                   .subtype = subtype,
                   .source = "cloud",
                   .target = "ant",
                   .id = 3,
                   .reply_to = id,
                   .data = {}};
    const LinkId link = ant.link_to("cloud");
    return fleet.arrive(ant, link, ant.core->table().link(link)->heard + 1, answer);
  };
  CHECK(by_cloud("ack").reason == Errc::not_asked);
  CHECK(by_cloud("nack").reason == Errc::not_asked);
  CHECK(cloud.count("refused.not_asked") == 0);
}

TEST_CASE("what was said to every node is not Nacked back by each") {
  Pair pair;
  Effects effects;
  Message word = pair.remote("greeting", MessageType::information);
  word.target = "*";
  pair.ant.core->forwarding().on_undelivered(pair.ant.link_to("bee"), header_of(word), Errc::queue_full, effects);
  CHECK(effects.list.empty());
}

TEST_CASE("a wrong source is refused; a gap in the sequence closes the link") {
  Pair pair;
  Message forged = pair.remote("move");
  forged.source = "cat";
  CHECK(pair.come(forged).reason == Errc::source_mismatch);
  CHECK(pair.ant.count("refused.source_mismatch") == 1);
  const LinkId link = pair.ant.link_to("bee");
  pair.fleet.arrive(pair.ant, link, pair.ant.core->table().link(link)->heard + 2, pair.remote("move"));
  CHECK(pair.ant.count("refused.sequence") == 1);
  CHECK(pair.ant.link_to("bee") == 0);
  pair.fleet.run(Seconds(3));
  CHECK(pair.ant.link_to("bee") != 0);
  CHECK(pair.ant.link_to("bee") == pair.bee.link_to("ant"));
}

TEST_CASE("a Nack answers commands, requests and the user's own information, never an answer or typed information") {
  Pair pair;
  const auto nack = [&](const Message& message) {
    Effects effects;
    pair.ant.core->bus().nack(1, header_of(message), Errc::unknown_target, effects);
    pair.fleet.carry_out(pair.ant, effects);
    return pair.nacks();
  };
  CHECK(nack(pair.local("cat", "move")) == 1);
  CHECK(nack(pair.local("cat", "pose", MessageType::information)) == 2);
  CHECK(nack(pair.local("cat", "task_progress", MessageType::information)) == 2);
  CHECK(nack(pair.local("cat", "nack", MessageType::information)) == 2);
  Message answer = pair.local("cat", "pose", MessageType::information);
  answer.reply_to = 4;
  CHECK(nack(answer) == 2);
  const Message& last = pair.ant.bus.back().message;
  CHECK(last.reply_to == pair.local("cat", "move").id);
  CHECK(decode<Nack>(last.data)->code == "unknown_target");
}

TEST_CASE("who is unknown on the bus says nothing; what a robot says to its own node does not come back to it") {
  Pair pair;
  CHECK(pair.ant.core->routing().from_bus(99, header_of(pair.local("bee", "move"))).reason == Errc::no_service);
  CHECK(pair.route(pair.local("ant", "greeting", MessageType::information)).reason == Errc::no_service);
  Message from_scheduler = pair.local("ant", "greeting", MessageType::information);
  from_scheduler.id = pair.slot(1) << 48U | 3U;
  CHECK(pair.ant.core->routing().from_bus(2, header_of(from_scheduler)).connection == 1);
  // An answer to itself is one.
  Message question = pair.local("ant", "stop", MessageType::command);
  question.id = pair.slot(1) << 48U | 4U;
  CHECK(pair.ant.core->routing().from_bus(2, header_of(question)).connection == 1);
}

TEST_CASE("what comes by a link that is not there, for another node, or too late is refused with the reason") {
  Pair pair;
  Effects effects;
  const Message lost = pair.remote("move");
  const FrameOrders orders = pair.ant.core->forwarding().from_link(4711, header_of(lost, 1, 4711), encode_frame(lost),
                                                                   pair.fleet.now, effects);
  CHECK(orders.way.reason == Errc::unknown_peer_key);
  Message astray = pair.remote("move");
  astray.target = "cat";
  CHECK(pair.come(astray).reason == Errc::unknown_target);
  Message all = pair.remote("greeting", MessageType::information);
  all.target = "*";
  CHECK(pair.come(all).connection == 1);
  Message late = pair.remote("move");
  late.remaining_ms = 0;
  CHECK(pair.come(late).reason == Errc::expired);
  CHECK(pair.ant.count("dropped.expired") == 1);
}

TEST_CASE("a peer is Nacked what it waits for, in its own name, by its own link, and refusals are counted apart") {
  Pair pair;
  const LinkId link = pair.ant.link_to("bee");
  const auto nacked = [&](LinkId by, const Message& message, Errc reason) {
    Effects effects;
    pair.ant.core->forwarding().on_undelivered(by, header_of(message), reason, effects);
    for (const std::string& name : effects.counts) ++pair.ant.counts[name];
    if (effects.list.empty()) return std::string();
    const auto& send = std::get<LinkSend>(effects.list.at(0));
    CHECK(send.link == by);
    CHECK(send.message.reply_to == message.id);
    return decode<Nack>(send.message.data)->code;
  };
  CHECK(nacked(link, pair.remote("move"), Errc::no_service) == "no_service");
  CHECK(nacked(4711, pair.remote("move"), Errc::no_service).empty());
  Message forged = pair.remote("move");
  forged.source = "cat";
  CHECK(nacked(link, forged, Errc::source_mismatch).empty());
  Message nameless = pair.remote("move");
  nameless.id = 0;
  CHECK(nacked(link, nameless, Errc::no_service).empty());
  CHECK(pair.ant.count("dropped.no_service") == 3);
  for (const Errc reason : {Errc::source_mismatch, Errc::not_permitted, Errc::unknown_peer_key, Errc::not_asked}) {
    const std::string name = "refused." + std::string(errc_name(reason));
    const std::uint64_t before = pair.ant.count(name);
    nacked(link, pair.remote("move"), reason);
    CHECK(pair.ant.count(name) == before + 1);
  }
}

TEST_CASE("a service that says what is not its word is named in the log, and what nobody takes is only dropped") {
  Pair pair;
  const auto nack = [&](ConnectionId from, Errc reason) {
    Effects effects;
    pair.ant.log.clear();
    pair.ant.core->bus().nack(from, header_of(pair.local("bee", "execute")), reason, effects);
    pair.fleet.carry_out(pair.ant, effects);
  };
  nack(2, Errc::not_permitted);
  CHECK(pair.ant.count("refused.not_permitted") == 1);
  REQUIRE(pair.ant.log.size() == 1);
  CHECK(pair.ant.log[0] ==
        "not_permitted service 'scheduler' (pid 100) said execute, which is not its word: trb help rights");
  nack(99, Errc::not_permitted);
  CHECK(pair.ant.log.empty());
  nack(2, Errc::unknown_target);
  CHECK(pair.ant.count("dropped.unknown_target") == 1);
  CHECK(pair.ant.log.empty());
}

TEST_CASE("what is an answer, has no number or may be lost has asked nothing") {
  Pair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  Message answer = pair.remote("nack", MessageType::information);
  const auto said = [&](std::uint64_t number, const std::function<void(Message&)>& change) {
    Message message{.type = MessageType::information,
                    .subtype = "greeting",
                    .source = "ant",
                    .target = "bee",
                    .id = number,
                    .data = {}};
    change(message);
    REQUIRE(pair.ant.core->routing().from_bus(2, header_of(message)).to == To::peer);
    answer.reply_to = number;
    return pair.come(answer);
  };
  CHECK(said(id, [](Message&) {}).connection == 2);
  CHECK(said(id + 1, [](Message& message) { message.reply_to = 5; }).reason == Errc::not_asked);
  CHECK(said(id + 2, [](Message& message) { message.flags = kFlagLossy; }).reason == Errc::not_asked);
}
