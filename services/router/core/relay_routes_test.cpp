// Relay routes by themselves: two ends that only a relay links, each with only the relay's link.
#include "services/router/core/relay_routes.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct End : Parts {
  TestKeys relay = relay_keys();
  LocalProfile profile{node, table, messages, errors};
  RelayRoutes routes{node, table, trust, messages, bus, profile, links};
  Link& by = link_with(relay);

  End() { by.relay = true; }
  TestKeys relay_keys() const {
    TestKeys keys = authority.sign_node("cloud", Role::cloud);
    authority.let_relay(keys);
    return keys;
  }
  const Peer& told_of_bee() {
    routes.on_reachable(by, {{bee.record}, {}}, now, out);
    return *table.find("bee");
  }
};

}  // namespace

TEST_CASE(
    "given a relay that says it reaches a member, then this node speaks to it by the relay, but sends nothing yet") {
  End end;
  const Peer& bee = end.told_of_bee();
  CHECK(end.routes.route(bee).relays == std::set<std::string>{"cloud"});
  CHECK(end.routes.relay_of(bee) == nullptr);
  CHECK(end.routes.relayed_peers().empty());
  end.out = {};
  end.pass(std::chrono::milliseconds(300));
  end.routes.tick(end.now, end.out);
  REQUIRE(end.all<LinkSend>().size() == 1);
  CHECK(end.all<LinkSend>()[0].link == end.by.id);
  CHECK(end.all<LinkSend>()[0].message.subtype == Relayed::kSubtype);
  const Message word = make_message(MessageType::command, "ant", "bee", RobotFault{});
  const auto wrapped = end.routes.wrap(1, "bee", header_of(word), encode_frame(word), end.now);
  REQUIRE_FALSE(wrapped);
  CHECK(wrapped.error().code == Errc::peer_unreachable);
}

TEST_CASE("given a node that may not relay, then its word about others is refused") {
  End end;
  end.by.relay = false;
  end.routes.on_reachable(end.by, {{end.bee.record}, {}}, end.now, end.out);
  CHECK(end.table.find("bee") == nullptr);
  CHECK(end.counted("refused.not_permitted") == 1);
}

TEST_CASE("given a message in a peer's name that it has not signed, then it is refused") {
  End end;
  end.told_of_bee();
  RelayedFrame inner;
  inner.target = "ant";
  const SignedRecord forged = sign(kSignedRelayed, "bee", end.authority.fleet.id(), encode(inner), make_signing_key());
  CHECK_FALSE(end.routes.receive(end.by, {forged}, inner, end.now, end.out));
  CHECK(end.counted("refused.relayed_bad_signature") == 1);
}

TEST_CASE("given a peer whose relay is gone, then no relay reaches it") {
  End end;
  const Peer& bee = end.told_of_bee();
  end.routes.on_link_lost(*end.table.find("cloud"), end.by, end.now, end.out);
  CHECK(end.routes.route(bee).relays.empty());
}

TEST_CASE(
    "given peers that are due at different times, then each speaks at its own, and one that is forgotten not at all") {
  End end;
  end.told_of_bee();
  const auto first = end.routes.next_deadline();
  end.pass(std::chrono::milliseconds(100));
  const TestKeys dog = end.authority.sign_node("dog");
  end.routes.on_reachable(end.by, {{dog.record}, {}}, end.now, end.out);
  CHECK(end.routes.next_deadline() == first);
  end.out = {};
  end.now.mono = *first;
  end.routes.tick(end.now, end.out);
  CHECK(end.all<LinkSend>().size() == 1);
  CHECK(end.routes.next_deadline() == *first + std::chrono::milliseconds(100));

  end.table.forget("dog");
  end.routes.tick(end.now, end.out);
  CHECK(end.routes.next_deadline() > *first + std::chrono::milliseconds(100));
}
