// The robot's connections over real loopback sockets: every wait is a poll with a deadline.
#include "services/mode-adapter/io/robot_io.hpp"

#include <unistd.h>

#include <filesystem>

#include "common/base/test/temporary_folder.hpp"
#include "services/mode-adapter/io/fence_file.hpp"
#include "services/mode-adapter/test/fake_service.hpp"
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// A robot's own: no connection of anybody else has a port there.
constexpr const char* kRobot = "127.0.27.1";

struct Node {
  explicit Node(Settings settings, RobotIoSettings links = {kLoopback, 0, kLoopback, {}, {}})
      : core(
            std::move(settings), [](bool) { return Status(Done{}); },
            [](const std::vector<Kept>&) { return Status(Done{}); }),
        io(*RobotIo::open(links, service, core)) {
    service.after_sends([this] { io->carry_out(core.take_robot_output()); });
  }

  [[nodiscard]] bool online() {
    std::string state;
    service.step([&](Now at, Outbox& out) {
      core.on({MessageType::request, "pioneer", "", 1, 0, 0, 1000, AdapterStateRequest{}}, at, out);
      state = sent<AdapterState>(out).at(0).robot;
    });
    return state == "ONLINE";
  }
  void command(const std::string& subtype, const std::string& data) {
    service.step([&](Now at, Outbox& out) {
      core.on({MessageType::command, "operator", "", 1, 0, 0, 10'000, Opaque{subtype, data}}, at, out);
    });
  }

  FakeService service;
  ModeAdapterCore core;
  std::unique_ptr<RobotIo> io;
};

/// The other end of a connection.
struct Peer {
  explicit Peer(Descriptor descriptor) : fd(std::move(descriptor)) {}
  explicit Peer(std::uint16_t port) : fd(std::move(*tcp_dial(kLoopback, port))) {}

  void say(BytesView bytes) const { CHECK(::write(fd.get(), bytes.data(), bytes.size()) == ssize_t(bytes.size())); }
  /// Everything received so far.
  const std::string& heard() {
    char buffer[65536];
    while (!closed) {
      const auto got = tcp_read(fd.get(), buffer, sizeof buffer);
      closed = !got || got->closed;
      if (closed || got->bytes == 0) break;
      text.append(buffer, got->bytes);
    }
    return text;
  }
  bool is_closed() { return heard(), closed; }

  Descriptor fd;
  std::string text;
  bool closed = false;
};

}  // namespace

TEST_CASE("io: a robot dials in, takes a message field by field and says one itself") {
  Node node(pioneer());
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  node.command("move", "1 2");
  const std::vector<std::string> fields = {"command\n", "move\n", "operator\n", "3\n", "1 2\n"};
  std::string expected;
  for (const std::string& field : fields) {
    expected += field;
    REQUIRE(node.service.until([&] { return robot.heard() == expected; }));
    robot.say("ok\n");
  }
  robot.say("information\nheat\nur3\n1\n7\n");
  CHECK(node.service.until(
      [&] { return std::count(node.service.counts.begin(), node.service.counts.end(), "from_robot.heat") == 1; }));
}

TEST_CASE("io: TCP_PORT takes one connection, and only the robot's") {
  Node node(pioneer());
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  Peer second(node.io->listen_port());
  REQUIRE(node.service.until([&] { return second.is_closed(); }));
  CHECK(node.online());
  CHECK(std::count(node.service.counts.begin(), node.service.counts.end(), "refused.field_client") == 1);
  robot.fd.reset();
  REQUIRE(node.service.until([&] { return !node.online(); }));
  Peer again(node.io->listen_port());
  CHECK(node.service.until([&] { return node.online(); }));

  Node strict(pioneer(), {kLoopback, 0, "127.0.0.2", {}, {}});
  Peer stranger(strict.io->listen_port());
  REQUIRE(strict.service.until([&] { return stranger.is_closed(); }));
  CHECK_FALSE(strict.online());
}

TEST_CASE("io: a robot that does not read is let go, one message of a megabyte is not too much") {
  Settings settings = pioneer();
  settings.description.field_channel.acknowledge = false;
  Node node(settings);
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  node.command("map", std::string(kMaxDataSize, 'm'));
  REQUIRE(node.service.until([&] { return robot.heard().size() > kMaxDataSize; }));
  for (int i = 0; i < 32; ++i) node.command("map", std::string(kMaxDataSize, 'm'));
  CHECK(node.service.until([&] { return !node.online(); }));
}

TEST_CASE("io: a robot is not read while its messages have no room on the bus, but for half a second") {
  Node node(pioneer());
  const auto heats = [&] {
    return std::count(node.service.counts.begin(), node.service.counts.end(), "from_robot.heat");
  };
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  node.service.bus_has_room = false;
  robot.say("information\nheat\nur3\n1\n7\n");
  const MonotonicTime said = now().mono;
  REQUIRE(node.service.until([&] { return heats() == 1; }));
  CHECK(now().mono - said >= std::chrono::milliseconds(400));
  // With room it is read at once.
  robot.say("information\nheat\nur3\n1\n8\n");
  const MonotonicTime seen = now().mono + std::chrono::milliseconds(50);
  REQUIRE(node.service.until([&] { return now().mono >= seen; }));
  CHECK(heats() == 1);
  node.service.bus_has_room = true;
  CHECK(node.service.until([&] { return heats() == 2; }));
}

TEST_CASE("io: a robot that leaves while it is not read is lost with room on the bus") {
  Node node(pioneer());
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  node.service.bus_has_room = false;
  robot.say("information\nheat\nur3\n1\n7\n");
  robot.fd.reset();
  REQUIRE(node.service.until([&] { return !node.online(); }));
  CHECK(std::count(node.service.counts.begin(), node.service.counts.end(), "from_robot.heat") == 1);
}

TEST_CASE("io: a robot that leaves, read or not, and comes again at once is taken in, and its last words are heard") {
  Node node(pioneer());
  auto robot = std::make_unique<Peer>(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  SUBCASE("with room on the bus") {}
  SUBCASE("without room") {
    node.service.bus_has_room = false;
  }
  const auto count = [&](const char* name) {
    return std::count(node.service.counts.begin(), node.service.counts.end(), name);
  };
  robot->say("information\nheat\nur3\n1\n7\n");
  robot.reset();
  Peer again(node.io->listen_port());
  again.say("information\ncold\nur3\n1\n7\n");
  REQUIRE(node.service.until([&] { return count("from_robot.cold") == 1; }));
  CHECK(count("from_robot.heat") == 1);
  CHECK(count("refused.field_client") == 0);
  CHECK(node.online());
}

TEST_CASE("io: what a process that ends writes in one step leaves whole") {
  Settings settings = pioneer();
  settings.description.field_channel.acknowledge = false;
  Node node(settings);
  Peer robot(node.io->listen_port());
  REQUIRE(node.service.until([&] { return node.online(); }));
  RobotOutbox last;
  last.write(Channel::field, "STOP\n");
  last.write(Channel::field, "CLOSE\n");
  node.io->carry_out(last);
  node.io.reset();
  REQUIRE(node.service.until([&] { return robot.is_closed(); }));
  CHECK(robot.heard() == "STOP\nCLOSE\n");
}

TEST_CASE("io: a controller is dialled until it is there, and again when it is lost") {
  Descriptor commands = std::move(*tcp_listen(kRobot, 0));
  Descriptor monitor = std::move(*tcp_listen(kRobot, 0));
  const auto monitor_port = local_port(monitor.get());
  monitor.reset();  // refused at first
  Node node(ur3(), {kLoopback, 0, kRobot, local_port(commands.get()), monitor_port});
  Accepted command_side;
  REQUIRE(node.service.until([&] { return bool((command_side = tcp_accept(commands.get())).fd); }));
  REQUIRE(node.service.until([&] {
    auto again = tcp_listen(kRobot, monitor_port);
    if (again) monitor = std::move(*again);
    return again.ok();  // else somebody who listens on every address has the port
  }));
  for (int round = 0; round < 2; ++round) {
    Accepted monitor_side;
    REQUIRE(node.service.until([&] { return bool((monitor_side = tcp_accept(monitor.get())).fd); }));
    Peer controller(std::move(monitor_side.fd));
    controller.say(ur_state());
    REQUIRE(node.service.until([&] { return node.online(); }));
    if (round == 0) {
      node.command("move", "[0,0,0,0,0,0]");
      Peer arm(std::move(command_side.fd));
      CHECK(
          node.service.until([&] { return arm.heard().starts_with("def trb_77_1():\n  movej([0, 0, 0, 0, 0, 0])"); }));
      command_side.fd = std::move(arm.fd);
    }
    controller.fd.reset();
    REQUIRE(node.service.until([&] { return !node.online(); }));
  }
}

TEST_CASE("io: an address that is in use, or none, is said when opening") {
  FakeService service;
  ModeAdapterCore core(pioneer(), {}, {});
  const Descriptor taken = std::move(*tcp_listen(kLoopback, 0));
  CHECK(RobotIo::open({kLoopback, local_port(taken.get()), "", {}, {}}, service, core).error().code == Errc::io_error);
  CHECK(RobotIo::open({"eth0", 0, "", {}, {}}, service, core).error().code == Errc::bad_value);
}

TEST_CASE("io: the fence is a file, and lifting it twice is fine") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path + "/state");
  const FenceFile fence(folder.path);
  CHECK_FALSE(fence.set());
  CHECK(fence.save(true));
  CHECK(FenceFile(folder.path).set());
  CHECK(fence.save(false));
  CHECK(fence.save(false));
  CHECK_FALSE(fence.set());
  CHECK_FALSE(FenceFile(folder.path + "/nowhere").save(true));
}
