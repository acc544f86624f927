#include <doctest/doctest.h>

#include "common/config/interfaces.hpp"
#include "common/security/node_keys.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;

TEST_CASE("a robot's node in the interpreter mode") {
  const NodeFolder folder;
  folder.sign("r1", Role::robot);
  const NodeCheck check = folder.check();
  REQUIRE(to_text(check.faults) == "");
  const NodeConfig& config = check.config;
  CHECK(config.dir == folder.path());
  CHECK(config.id == "r1");
  CHECK(config.role == Role::robot);
  CHECK(config.framework == "lines");
  CHECK(config.mode == Mode::interpreter);
  CHECK(config.robot.host == "127.0.77.9");
  CHECK(config.beacon);
  CHECK(config.has_service("mode-adapter"));
  CHECK_FALSE(config.has_service("resilience"));
  CHECK(config.network.udp_port == 50000);
  CHECK(config.network.tcp_port_ext == 45000);
  CHECK(config.network.tcp_port == 40000);
  CHECK(config.network.address == "127.0.77.1");
  CHECK(config.network.broadcast == "127.255.255.255");
  CHECK(config.network.robot_address == "127.0.0.1");
  CHECK(config.places.at("dock").y == 2);
  CHECK(config.description.find_skill("go") != nullptr);
  CHECK(config.commands.commands.empty());
}

TEST_CASE("a robot's node in the direct mode has its vendor's words") {
  const NodeFolder folder("ur");
  const NodeCheck check = folder.check();
  REQUIRE(to_text(without_keys(check.faults)) == "");
  CHECK(check.config.mode == Mode::direct);
  const VendorCommands& words = check.config.commands;
  CHECK(words.port == 30002);
  CHECK(words.transport == "tcp-text");
  CHECK(words.language == "urscript");
  CHECK(words.wrap == "urscript-program");
  CHECK(words.commands.at("move") == "movej({data})");
  CHECK(words.commands.at("release").empty());
  CHECK(words.requests.at("position") == "joints");
  CHECK(words.monitor->port == 30001);
}

TEST_CASE("the cloud's node has no robot, and needs no file about one") {
  const NodeFolder folder("cloud");
  folder.sign("cloud", Role::cloud);
  const NodeCheck check = folder.check();
  REQUIRE(to_text(check.faults) == "");
  CHECK(check.config.role == Role::cloud);
  CHECK(check.config.mode == Mode::none);
  CHECK(check.config.framework.empty());
  CHECK_FALSE(check.config.has_service("mode-adapter"));
}

TEST_CASE("what need not be said") {
  const NodeFolder folder;
  folder.write("node.json", R"({"id":"r1","framework":"lines","description":")" + folder.path() + R"(/robots/r.json",
                               "robot":{"host":"127.0.77.9"}})");
  folder.write("network.json", R"({"HOST_INT": "127.0.77.1"})");
  folder.remove("commands.json");
  const NodeCheck check = folder.check();
  REQUIRE(to_text(without_keys(check.faults)) == "");
  CHECK(check.config.services == std::vector<std::string>{"router", "mode-adapter", "scheduler"});
  CHECK(check.config.network.robot_address == "127.0.77.1");
  CHECK(check.config.network.tcp_port_ext == 45000);
  CHECK(check.config.description.maker == "m");
}

TEST_CASE("seeds: an address and a key") {
  const NodeFolder folder;
  const std::string key(64, 'a');
  folder.change("node.json", R"("seeds": [])", R"("seeds": [{"address": "10.0.0.1:45000", "key": ")" + key + "\"}]");
  const NodeCheck check = folder.check();
  REQUIRE(to_text(without_keys(check.faults)) == "");
  CHECK(check.config.seeds.at(0).address == "10.0.0.1:45000");
  CHECK(check.config.seeds.at(0).key == std::string(32, '\xaa'));
}

TEST_CASE("keys: missing, for another id, for another role") {
  const NodeFolder folder;
  CHECK(to_text(folder.check().faults).starts_with("keys"));
  folder.sign("r2", Role::cloud);
  const ConfigFaults faults = folder.check().faults;
  REQUIRE_FALSE(faults.empty());
  CHECK(faults[0].file == "keys/certificate.json");
  const NodeFolder other;
  other.sign("r1", Role::cloud);
  const ConfigFaults roles = other.check().faults;
  REQUIRE_MESSAGE(roles.size() == 1, to_text(roles));
  CHECK(roles[0].key == "role");
}

TEST_CASE("keys: a service in a container of its own has the certificate and no secret of its node") {
  NodeFolder folder;
  folder.sign("r1", Role::robot);
  const auto put_apart = [&] {
    for (const char* secret : {"keys/identity.key", "keys/link.key"}) folder.remove(secret);
  };
  SUBCASE("its bus is an address") {
    folder.change("node.json", R"("seeds": [])", R"("seeds": [], "bus": "tcp://127.0.77.1:46000")");
    put_apart();
    CHECK(to_text(folder.check().faults) == "");
    CHECK_FALSE(folder.check(false).faults.empty());  // trb up starts the router, too
    folder.remove("keys/certificate.json");
    CHECK(to_text(folder.check().faults).starts_with("keys"));
  }
  SUBCASE("its bus is sockets in the folder: there is no container of its own") {
    put_apart();
    CHECK(to_text(folder.check().faults).starts_with("keys"));
  }
}

TEST_CASE("interfaces: names and addresses of this machine") {
  const std::vector<Interface> known = interfaces();
  REQUIRE_FALSE(known.empty());
  CHECK(resolve_interface("lo", known).address == "127.0.0.1");
  CHECK(resolve_interface("127.3.2.1", known).address == "127.3.2.1");
  CHECK(resolve_interface("127.3.2.1", known).broadcast == "127.255.255.255");
  for (const Interface& one : known) {
    if (one.up && !one.address.empty()) CHECK(resolve_interface(one.address, known).address == one.address);
  }
}

TEST_CASE("interfaces: what cannot be used says why") {
  const std::vector<Interface> known = {{"eth0", "10.0.0.5", "10.0.0.255", true},
                                        {"eth1", "", "", true},
                                        {"eth2", "10.0.1.5", "10.0.1.255", false},
                                        {"tun0", "10.8.0.2", "", true}};
  CHECK(resolve_interface("eth0", known).broadcast == "10.0.0.255");
  CHECK(resolve_interface("10.0.0.5", known).address == "10.0.0.5");
  CHECK(resolve_interface("tun0", known).broadcast.empty());
  CHECK(resolve_interface("eth1", known).what.find("has no address") != std::string::npos);
  CHECK(resolve_interface("eth2", known).what.find("is down") != std::string::npos);
  CHECK(resolve_interface("127.255.255.255", known).what.find("no address of one node") != std::string::npos);
  const Resolved missing = resolve_interface("10.0.0.6", known);
  CHECK(missing.what == "there is no interface or address '10.0.0.6' here");
  CHECK(missing.hint == "use one of: eth0 (10.0.0.5), eth1 (no address), eth2 (10.0.1.5, down), tun0 (10.8.0.2)");
  CHECK(resolve_interface("Wi-Fi", known).hint.find("usually 'eth0'") != std::string::npos);
}

TEST_CASE("interfaces: IPv6 where there is no IPv4, link-local addresses last, beacons to the group") {
  const std::vector<Interface> known = {{"eth0", "10.0.0.5", "10.0.0.255", true},
                                        {"eth0", "fd00::5", "ff12::7262:6561%eth0", true},
                                        {"eth1", "fd01::5", "ff12::7262:6561%eth1", true},
                                        {"eth1", "fe80::5%eth1", "ff12::7262:6561%eth1", true}};
  CHECK(resolve_interface("eth0", known).address == "10.0.0.5");
  CHECK(resolve_interface("fd00::5", known).broadcast == "ff12::7262:6561%eth0");
  CHECK(resolve_interface("eth1", known).address == "fd01::5");
  CHECK(resolve_interface("fe80::5", known).address == "fe80::5%eth1");
  CHECK(resolve_interface("fd09::9", known).what.find("no interface or address") != std::string::npos);
  CHECK_FALSE(resolve_interface("fd09::9", known).may_come);
  CHECK(resolve_interface("tun0", known).may_come);
  CHECK_FALSE(resolve_interface("Wi-Fi", known).may_come);
}

TEST_CASE("an address as it is written: with a port, without a scope, with this machine's own") {
  CHECK(join_host_port("10.0.0.1", 45000) == "10.0.0.1:45000");
  CHECK(join_host_port("fd00::1", 45000) == "[fd00::1]:45000");
  CHECK(without_scope("fe80::1%eth0") == "fe80::1");
  CHECK(with_scope("[fe80::1]:45000", "eth1") == "[fe80::1%eth1]:45000");
  CHECK(with_scope("[fe80::1%en7]:45000", "eth1") == "[fe80::1%eth1]:45000");
  CHECK(with_scope("fe80::1", "eth1") == "fe80::1%eth1");
  CHECK(with_scope("[fd00::1]:45000", "eth1") == "[fd00::1]:45000");
  CHECK(with_scope("10.0.0.1:45000", "eth1") == "10.0.0.1:45000");
}

TEST_CASE("an interface that is not there yet is a fault that may wait; what else is wrong may not") {
  const NodeFolder folder;
  folder.change("network.json", "127.0.77.1", "tun77");
  NodeCheck check = folder.check();
  REQUIRE(without_keys(check.faults).size() == 1);
  CHECK(faults_that_stop(without_keys(check.faults)).empty());
  CHECK(check.config.network.waits_for.find("tun77") != std::string::npos);
  folder.change("node.json", R"("beacon": true)", R"("beacon": 1)");
  check = folder.check();
  CHECK(faults_that_stop(without_keys(check.faults)).size() == 1);
}

TEST_CASE("seeds: IPv6 in square brackets; the cloud relays unless it is told not to") {
  const NodeFolder folder;
  const std::string key(64, 'a');
  folder.change("node.json", R"("seeds": [])", R"("seeds": [{"address": "[fd00::1]:45000", "key": ")" + key + "\"}]");
  const NodeCheck check = folder.check();
  REQUIRE(to_text(without_keys(check.faults)) == "");
  CHECK(check.config.seeds.at(0).address == "[fd00::1]:45000");
  CHECK_FALSE(check.config.relay);
  folder.change("node.json", "[fd00::1]", "[fd00::zz]");
  CHECK(without_keys(folder.check().faults).size() == 1);
  CHECK(NodeFolder("cloud").check().config.relay);
}

TEST_CASE("who speaks to no robot takes a maker's words as they are") {
  const NodeFolder folder("ur");
  folder.change("commands.json", "\"urscript\"", "\"a language of tomorrow\"");
  CHECK_FALSE(without_keys(folder.check().faults).empty());
  const NodeCheck check = check_node_dir(folder.path(), true);
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.commands.language == "a language of tomorrow");
}
