// A preflight: who is asked, what is said of those that are not ready.
#include "common/operator/preflight.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

RouteTable hall_with(const Route& cart1) {
  return {"ant", {route_to("ant", Role::robot, "self"), cart1, route_to("cloud", Role::cloud)}};
}

struct Asker {
  FakeNode node;
  Ending<Preflight> done;

  explicit Asker(const Route& cart1) {
    Task go;
    go.id = "t1";
    go.robot = "cart1";
    go.skill = "go_to";
    go.data = R"({"place":"dock"})";
    preflight(node.session(), {"n", "", {go}}, "s.json", done);
    node.take<RouteListRequest>();
    node.answer(hall_with(cart1));
    node.pass(Duration::zero());
  }
  const RobotPreflight& robot() { return done.value().robots.at(0); }
};

}  // namespace

TEST_CASE("a robot that is stopped is asked all the same: that it answers is no question of being ready") {
  Route stopped = cart("cart1");
  stopped.profile.fenced = true;
  Asker asker(stopped);
  asker.node.take<Opaque>("cart1");
  SUBCASE("it answers") {
    asker.node.answer(Opaque{"battery", "80"});
    CHECK(asker.robot().asked);
    CHECK(asker.robot().answers);
    CHECK(asker.robot().why == std::vector<std::string>{"it is stopped until it is released"});
  }
  SUBCASE("it does not") {
    asker.node.pass(std::chrono::seconds(3));
    CHECK_FALSE(asker.robot().answers);
    CHECK(asker.robot().why.size() == 2);
  }
  CHECK_FALSE(asker.done.value().is_ready());
}

TEST_CASE("a robot that is not connected is not asked") {
  Route away = cart("cart1");
  away.profile.robot = "CONNECTION_BROKEN";
  Asker asker(away);
  CHECK_FALSE(asker.robot().asked);
  CHECK_FALSE(asker.robot().answers);
  CHECK(asker.robot().why == std::vector<std::string>{"it is CONNECTION_BROKEN"});
}
