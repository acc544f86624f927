// A robot by TLS over real loopback sockets: every wait is a poll with a deadline.
#include <unistd.h>

#include "common/drivers/http-json/test/fixture.hpp"
#include "services/mode-adapter/io/robot_io.hpp"
#include "services/mode-adapter/test/fake_service.hpp"
#include "tests/support/tls_peer.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// A robot's own: no connection of anybody else has a port there.
constexpr const char* kSecureRobot = "127.0.27.3";

struct SecureNode {
  explicit SecureNode(TlsTrust trust)
      : listener(*tcp_listen(kSecureRobot, 0)),
        core(
            mir(), [](bool) { return Status(Done{}); }, [](const std::vector<Kept>&) { return Status(Done{}); }) {
    RobotIoSettings links{kLoopback, 0, kSecureRobot, local_port(listener.get()), {}};
    links.tls = std::move(trust);
    io = *RobotIo::open(links, service, core);
    service.after_sends([this] { io->carry_out(core.take_robot_output()); });
    service.timer([this] { return core.next_deadline(); },
                  [this](Now) { service.step([this](Now at, Outbox& out) { core.tick(at, out); }); });
  }
  /// The next connection that the node makes.
  void accept() {
    REQUIRE(service.until([this] {
      if (Accepted one = tcp_accept(listener.get()); one.fd) fd = std::move(one.fd);
      return bool(fd);
    }));
  }
  /// What the node has sent, as it went over the wire. False: it has closed.
  bool receive(std::string& into) const {
    char buffer[65536];
    const auto got = tcp_read(fd.get(), buffer, sizeof buffer);
    if (!got || got->closed) return false;
    into.append(buffer, got->bytes);
    return true;
  }
  void send(const std::string& bytes) const { (void)tcp_write(fd.get(), bytes); }
  bool serve(test::TlsPeer& robot) const {
    std::string bytes;
    const bool open = receive(bytes);
    robot.take(bytes);
    send(robot.to_send());
    return open;
  }
  bool says(const std::string& words) {
    return service.until([&] {
      return std::any_of(service.told.begin(), service.told.end(),
                         [&](const std::string& text) { return text.find(words) != std::string::npos; });
    });
  }
  [[nodiscard]] std::string state() {
    std::string out;
    service.step([&](Now at, Outbox& outbox) {
      core.on({MessageType::request, "mir", "", 1, 0, 0, 1000, AdapterStateRequest{}}, at, outbox);
      out = sent<AdapterState>(outbox).at(0).robot;
    });
    return out;
  }

  Descriptor listener;
  FakeService service;
  ModeAdapterCore core;
  std::unique_ptr<RobotIo> io;
  Descriptor fd;
};

}  // namespace

TEST_CASE("io: a robot is polled by TLS, and nothing of it is readable on the wire") {
  const test::Identity own = test::make_identity({});
  SecureNode node({test::fingerprint_of(own), "", ""});
  node.accept();
  test::TlsPeer robot(own);
  REQUIRE(node.service.until([&] { return node.serve(robot), robot.heard.find("\r\n\r\n") != std::string::npos; }));
  CHECK(robot.heard.starts_with("GET /status HTTP/1.1\r\n"));
  CHECK(node.state() != "ONLINE");
  robot.say("HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(std::string(kStatus).size()) + "\r\n\r\n" + kStatus);
  CHECK(node.service.until([&] { return node.serve(robot), node.state() == "ONLINE"; }));
  robot.end();
  node.send(robot.to_send());
  CHECK(node.says("robot_lost command: closed by the robot"));
}

TEST_CASE("io: a node that ends says so by TLS") {
  const test::Identity own = test::make_identity({});
  SecureNode node({test::fingerprint_of(own), "", ""});
  node.accept();
  test::TlsPeer robot(own);
  REQUIRE(node.service.until([&] { return node.serve(robot), robot.ready(); }));
  node.io.reset();  // the node ends, and says so
  std::string bytes;
  while (node.receive(bytes)) {
  }
  robot.take(bytes);
  CHECK(robot.ended());
}

TEST_CASE("io: a certificate that is not the robot's is told with the cure, and no request is sent") {
  const test::Identity own = test::make_identity({});
  const test::Identity other = test::make_identity({});
  SecureNode node({test::fingerprint_of(own), "", ""});
  for (int again = 0; again < 2; ++again) {  // it dials anew, and is told once
    node.fd.reset();
    node.accept();
    test::TlsPeer robot(other);
    REQUIRE(node.service.until([&] { return !node.serve(robot); }));
    CHECK(robot.heard.empty());
  }
  CHECK(node.says("robot_not_reached command: TLS: the robot's certificate is not that of tls.fingerprint"));
  CHECK(node.says("it has " + test::fingerprint_of(other)));
  CHECK(node.says("trb robot certificate NODE_DIR"));
  CHECK(node.service.logged("robot_not_reached") == 1);
}

TEST_CASE("io: who speaks plain HTTP, hangs up or stalls in the handshake is told so") {
  SecureNode node({test::fingerprint_of(test::make_identity({})), "", ""});
  node.accept();
  node.send("HTTP/1.1 400 Bad Request\r\n\r\n");
  CHECK(node.says("TLS: the robot speaks no TLS on this port; correct the port in commands.json"));
  node.fd.reset();
  node.accept();
  node.fd.reset();
  CHECK(node.says("TLS: the robot ended the handshake; trb robot certificate"));
  node.accept();
  CHECK(node.says("TLS: the robot did not end the handshake within 5 s; trb robot certificate"));
  std::string bytes;
  CHECK(node.service.until([&] { return !node.receive(bytes); }));
}
