// What the doctor concludes: one story a cause.
#include "common/operator/doctor/diagnosis.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace trb;
using namespace trb::op;

namespace {

constexpr std::int64_t kDay = 86'400'000'000'000;
constexpr std::int64_t kNow = 1'772'366'400'000'000'000;

Route route(const std::string& id, const std::string& state, const std::string& address = "10.0.0.2:45000") {
  Route out;
  out.id = id;
  out.state = state;
  out.address = address;
  out.version = "1.0";
  out.clock = "verified";
  return out;
}

/// The node ant, healthy, linked with bee.
struct Ant {
  Observed seen;
  Ant() {
    seen.node = "ant";
    seen.answers = seen.inbox_open = true;
    seen.now = {kNow};
    seen.own = Certificate{};
    seen.own->id = "ant";
    seen.own->not_before = kNow - kDay;
    seen.own->not_after = kNow + 300 * kDay;
    seen.routes = {"ant", {route("ant", "self", "10.0.0.1:45000"), route("bee", "ONLINE")}};
    seen.addresses = {{"10.0.0.2:45000", false, true, Port::zmtp, LargeDatagram::passed}};
    seen.echoes = {{"bee", true, true}};
  }
  Route& bee() { return seen.routes.routes[1]; }
  AddressProbe& way() { return seen.addresses[0]; }
  /// bee is not linked, and a connection to it showed this.
  void lose_bee(Port port) {
    bee().state = "OFFLINE";
    seen.echoes.clear();
    way().port = port;
  }
  void row(const std::string& peer, const std::string& code, const std::string& text, const std::string& at = "") {
    seen.errors.errors.push_back({peer, at, code, text, 3, 1.0});
  }
  void add_seed(const std::string& address, Port port, bool own_subnet = true) {
    seen.addresses.push_back({address, true, own_subnet, port, LargeDatagram::not_known});
    ++seen.seeds;
  }
};

const Finding* find(const std::vector<Finding>& findings, const std::string& cause, const std::string& subject) {
  const auto at = std::find_if(findings.begin(), findings.end(),
                               [&](const Finding& f) { return f.cause == cause && f.subject == subject; });
  return at == findings.end() ? nullptr : &*at;
}

/// The only problem is this one, and it has a hint.
void check_only(const Observed& seen, const std::string& cause, const std::string& subject) {
  const std::vector<Finding> findings = diagnose(seen);
  CAPTURE(cause);
  const Finding* found = find(findings, cause, subject);
  REQUIRE(found != nullptr);
  CHECK(found->weight == Weight::problem);
  CHECK_FALSE(found->what.empty());
  CHECK_FALSE(found->hint.empty());
  CHECK(std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.weight == Weight::problem; }) ==
        1);
}

/// bee is lost, a connection to it shows `port`, and the router's row of it has that code and text.
void check_lost_bee(Port port, const std::pair<std::string, std::string>& row, const std::string& cause) {
  Ant ant;
  ant.lose_bee(port);
  ant.row("bee", row.first, row.second);
  check_only(ant.seen, cause, "bee");
}

}  // namespace

TEST_CASE("a node that is well has nothing to tell") {
  CHECK(diagnose(Ant().seen).empty());
}

TEST_CASE(
    "a robot's node without a mode-adapter: a problem, or a note where a service of the operator's own may do it") {
  Ant ant;
  ant.seen.has_robot = true;
  ant.seen.named = {"router", "scheduler"};
  check_only(ant.seen, "service_down", "mode-adapter");
  ant.seen.named.emplace_back("own-arm");
  const auto note = diagnose(ant.seen);
  REQUIRE(note.size() == 1);
  CHECK(note[0].weight == Weight::note);
  CHECK(note[0].subject == "mode-adapter");
  Ant seen = ant;  // started elsewhere, it has claimed its name on the bus
  seen.seen.services.services.push_back({.service = "mode-adapter", .state = "up"});
  CHECK(diagnose(seen.seen).empty());
  Ant told = ant;  // something tells of the robot
  told.seen.routes.routes[0].profile.robot = "ONLINE";
  CHECK(diagnose(told.seen).empty());
  ant.seen.has_robot = false;
  CHECK(diagnose(ant.seen).empty());
  ant.seen.has_robot = true;
  ant.seen.named = {"router", "mode-adapter"};
  CHECK(diagnose(ant.seen).empty());
}

TEST_CASE("a wrong key in a seed looks like a router that answers and a handshake that fails") {
  Ant ant;
  ant.add_seed("10.0.0.9:45000", Port::zmtp);
  ant.row("", "failed", "", "10.0.0.9:45000");
  check_only(ant.seen, "wrong_key", "10.0.0.9:45000");
}

TEST_CASE("certificates: ended, ending soon, revoked, of another fleet") {
  Ant ended;
  ended.seen.own->not_after = kNow - 1;
  check_only(ended.seen, "cert_expired", "ant");
  Ant soon;
  soon.seen.own->not_after = kNow + 12 * kDay;
  REQUIRE(diagnose(soon.seen).size() == 1);
  CHECK(diagnose(soon.seen)[0].cause == "cert_ends_soon");
  CHECK(diagnose(soon.seen)[0].weight == Weight::note);
  for (const std::string code : {"cert_expired", "cert_revoked", "foreign_fleet", "bad_signature"}) {
    check_lost_bee(Port::zmtp, {code, "text"}, code);
    check_lost_bee(Port::zmtp, {"refused_us", code}, code);
  }
}

TEST_CASE("a revoked certificate is named: this node's by its router, another's though it has no row any more") {
  Ant own;
  own.row("ant", "own.cert_revoked", "this node's certificate is revoked: stolen");
  check_only(own.seen, "cert_revoked", "ant");
  CHECK(diagnose(own.seen)[0].what == "this node's certificate is revoked: stolen");
  // gateway.key, without which the page does not start, and bus/ are no keys of the certificate.
  CHECK(diagnose(own.seen)[0].hint.find("rm keys/identity.key keys/link.key)") != std::string::npos);
  Ant other;
  other.row("cat", "cert_revoked", "by list 1: stolen");
  check_only(other.seen, "cert_revoked", "cat");
  other.seen.asked = "cat";
  check_only(other.seen, "cert_revoked", "cat");
  Ant lied_to;  // a stranger may send a Hello under any name
  lied_to.row("ant", "cert_revoked", "certificate of 'ant' (serial 1) is revoked by list 1");
  CHECK(diagnose(lied_to.seen).empty());
}

TEST_CASE("a clock that is off is named, this node's own and another's") {
  Ant own;
  own.seen.now = {kNow - 30 * kDay};
  check_only(own.seen, "clock_off", "ant");
  Ant other;
  other.row("bee", "clock_off", "its clock is 3600 s away");
  const auto findings = diagnose(other.seen);
  REQUIRE(find(findings, "clock_off", "bee") != nullptr);
  CHECK(find(findings, "clock_off", "bee")->what == "its clock is 3600 s away");
}

TEST_CASE("versions apart: a note while a link is up, a problem when none can be") {
  Ant linked;
  linked.bee().version = "0.9";
  REQUIRE(diagnose(linked.seen).size() == 1);
  CHECK(diagnose(linked.seen)[0].cause == "versions_apart");
  check_lost_bee(Port::zmtp, {"version_mismatch", "version 2"}, "versions_apart");
}

TEST_CASE("what a connection shows: closed port, silence, another program") {
  const std::pair<Port, std::string> stories[] = {
      {Port::refused, "port_closed"}, {Port::no_answer, "no_answer"}, {Port::not_zmtp, "port_taken"}};
  for (const auto& [port, cause] : stories) {
    Ant ant;
    ant.lose_bee(port);
    check_only(ant.seen, cause, "bee");
  }
}

TEST_CASE("another subnet without a seed: asked for by address, without a route, or reached by a relay") {
  Ant asked;
  asked.seen.asked = "10.9.0.7:45000";
  asked.seen.addresses.push_back({"10.9.0.7:45000", false, false, Port::zmtp, LargeDatagram::not_known});
  check_only(asked.seen, "other_subnet", "10.9.0.7:45000");
  Ant lost;
  lost.lose_bee(Port::no_route);
  lost.way().own_subnet = false;
  check_only(lost.seen, "other_subnet", "bee");
  Ant relayed;
  relayed.bee().via = "cloud";
  relayed.way().own_subnet = false;
  const auto findings = diagnose(relayed.seen);
  REQUIRE(find(findings, "other_subnet", "bee") != nullptr);
  CHECK(find(findings, "other_subnet", "bee")->what.find("cloud") != std::string::npos);
}

TEST_CASE("a one-way link is told apart from silence") {
  check_lost_bee(Port::no_answer, {"one_way", "not heard by the other side for a lease"}, "one_way");
}

TEST_CASE("large messages that are lost mean the MTU: by datagrams, by echoes, by a Hello that never comes") {
  Ant datagrams;
  datagrams.way().large = LargeDatagram::lost;
  check_only(datagrams.seen, "mtu", "bee");
  Ant echoes;
  echoes.seen.echoes[0].large = false;
  check_only(echoes.seen, "mtu", "bee");
  check_lost_bee(Port::zmtp, {"no_hello", "no Hello in time"}, "mtu");
}

TEST_CASE("on the node itself: no router, a socket that is gone, a service that is down, a silent robot") {
  Ant stopped;
  stopped.seen = Observed{};
  stopped.seen.node = "ant";
  stopped.seen.missing_sockets = {"bus/probe.ipc"};
  check_only(stopped.seen, "router_down", "ant");
  Ant cleaned = Ant();
  cleaned.seen.answers = false;
  cleaned.seen.missing_sockets = {"bus/probe.ipc"};
  cleaned.seen.routes = {};
  cleaned.seen.addresses.clear();
  check_only(cleaned.seen, "bus_socket_missing", "bus/probe.ipc");
  cleaned.seen.missing_sockets = {"tcp://10.0.0.1:46000"};
  check_only(cleaned.seen, "bus_socket_missing", "tcp://10.0.0.1:46000");
  cleaned.seen.missing_sockets.clear();
  cleaned.seen.bus_key_refused = true;
  check_only(cleaned.seen, "bus_key", "keys/bus/probe.key");
  Ant service;
  service.seen.services.services = {{"scheduler", "silent", 1, 1, "1.0", 5, 5, {}, {}}};
  check_only(service.seen, "service_down", "scheduler");
  service.seen.services.services = {{"scheduler", "up", 1, 1, "1.0", 5, 0, {}, {}}};
  service.seen.no_runs = fail(Errc::no_service, "it waits: the disk is full", "make room");
  check_only(service.seen, "service_waits", "scheduler");
  // It has told its router, too, and so does every other service.
  service.seen.services.services[0].note = "it waits: the disk is full; make room";
  check_only(service.seen, "service_waits", "scheduler");
  service.seen.no_runs.reset();
  service.seen.services.services = {
      {"resilience", "up", 1, 1, "1.0", 5, 0, {}, "it waits: state/capability.db: permission denied"}};
  check_only(service.seen, "service_waits", "resilience");
  Ant robot;
  robot.seen.routes.routes[0].profile.robot = "OFFLINE";
  robot.seen.routes.routes[0].profile.detail = "connection refused";
  robot.seen.robot = {"192.168.1.20:30002", Port::refused};
  check_only(robot.seen, "robot_silent", "ant");
  robot.seen.routes.routes[0].profile.detail = "closed by the device";
  robot.seen.robot = {"192.168.1.20:502", Port::not_zmtp};
  check_only(robot.seen, "robot_silent", "ant");
  const std::vector<Finding> closed = diagnose(robot.seen);
  const Finding* silent = find(closed, "robot_silent", "ant");
  REQUIRE(silent != nullptr);
  CHECK(silent->hint.find("has it another client") != std::string::npos);
  robot.seen.routes.routes[0].profile.detail = "its poll was answered with 401, the robot refuses the sign-in";
  CHECK(diagnose(robot.seen).at(0).hint.find("sha256sum") != std::string::npos);
  robot.seen.routes.routes[0].profile.detail = "its poll was answered with 403, the robot does not allow it";
  CHECK(diagnose(robot.seen).at(0).hint.find("the right on the robot") != std::string::npos);
  robot.seen.routes.routes[0].profile.detail = "command: TLS: the robot ended the handshake";
  CHECK(diagnose(robot.seen).at(0).hint.find("trb robot certificate") != std::string::npos);
  robot.seen.services.services = {{"mode-adapter", "silent", 1, 1, "1.0", 5, 5, {}, {}}};
  check_only(robot.seen, "service_down", "mode-adapter");
}

TEST_CASE("a fault of the node's files comes with its own cure, and no way to anybody is told") {
  Ant ant;
  ant.seen.faults = {{"network.json", "HOST_INT", "there is no interface 'eth7'", "use eth0"}};
  check_only(ant.seen, "node_folder", "network.json");
  Ant alone;
  alone.seen.beacon = false;
  const std::vector<Finding> dialled = diagnose(alone.seen);  // by bee, as a cloud behind a VPN is
  REQUIRE(dialled.size() == 1);
  CHECK(dialled[0].cause == "no_way");
  CHECK(dialled[0].weight == Weight::note);
  alone.seen.routes.routes.pop_back();
  alone.seen.echoes.clear();
  check_only(alone.seen, "no_way", "node.json");
}

TEST_CASE("asked for one peer, the doctor leaves the others alone") {
  Ant ant;
  ant.seen.routes.routes.push_back(route("cat", "OFFLINE", "10.0.0.3:45000"));
  ant.seen.addresses.push_back({"10.0.0.3:45000", false, true, Port::refused, LargeDatagram::not_known});
  CHECK(diagnose(ant.seen).size() == 1);
  ant.seen.asked = "bee";
  CHECK(diagnose(ant.seen).empty());
  ant.seen.asked = "dog";
  check_only(ant.seen, "never_heard", "dog");
}

TEST_CASE("strangers: a named one that is kept out is a problem, a foreign beacon a note, an old event nothing") {
  Ant ant;
  ant.row("dog", "foreign_fleet", "certificate of 'dog' is of another fleet");
  ant.row("", "beacon.foreign_fleet", "beacon of another fleet");
  ant.row("", "beacon.wrong_key", "beacon under another key number");
  const auto findings = diagnose(ant.seen);
  REQUIRE(findings.size() == 3);
  CHECK(findings[0].subject == "dog");
  CHECK(findings[0].weight == Weight::problem);
  CHECK(find(findings, "foreign_fleet", "a beacon")->weight == Weight::note);
  CHECK(find(findings, "old_beacon_key", "a beacon") != nullptr);
  for (LinkErrorRow& row : ant.seen.errors.errors) row.last_s = 1000;
  CHECK(diagnose(ant.seen).empty());
}

TEST_CASE("a seed that is a host's name: a name server that is silent is named, and a host that does not answer") {
  Ant ant;
  ant.add_seed("hub.example:45000", Port::not_tried);
  CHECK(diagnose(ant.seen).empty());  // linked: nothing is wrong with it
  SUBCASE("silent") {
    ant.row("", "no_name", "the name server has not answered for hub.example yet: look", "hub.example:45000");
    const auto findings = diagnose(ant.seen);
    const Finding* finding = find(findings, "no_name", "hub.example:45000");
    REQUIRE(finding != nullptr);
    CHECK(finding->what == "the name server has not answered for hub.example yet: look");
  }
  SUBCASE("found, but nobody there") {
    ant.row("", "failed", "the dial ended before a Hello was heard", "hub.example:45000");
    CHECK(find(diagnose(ant.seen), "no_answer", "hub.example:45000") != nullptr);
  }
}

TEST_CASE("faults that stand and robots that are retired: a problem of the own robot, a note of others") {
  Ant ant;
  ant.seen.routes.routes[0].profile.out_of_use = {{"grab", trb::Severity::critical, "gripper jammed", kNow, false, ""}};
  ant.bee().profile.out_of_use = {{"", trb::Severity::fatal, "its journal was lost", kNow, false, "scheduler"},
                                  {"", trb::Severity::critical, "new wheels", kNow, true, "ann"}};
  const auto findings = diagnose(ant.seen);
  const Finding* own = find(findings, "fault_stands", "ant");
  REQUIRE(own != nullptr);
  CHECK(own->weight == Weight::problem);
  CHECK(own->what.find("'grab' is out of use") == 0);
  CHECK(own->hint.find("--capability grab") != std::string::npos);
  const Finding* other = find(findings, "fault_stands", "bee");
  REQUIRE(other != nullptr);
  CHECK(other->weight == Weight::note);
  const Finding* retired = find(findings, "robot_retired", "bee");
  REQUIRE(retired != nullptr);
  CHECK(retired->hint == "trb robot return bee");
}

TEST_CASE("a scheduler that is nearly full of runs") {
  Ant ant;
  ant.seen.runs.open_max = 100;
  ant.seen.runs.open = 90;
  CHECK(diagnose(ant.seen).empty());
  ant.seen.runs.open = 91;
  CHECK(find(diagnose(ant.seen), "runs_full", "ant") != nullptr);
}

TEST_CASE("what a scheduler should never count is told, and what it counts every day is not") {
  Ant ant;
  ant.seen.scheduler = {"ant", "scheduler", {{"late.baton", 7}, {"double_execution", 0}}};
  CHECK(diagnose(ant.seen).empty());
  ant.seen.scheduler.values = {{"double_choice", 1}, {"double_execution", 2}, {"late.baton", 7}};
  const auto findings = diagnose(ant.seen);
  REQUIRE(findings.size() == 2);
  const Finding* done_twice = find(findings, "double_execution", "ant");
  REQUIRE(done_twice != nullptr);
  CHECK(done_twice->weight == Weight::note);
  CHECK(done_twice->what.find("(2 since") != std::string::npos);
  CHECK(find(findings, "double_choice", "ant") != nullptr);
}
