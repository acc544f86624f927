// Where a message goes, and what is refused for which reason.
#include "services/router/test/test_pair.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a message that cannot go out is refused with the reason") {
  RoutedPair pair;
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
  pair.fleet.run(kStep);
  CHECK(pair.route(pair.local("bee", "move")).reason == Errc::peer_unreachable);
  pair.fleet.run(Seconds(11));
  CHECK(pair.route(pair.local("bee", "move")).reason == Errc::peer_expired);
}

TEST_CASE("an unclaimed word of the user's goes to the mode-adapter, an unclaimed typed one to nobody") {
  RoutedPair pair;
  CHECK(pair.come(pair.remote("move")).connection == 1);
  CHECK(pair.come(pair.remote("baton")).connection == 2);
  CHECK(pair.come(pair.remote("run_query", MessageType::request)).reason == Errc::no_service);
}

TEST_CASE("a peer may not use what is between services of one node, nor bring it as an answer") {
  RoutedPair pair;
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

TEST_CASE("a wrong source is refused; a gap in the sequence closes the link") {
  RoutedPair pair;
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

TEST_CASE("who is unknown on the bus says nothing; what a robot says to its own node does not come back to it") {
  RoutedPair pair;
  CHECK(pair.ant.core->routing().from_bus(99, header_of(pair.local("bee", "move"))).reason == Errc::no_service);
  CHECK(pair.route(pair.local("ant", "greeting", MessageType::information)).reason == Errc::no_service);
  Message from_scheduler = pair.local("ant", "greeting", MessageType::information);
  from_scheduler.id = pair.slot(1) << 48U | 3U;
  CHECK(pair.ant.core->routing().from_bus(2, header_of(from_scheduler)).connection == 1);
  // A command of the scheduler goes there too.
  Message question = pair.local("ant", "stop", MessageType::command);
  question.id = pair.slot(1) << 48U | 4U;
  CHECK(pair.ant.core->routing().from_bus(2, header_of(question)).connection == 1);
}

TEST_CASE("what comes by a link that is not there, for another node, or too late is refused with the reason") {
  RoutedPair pair;
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
