// Requests and their outcomes; the Nacks' errors; the routing table in pages.
#include "common/operator/session.hpp"

#include "common/operator/nack_error.hpp"
#include "common/operator/routes.hpp"
#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

TEST_CASE("a request is answered by the node that it was for") {
  FakeNode node;
  Ending<Message> ending;
  node.session().command("ur3", Stop{"x"}, ending);
  CHECK(node.take<Stop>("ur3").reason == "x");
  // An answer from another node, or to another message, does not count.
  CHECK_FALSE(node.answer(node.taken(), "belt", Ack{"stopped", ""}));
  CHECK_FALSE(node.answer(node.taken() + 1, "ur3", Ack{"stopped", ""}));
  CHECK_FALSE(ending.has_come());
  CHECK(node.answer(Ack{"stopped", ""}));
  CHECK(ending.value().source == "ur3");
  // A second answer does not count, either.
  CHECK_FALSE(node.answer(Ack{"stopped", ""}));
  CHECK_FALSE(node.session().next_deadline());
}

TEST_CASE("a request that nobody answers ends with its deadline") {
  FakeNode node;
  Ending<RunView> ending;
  node.session().ask_node<RunView>(RunQuery{"3f2a"}, ending, std::chrono::seconds(2));
  node.take<RunQuery>();
  node.pass(std::chrono::milliseconds(1999));
  CHECK_FALSE(ending.has_come());
  node.pass(std::chrono::milliseconds(1));
  CHECK(ending.error().code == Errc::timeout);
  CHECK(ending.error().what == "no answer from 'ant' to run_query");
  CHECK_FALSE(node.answer(RunView{}));
}

TEST_CASE("a message's deadline is the time for which its sender waits") {
  FakeNode node;
  const auto deadline = [&](Duration wait, std::uint32_t remaining_ms = kDefaultRemainingMs) {
    const Send send{
        .type = MessageType::command, .target = "ant", .remaining_ms = remaining_ms, .body = Release{"clear"}};
    REQUIRE(node.session().send(send, wait, [](const Message*) {}).ok());
    return node.take_send("ant").remaining_ms;
  };
  CHECK(deadline(std::chrono::seconds(3)) == 3000);
  CHECK(deadline(std::chrono::seconds(3), 300) == 300);
  CHECK(deadline(std::chrono::hours(100'000)) == kDefaultRemainingMs);
  CHECK(deadline(Duration::zero()) == 1);
}

TEST_CASE("a request that cannot be sent fails, but not before the caller has gone on") {
  FakeNode node;
  node.close();
  Ending<Message> ending;
  node.session().command("ur3", Stop{}, ending);
  CHECK_FALSE(ending.has_come());
  node.pass(Duration::zero());
  CHECK(ending.error().code == Errc::queue_full);
}

TEST_CASE("a Nack is the request's error, with its own cure or the usual one") {
  FakeNode node;
  Ending<Message> ending;
  node.session().command("ur3", Stop{}, ending);
  node.take<Stop>("ur3");
  CHECK(node.refuse(Errc::fenced, "ur3 is stopped"));
  CHECK(ending.error().code == Errc::fenced);
  CHECK(ending.error().what == "ur3 is stopped");
  CHECK(ending.error().hint == "trb release ROBOT lifts the fence");
  CHECK(nack_error({"fenced", "", "", "x", "do this"}).hint == "do this");
  const Error newer = nack_error({"of_tomorrow", "", "", "x", ""});
  CHECK(newer.code == Errc::bad_value);
  CHECK(newer.what == "of_tomorrow: x");
}

TEST_CASE("what is due later comes in its order, and what it begins comes after it") {
  FakeNode node;
  std::string order;
  node.session().after(std::chrono::seconds(2), [&] { order += "b"; });
  node.session().after(std::chrono::seconds(1), [&] {
    order += "a";
    node.session().after(Duration::zero(), [&] { order += "c"; });
  });
  node.pass(std::chrono::milliseconds(999));
  CHECK(order.empty());
  node.pass(std::chrono::seconds(3));
  CHECK(order == "acb");
}

TEST_CASE("the routing table is asked for page after page") {
  FakeNode node;
  Ending<RouteTable> ending;
  request_routes(node.session(), ending);
  CHECK(node.take<RouteListRequest>().after.empty());
  node.answer(RouteTable{"ant", {route_to("ant", Role::robot, "self"), route_to("bee")}, true, ""});
  CHECK(node.take<RouteListRequest>().after == "bee");
  SUBCASE("the last page ends it") {
    node.answer(RouteTable{"ant", {route_to("cloud", Role::cloud)}, false, "bee"});
    CHECK(ending.value().routes.size() == 3);
    CHECK(robots_of(ending.value()) == std::vector<std::string>{"ant", "bee"});
  }
  SUBCASE("another page than was asked for is an error") {
    node.answer(RouteTable{"ant", {route_to("cloud", Role::cloud)}, false, "zebra"});
    CHECK(ending.error().code == Errc::conflict);
  }
}
