// The road of a message: where it goes, who is refused, who is told.
#include <doctest/doctest.h>

#include "services/router/core/test_fleet.hpp"

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
    ant.core->on_service_hello(from, {service, std::move(subtypes), 5, 100, "1"},
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
  Routing route(const Message& message) { return ant.core->route_local(1, header_of(message)); }
  Routing come(const Message& message) {
    const LinkId link = ant.link_to("bee");
    return fleet.arrive(ant, link, ant.core->find_link(link)->heard + 1, message);
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
  CHECK(pair.come(answer).connection == 2);
  answer.reply_to = (pair.slot(1) + 1) << 48U | 4U;
  CHECK(pair.come(answer).reason == Errc::no_service);
}

TEST_CASE("a wrong source is refused; a gap in the sequence closes the link") {
  Pair pair;
  Message forged = pair.remote("move");
  forged.source = "cat";
  CHECK(pair.come(forged).reason == Errc::source_mismatch);
  CHECK(pair.ant.count("refused.source_mismatch") == 1);
  const LinkId link = pair.ant.link_to("bee");
  pair.fleet.arrive(pair.ant, link, pair.ant.core->find_link(link)->heard + 2, pair.remote("move"));
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
    pair.ant.core->nack_local(1, header_of(message), Errc::unknown_target, effects);
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
