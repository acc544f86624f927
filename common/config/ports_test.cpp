// The ports of a node's folder: a taken one is told before the node starts, with the key that names it.
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

/// The only fault of a node that does not run yet, apart from the missing keys.
ConfigFault fault_at_start(const NodeFolder& folder) {
  const ConfigFaults faults = without_keys(folder.check(false).faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0];
}

/// Listens on a free port of 127.0.77.1 as long as it lives.
class Listener {
 public:
  Listener() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    inet_pton(AF_INET, "127.0.77.1", &where.sin_addr);
    socklen_t size = sizeof where;
    REQUIRE(::bind(fd_, reinterpret_cast<sockaddr*>(&where), size) == 0);
    REQUIRE(::listen(fd_, 1) == 0);
    REQUIRE(::getsockname(fd_, reinterpret_cast<sockaddr*>(&where), &size) == 0);
    port_ = ntohs(where.sin_port);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { ::close(fd_); }
  [[nodiscard]] std::string port() const { return std::to_string(port_); }

 private:
  int fd_;
  std::uint16_t port_ = 0;
};

}  // namespace

TEST_CASE("a port in use") {
  const Listener listener;
  const NodeFolder folder;
  folder.change("network.json", "45000", listener.port());
  const ConfigFaults before = without_keys(folder.check(true).faults);
  CHECK_MESSAGE(before.empty(), to_text(before));
  folder.change("node.json", R"(, "interface": "lo")", "");
  folder.change("node.json", R"("mode-adapter", )", "");
  const ConfigFault fault = fault_at_start(folder);
  CHECK(fault.file == "network.json");
  CHECK(fault.key == "TCP_PORT_EXT");
  CHECK(fault.what == "TCP 127.0.77.1:" + listener.port() + " is in use by another program");
}

TEST_CASE("the robot's port is tried only where a mode-adapter will bind it") {
  const Listener listener;
  const Listener free_once;  // reserves its number while it exists
  const NodeFolder folder;
  folder.change("node.json", R"(, "interface": "lo")", "");
  folder.change("network.json", "40000", listener.port());
  folder.change("network.json", "127.0.77.1", "127.0.77.1");
  CHECK(fault_at_start(folder).key == "TCP_PORT");
  folder.change("node.json", R"("mode-adapter", )", "");
  CHECK(without_keys(folder.check(false).faults).empty());
}

TEST_CASE("cloud.json: where the page listens is tried like the other ports, if the node has the page") {
  const Listener other;
  const NodeFolder folder("cloud");
  const std::string taken = R"({"listen": "127.0.77.1:)" + other.port() + "\"}";
  folder.write("cloud.json", taken);
  CHECK(without_keys(folder.check(false).faults).empty());
  folder.write("node.json", R"({"id":"cloud","role":"cloud","services":["router","cloud-gateway"]})");
  CHECK(without_keys(folder.check(true).faults).empty());
  const ConfigFault fault = fault_at_start(folder);
  CHECK(fault.file == "cloud.json");
  CHECK(fault.key == "listen");
  CHECK(fault.what.find("is in use by another program") != std::string::npos);
  CHECK_FALSE(fault.may_wait);
  // An address of a VPN, perhaps, that comes later.
  folder.write("cloud.json", R"({"listen": "203.0.113.77:9443"})");
  CHECK(fault_at_start(folder).what.find("the address is not ready") != std::string::npos);
  CHECK(fault_at_start(folder).may_wait);
}

TEST_CASE("metrics.json: the node's own ports are no place for its metrics") {
  const NodeFolder folder;
  for (const auto& [port, key] : {std::pair{"45000", "TCP_PORT_EXT"}, {"45001", "LANE_PORT"}}) {
    folder.write("metrics.json", std::string(R"({"listen": "127.0.77.1:)") + port + "\"}");
    const ConfigFaults faults = without_keys(folder.check(true).faults);
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().file == "metrics.json");
    CHECK(faults.front().key == "listen");
    CHECK(faults.front().what == std::string("127.0.77.1:") + port + " is this node's own " + key + " of network.json");
  }
  folder.write("metrics.json", R"({"listen": "127.0.77.1:9464"})");
  CHECK(without_keys(folder.check(true).faults).empty());
}

TEST_CASE("metrics.json: the ports of the robot, the bus and the page are none for its metrics either") {
  const auto why_not = [](const NodeFolder& folder, const std::string& listen) {
    folder.write("metrics.json", R"({"listen": ")" + listen + "\"}");
    const ConfigFaults faults = folder.check(true).faults;
    const auto at = std::ranges::find(faults, "metrics.json", &ConfigFault::file);
    return at == faults.end() ? std::string() : at->what;
  };
  const NodeFolder robot;
  robot.change("node.json", R"(, "interface": "lo")", "");
  CHECK(why_not(robot, "127.0.77.1:40000") == "127.0.77.1:40000 is this node's own TCP_PORT of network.json");
  CHECK(why_not(robot, "127.0.77.2:40000").empty());
  robot.change("node.json", R"("mode-adapter", )", "");
  CHECK(why_not(robot, "127.0.77.1:40000").empty());  // nobody opens it

  const NodeFolder cloud("cloud");
  cloud.write("node.json", R"({"id":"cloud","role":"cloud","services":["router","cloud-gateway"],)"
                           R"("bus":"tcp://127.0.77.1:46000"})");
  for (const char* port : {"46000", "46001"}) {
    const std::string at = std::string("127.0.77.1:") + port;
    CHECK(why_not(cloud, at) == at + " is this node's own bus of node.json");
  }
  cloud.write("cloud.json", R"({"listen": "0.0.0.0:8443"})");
  CHECK(why_not(cloud, "127.0.0.1:8443") == "127.0.0.1:8443 is this node's own listen of cloud.json");
}
