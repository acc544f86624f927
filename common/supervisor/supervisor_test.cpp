// A supervisor with real processes: shell scripts that record each of their starts.
#include "common/supervisor/supervisor.hpp"
#include "common/base/test/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/base/descriptor.hpp"
#include "common/base/files.hpp"
#include "common/supervisor/node_lock.hpp"
#include "common/transport/loop.hpp"

using namespace trb;
using namespace trb::supervisor;

namespace {

namespace fs = std::filesystem;

/// A node's folder, and programs in it.
struct Node {
  TemporaryFolder temporary;
  std::string dir = temporary.path;
  std::vector<std::string> notes;
  MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);

  Node() { supervisor::block_signals(); }

  /// A program that does `first`, writes its pid, a line each start, and then does `then`.
  ServiceProgram program(const std::string& name, const std::string& then, const std::string& first = "") const {
    const std::string path = dir + "/" + name + ".sh";
    std::ofstream(path) << "#!/bin/sh\n" << first << "\necho $$ >> \"$1/" << name << ".pids\"\n" << then << "\n";
    fs::permissions(path, fs::perms::owner_all);
    return {name, path};
  }
  [[nodiscard]] std::vector<pid_t> pids(const std::string& name) const {
    std::ifstream in(dir + "/" + name + ".pids");
    std::vector<pid_t> out;
    for (pid_t pid = 0; in >> pid;) out.push_back(pid);
    return out;
  }
  [[nodiscard]] bool has_note(const std::string& text) const {
    return std::find(notes.begin(), notes.end(), text) != notes.end();
  }
  [[nodiscard]] bool late() const { return read_clocks().mono > end; }
};

constexpr const char* kRunOn = "exec sleep 1000";
constexpr Duration kShort = std::chrono::milliseconds(300);

void send_self(int signal) {
  ::kill(::getpid(), signal);
}

bool is_gone(pid_t pid) {
  return ::kill(pid, 0) != 0 && errno == ESRCH;
}

/// In the words of a test: whether all is up.
Supervisor::WaitsFor until(std::function<bool()> is_up) {
  return [is_up = std::move(is_up)] { return is_up() ? std::string() : std::string("not up"); };
}

/// What this process says to systemd, which this test plays.
struct Ear {
  TemporaryFolder folder;
  std::string path = folder.path + "/notify";
  Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  std::vector<std::string> heard;

  Ear() {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof at.sun_path);
    std::copy(path.begin(), path.end(), at.sun_path);
    REQUIRE(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~Ear() { ::unsetenv("NOTIFY_SOCKET"); }
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  bool has(const std::string& word) {
    char text[256];
    for (ssize_t size = 0; (size = ::recv(socket.get(), text, sizeof text, 0)) >= 0;) {
      heard.emplace_back(text, static_cast<std::size_t>(size));
    }
    return std::ranges::find(heard, word) != heard.end();
  }
};

std::optional<std::vector<ServiceProgram>> no_reload() {
  return std::nullopt;
}

}  // namespace

TEST_CASE("all services are started, 'ready' is said once, and they end with the supervisor") {
  Node node;
  Supervisor supervisor(node.dir, {node.program("a", kRunOn), node.program("b", kRunOn)}, [&](const std::string& note) {
    node.notes.push_back(note);
    send_self(SIGTERM);
  });
  const auto is_ready = [&] { return (!node.pids("a").empty() && !node.pids("b").empty()) || node.late(); };
  CHECK(supervisor.run(no_reload, until(is_ready)) == 0);
  CHECK(node.notes == std::vector<std::string>{"ready"});
  REQUIRE(node.pids("a").size() == 1);
  CHECK(is_gone(node.pids("a")[0]));
  CHECK(is_gone(node.pids("b")[0]));
}

TEST_CASE("a service that ends is started again, the second time with a wait; one that asks for it at once") {
  Node node;
  std::vector<MonotonicTime> ends;
  std::string third = "[ $(wc -l < \"$1/a.pids\") -lt 3 ] && exit ";
  SUBCASE("it fails") {
    third += "1";
  }
  SUBCASE("it asks for it") {
    third += "75";
  }
  const bool asks = third.ends_with("75");
  Supervisor supervisor(node.dir, {node.program("a", third + "\n" + kRunOn)}, [&](const std::string& note) {
    node.notes.push_back(note);
    ends.push_back(read_clocks().mono);
    if (note == "ready") send_self(SIGTERM);
  });
  CHECK(supervisor.run(no_reload, until([&] { return node.pids("a").size() >= 3 || node.late(); })) == 0);
  REQUIRE(node.notes.size() == 3);
  CHECK(node.notes[1] == (asks ? "a starts again with the new files" : "a ended (status 1), starting it again"));
  CHECK(node.notes[2] == "ready");
  if (!asks) CHECK(ends[2] - ends[1] >= std::chrono::milliseconds(100));
}

TEST_CASE("a start that takes too long is over for systemd, whose status says what it waits for until all is up") {
  Node node;
  Ear ear;
  Supervisor supervisor(node.dir, {node.program("a", kRunOn)}, [&](const std::string& note) {
    node.notes.push_back(note);
    if (note == "ready") send_self(SIGTERM);
  });
  int asked = 0;
  const auto waits_for = [&]() -> std::string {
    if (++asked == 1) return "its router does not answer";
    return ear.has("READY=1") || node.late() ? "" : "not up: b";
  };
  CHECK(supervisor.run(no_reload, waits_for, std::chrono::milliseconds(150)) == 0);
  CHECK(node.notes == std::vector<std::string>{"still waits: not up: b", "ready"});
  CHECK(ear.has("STOPPING=1"));
  CHECK(ear.heard == std::vector<std::string>{"STATUS=waits: its router does not answer", "STATUS=waits: not up: b",
                                              "READY=1", "STATUS=", "READY=1", "STOPPING=1"});
}

TEST_CASE("at SIGHUP a new service is started and one that was taken out ends, if the new files are good") {
  Node node;
  const ServiceProgram b = node.program("b", kRunOn);
  bool good = false;
  int reloads = 0;
  Supervisor supervisor(node.dir, {node.program("a", kRunOn)}, [&](const std::string& note) {
    node.notes.push_back(note);
    if (note == "ready") send_self(good ? SIGTERM : SIGHUP);
  });
  const auto reload = [&]() -> std::optional<std::vector<ServiceProgram>> {
    // At the first reload the files have a fault: everything stays as it is.
    if (++reloads == 1) send_self(SIGHUP);
    if (reloads == 1) return std::nullopt;
    good = true;
    return std::vector{b};
  };
  const auto is_ready = [&] { return !node.pids(good ? "b" : "a").empty() || node.late(); };
  CHECK(supervisor.run(reload, until(is_ready)) == 0);
  CHECK(node.notes == std::vector<std::string>{"ready", "a was taken out, and ends", "b is new, and starts", "ready"});
  CHECK(node.pids("a").size() == 1);
  CHECK(is_gone(node.pids("a")[0]));
}

TEST_CASE("while a reload is not over yet, who asks whether all is ready keeps no service from its start") {
  Node node;
  const std::vector both{node.program("a", kRunOn), node.program("b", kRunOn)};
  bool reloaded = false;
  int waits_in_vain = 0;
  Supervisor supervisor(node.dir, {both[0]}, [&](const std::string& note) {
    if (note == "ready") send_self(reloaded ? SIGTERM : SIGHUP);
  });
  const auto reload = [&]() -> std::optional<std::vector<ServiceProgram>> {
    reloaded = true;
    return both;
  };
  // As a probe of the node's bus waits for its router, which is "a".
  const auto is_ready = [&] {
    if (!reloaded) return !node.pids("a").empty() || node.late();
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(1);
    while (node.pids("a").size() < 2 && read_clocks().mono < end) std::this_thread::yield();
    if (node.pids("a").size() < 2) ++waits_in_vain;
    return (node.pids("a").size() >= 2 && !node.pids("b").empty()) || node.late();
  };
  CHECK(supervisor.run(reload, until(is_ready)) == 0);
  CHECK(node.pids("a").size() == 2);
  CHECK(waits_in_vain <= 1);  // 1: "a" has not yet ended, 0.1 s after it was asked to
}

TEST_CASE("a service that was taken out and does not end in its time is killed") {
  Node node;
  bool taken_out = false;
  const auto on_note = [&](const std::string& note) {
    node.notes.push_back(note);
    if (note == "ready") send_self(taken_out ? SIGTERM : SIGHUP);
  };
  Supervisor supervisor(node.dir, {node.program("a", kRunOn, "trap '' TERM HUP")}, on_note, kShort);
  const ServiceProgram b = node.program("b", kRunOn);
  const auto reload = [&]() -> std::optional<std::vector<ServiceProgram>> {
    taken_out = true;
    return std::vector{b};
  };
  const auto is_ready = [&] {
    const auto a = node.pids("a");
    return taken_out ? is_gone(a[0]) || node.late() : !a.empty() || node.late();
  };
  CHECK(supervisor.run(reload, until(is_ready)) == 0);
  CHECK_FALSE(node.late());
  CHECK(node.has_note("a does not end, and is killed"));
}

TEST_CASE("a service that does not end in its time is killed, and has ended when the supervisor does") {
  Node node;
  Supervisor supervisor(
      node.dir, {node.program("a", kRunOn, "trap '' TERM")}, [&](const std::string&) { send_self(SIGINT); }, kShort);
  CHECK(supervisor.run(no_reload, until([&] { return !node.pids("a").empty() || node.late(); })) == 0);
  REQUIRE(node.pids("a").size() == 1);
  CHECK(is_gone(node.pids("a")[0]));
}

TEST_CASE("the wait before a restart doubles up to two seconds, and begins anew once a service has settled") {
  RestartDelay delay;
  const auto fall = [&](double up_s, bool asked = false) { return to_seconds(delay.after_end(asked, seconds(up_s))); };
  CHECK(fall(1) == 0);
  for (const double wait : {0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0}) CHECK(fall(1) == doctest::Approx(wait));
  CHECK(fall(11) == 0);
  CHECK(fall(1) == doctest::Approx(0.1));
  CHECK(fall(1, true) == 0);
  CHECK(fall(1) == doctest::Approx(0.1));
}

TEST_CASE("a node has one supervisor, and its lock goes with it") {
  Node node;
  CHECK(NodeLock::holder(node.dir).error().code == Errc::missing);
  {
    auto lock = NodeLock::take(node.dir);
    REQUIRE(lock.ok());
    const auto second = NodeLock::take(node.dir);
    CHECK(second.error().code == Errc::conflict);
    CHECK(second.error().what == node.dir + " is up already (pid " + std::to_string(::getpid()) + ")");
    // Whatever the file says: on a full disk it says nothing, on a read-only one the pid of an earlier start.
    const std::string path = node.dir + "/state/up.lock";
    for (const char* text : {"", "0000000001\n"}) {
      std::ofstream(path, std::ios::trunc) << text;
      REQUIRE(NodeLock::holder(node.dir).ok());
      CHECK(*NodeLock::holder(node.dir) == ::getpid());
    }
    CHECK(NodeLock::take(node.dir).error().what == second.error().what);
  }
  CHECK(NodeLock::holder(node.dir).error().code == Errc::missing);
  CHECK(NodeLock::take(node.dir).ok());
}
