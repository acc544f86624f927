// node.json's "bus": sockets in the folder, or an address.
#include <doctest/doctest.h>

#include "common/config/interfaces.hpp"
#include "common/security/bus_keys.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

/// A robot's folder with this text as its bus.
struct Node {
  NodeFolder folder;
  explicit Node(const std::string& bus) {
    folder.change("node.json", R"("seeds": [])", R"("seeds": [], "bus": )" + bus);
  }
  std::string fault() const {
    const ConfigFaults faults = without_keys(folder.check().faults);
    return faults.empty() ? "" : faults[0].key + ": " + faults[0].what;
  }
};

}  // namespace

TEST_CASE("the bus is sockets in the node's folder, or an address and a port") {
  CHECK(NodeFolder().check().config.bus.empty());
  CHECK(*read_bus(NodeFolder().path()) == "");
  CHECK(Node(R"("ipc")").folder.check().config.bus.empty());
  const Node v4(R"("tcp://127.0.77.1:46000")");
  CHECK(v4.fault().empty());
  CHECK(v4.folder.check().config.bus == "127.0.77.1:46000");
  CHECK(*read_bus(v4.folder.path()) == "127.0.77.1:46000");
  CHECK(bus_names(v4.folder.check().config) ==
        std::vector<std::string>{"router", "mode-adapter", "scheduler", "probe"});
  CHECK(Node(R"("tcp://[::1]:46000")").folder.check().config.bus == "[::1]:46000");
}

TEST_CASE("what is no such bus is refused with its cure") {
  for (const char* bad : {"\"tcp\"", "\"udp://127.0.0.1:1\"", "\"tcp://127.0.0.1\"", "\"tcp://127.0.0.1:0\"",
                          "\"tcp://127.0.0.1:65535\"", "\"tcp://router:46000\"", "\"tcp://0.0.0.0:46000\"",
                          "\"tcp://[::]:46000\"", "\"tcp://fd00::1:46000\"", "46000"}) {
    CAPTURE(bad);
    const Node node(bad);
    CHECK(node.fault().starts_with("bus: "));
    CHECK(read_bus(node.folder.path()).error().code == Errc::bad_value);
  }
  CHECK(read_bus("/nowhere").error().code == Errc::missing);
}

TEST_CASE("a bus at an address that is not here yet is told, and may be waited for") {
  const Node away(R"("tcp://192.0.2.1:46000")");
  CHECK(away.fault().empty());  // if the node is up, no port is tried
  const ConfigFaults faults = without_keys(away.folder.check(false).faults);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "bus");
  CHECK(faults_that_stop(faults).empty());
}

TEST_CASE("the D-Bus is the system's, the session's or a socket's address") {
  const auto with = [](const std::string& dbus) {
    NodeFolder folder;
    folder.change("node.json", R"("seeds": [])", R"("seeds": [], "dbus": )" + dbus);
    return folder.check();
  };
  CHECK(NodeFolder().check().config.dbus == "system");
  for (const char* good : {"session", "unix:path=/run/robot/bus"}) {
    const NodeCheck check = with("\"" + std::string(good) + "\"");
    CHECK(without_keys(check.faults).empty());
    CHECK(check.config.dbus == good);
  }
  for (const char* bad : {"\"\"", "\"user\"", "\"unix:path=\"", "\"unix:path=bus\"", "\"tcp:host=a,port=1\"",
                          "\"unix:path=/a;unix:path=/b\"", "7"}) {
    CAPTURE(bad);
    const ConfigFaults faults = without_keys(with(bad).faults);
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].key == "dbus");
  }
  const auto of = [&](std::size_t size, const std::string& end) {
    return without_keys(with("\"unix:path=/" + std::string(size - 1 - end.size(), 'x') + end + "\"").faults);
  };
  CHECK(of(107, "").empty());
  CHECK(of(109, "%20").empty());  // a blank is one byte of the path
  REQUIRE(of(108, "").size() == 1);
  CHECK(of(108, "")[0].what.find("too long for a socket") != std::string::npos);
}

TEST_CASE("an address is taken apart only if it is one") {
  CHECK(split_endpoint("10.0.0.1:46000").host == "10.0.0.1");
  CHECK(split_endpoint("[fd00::1]:46000").host == "fd00::1");
  CHECK(split_endpoint("[fd00::1]:46000").port == 46000);
  for (const char* bad : {"", ":", "10.0.0.1", "10.0.0.1:", "10.0.0.1:x", "10.0.0.1:70000", "fd00::1:46000",
                          "[10.0.0.1]:1", "host:1", "[]:1"}) {
    CAPTURE(bad);
    CHECK(split_endpoint(bad).host.empty());
  }
}
