// What the doctor asks of routers, and which addresses it tries.
#include "common/operator/doctor/observe.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

Route at(const std::string& id, const std::string& address, const std::string& state = "ONLINE") {
  Route out = route_to(id, Role::robot, state);
  out.address = address;
  return out;
}

Observed fleet() {
  Observed seen;
  seen.routes = {"ant",
                 {at("ant", "10.0.0.1:45000", "self"), at("bee", "10.0.0.2:45000"),
                  at("cow", "10.0.0.3:45000", "OFFLINE"), at("dog", "10.0.0.4:45000")}};
  return seen;
}

struct Doctor {
  FakeNode node;
  std::optional<Observed> seen;
  ObservedNext next = [this](Observed all) { seen = std::move(all); };

  void echo(const std::string& peer, std::size_t size) {
    const auto question = node.take<EchoRequest>(peer);
    CHECK(question.pad.bytes.size() == size);
    node.answer(Echo{question.pad});
  }
};

std::string addresses(const std::vector<AddressProbe>& all) {
  std::string out;
  for (const AddressProbe& one : all) out += one.address + (one.seed ? "*" : "") + " ";
  return out;
}

}  // namespace

TEST_CASE(
    "the router is asked for four tables, and the scheduler for its counters; what it does not tell stays empty") {
  Doctor doctor;
  Observed before;
  before.node = "ant";
  observe_router(doctor.node.session(), before, doctor.next);
  doctor.node.take<RouteListRequest>();
  doctor.node.answer(RouteTable{"ant", {at("ant", "", "self")}});
  doctor.node.take<ServiceListRequest>();
  doctor.node.answer(ServiceTable{});
  doctor.node.take<RunListRequest>();
  doctor.node.refuse(Errc::robot_offline, "no scheduler");
  CHECK(doctor.node.take<ServiceCountersRequest>().service == "scheduler");
  doctor.node.answer(Counters{"ant", "scheduler", {{"late.baton", 1}}});
  doctor.node.take<LinkErrorTableRequest>();
  CHECK_FALSE(doctor.seen);
  doctor.node.pass(kAnswerWait);
  REQUIRE(doctor.seen);
  CHECK(doctor.seen->answers);
  CHECK(doctor.seen->node == "ant");
  CHECK(doctor.seen->routes.routes.size() == 1);
  CHECK(doctor.seen->scheduler.values.size() == 1);
  CHECK(doctor.seen->errors.errors.empty());
}

TEST_CASE("each linked peer echoes small, then large; one that echoes nothing is asked for no more") {
  Doctor doctor;
  observe_links(doctor.node.session(), fleet(), doctor.next);
  doctor.echo("bee", 32);
  doctor.echo("bee", 16'000);
  CHECK(doctor.node.take<EchoRequest>("dog").pad.bytes.size() == 32);
  doctor.node.pass(std::chrono::seconds(3));
  REQUIRE(doctor.seen);
  REQUIRE(doctor.seen->echoes.size() == 2);
  CHECK(doctor.seen->echoes[0].large);
  CHECK_FALSE(doctor.seen->echoes[1].small);
  CHECK(doctor.node.is_quiet());
}

TEST_CASE("no large echo goes where large datagrams are lost, and none to whom was not asked for") {
  Doctor doctor;
  Observed seen = fleet();
  seen.asked = "bee";
  seen.addresses = {{"10.0.0.2:45000", false, true, Port::zmtp, LargeDatagram::lost}};
  observe_links(doctor.node.session(), seen, doctor.next);
  doctor.echo("bee", 32);
  doctor.node.pass(Duration::zero());
  REQUIRE(doctor.seen);
  CHECK(doctor.node.is_quiet());
}

TEST_CASE("the addresses of the table, of seeds, and of what was asked for are tried, each once") {
  const auto near = [](const std::string& address) { return address.starts_with("10.0.0."); };
  Observed seen = fleet();
  CHECK(addresses(addresses_to_try(seen, {"10.0.0.3:45000", "10.9.9.9:45000"}, near)) ==
        "10.0.0.2:45000 10.0.0.3:45000* 10.0.0.4:45000 10.9.9.9:45000* ");
  const auto tried = addresses_to_try(seen, {"10.0.0.2:45000"}, near);
  CHECK(tried[0].port == Port::zmtp);  // it is linked
  CHECK(tried[1].port == Port::not_tried);
  seen.routes.routes[3].via = "bee";
  CHECK(addresses_to_try(seen, {}, near)[2].port == Port::not_tried);
  seen.asked = "10.7.7.7:45000";
  const auto asked = addresses_to_try(seen, {}, near);
  CHECK(addresses(asked) == "10.7.7.7:45000 ");
  CHECK_FALSE(asked[0].own_subnet);
}
