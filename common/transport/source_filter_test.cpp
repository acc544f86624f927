// The kernel's filter and the cut of one connection, with plain sockets.
#include "common/transport/source_filter.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/descriptor.hpp"

using namespace trb;

namespace {

constexpr int kPatienceMs = 60'000;

class Fd {
 public:
  explicit Fd(int fd) : fd_(fd) {}
  Fd(Fd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  ~Fd() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

/// A listening socket on every address, and connections to it from addresses of this machine.
struct ListeningSocket {
  explicit ListeningSocket(int family_in)
      : family(family_in), listener(::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    REQUIRE(listener.get() >= 0);
    if (family == AF_INET6) {
      sockaddr_in6 any{};
      any.sin6_family = AF_INET6;
      any.sin6_addr = in6addr_loopback;
      REQUIRE(::bind(listener.get(), reinterpret_cast<sockaddr*>(&any), sizeof any) == 0);
    } else {
      sockaddr_in any{};
      any.sin_family = AF_INET;
      REQUIRE(::inet_pton(AF_INET, "127.0.130.1", &any.sin_addr) == 1);
      REQUIRE(::bind(listener.get(), reinterpret_cast<sockaddr*>(&any), sizeof any) == 0);
    }
    REQUIRE(::listen(listener.get(), 16) == 0);
    REQUIRE(::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&name), &size) == 0);
  }

  /// A slow machine has a minute for it.
  [[nodiscard]] bool lets_in(const char* from = nullptr) const { return is_up(dial(from), kPatienceMs); }
  /// Another socket that no filter is on answers a later dial, and this one still does not within 300 ms.
  [[nodiscard]] bool keeps_out(const char* from = nullptr) const {
    const Fd dialled = dial(from);
    return ListeningSocket(family).lets_in() && !is_up(dialled, 300);
  }

  /// A connection that comes up.
  [[nodiscard]] Fd connect(const char* from = nullptr) const {
    Fd fd = dial(from);
    REQUIRE(is_up(fd, kPatienceMs));
    return fd;
  }

  int family;
  Fd listener;
  sockaddr_storage name{};
  socklen_t size = sizeof name;

 private:
  [[nodiscard]] Fd dial(const char* from) const {
    Fd fd(::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (from != nullptr) {
      sockaddr_in source{};
      source.sin_family = AF_INET;
      REQUIRE(::inet_pton(AF_INET, from, &source.sin_addr) == 1);
      REQUIRE(::bind(fd.get(), reinterpret_cast<sockaddr*>(&source), sizeof source) == 0);
    }
    (void)::connect(fd.get(), reinterpret_cast<const sockaddr*>(&name), size);  // is_up() tells how it went
    return fd;
  }
  static bool is_up(const Fd& fd, int wait_ms) {
    pollfd item{fd.get(), POLLOUT, 0};
    return ::poll(&item, 1, wait_ms) == 1 && (item.revents & POLLERR) == 0;
  }
};

}  // namespace

TEST_CASE("the kernel drops what a blocked source sends to a listening socket, and nobody else's") {
  const ListeningSocket listening(AF_INET);
  SourceFilter filter;
  filter.add_listener(listening.listener.get());
  const Fd before = listening.connect("127.0.130.66");
  const Fd accepted(::accept(listening.listener.get(), nullptr, nullptr));
  REQUIRE(filter.set({"127.0.130.65", "127.0.130.66"}, false));
  CHECK(listening.keeps_out("127.0.130.66"));
  CHECK(listening.keeps_out("127.0.130.65"));
  CHECK(listening.lets_in("127.0.130.67"));
  // The earlier connection still works.
  REQUIRE(::send(before.get(), "x", 1, MSG_NOSIGNAL) == 1);
  pollfd item{accepted.get(), POLLIN, 0};
  CHECK(::poll(&item, 1, kPatienceMs) == 1);
  REQUIRE(filter.set({}, true));
  CHECK(listening.keeps_out("127.0.130.67"));
  REQUIRE(filter.set({}, false));
  CHECK(listening.lets_in("127.0.130.66"));
}

TEST_CASE("closed to everybody but friends, unless one of them is kept out by name") {
  const ListeningSocket listening(AF_INET);
  SourceFilter filter;
  filter.add_listener(listening.listener.get());
  REQUIRE(filter.set({"127.0.130.65"}, true, {"127.0.130.65", "127.0.130.66", "2001:db8::/64"}));
  CHECK(listening.lets_in("127.0.130.66"));
  CHECK(listening.keeps_out("127.0.130.65"));
  CHECK(listening.keeps_out("127.0.130.67"));
  std::vector<std::string> friends(1000, "2001:db8::/64");
  CHECK(filter.set(friends, true, friends));
  CHECK(source_of("10.0.0.7") == "10.0.0.7");
  CHECK(source_of("2001:db8::7") == "2001:db8::/64");
  CHECK(source_of("::ffff:10.0.0.7") == "10.0.0.7");
  CHECK(source_of("cloud.example").empty());
}

TEST_CASE("as many sources as there may be, and a listener that comes later") {
  const ListeningSocket listening(AF_INET);
  std::vector<std::string> sources;
  for (int i = 1; i <= 100; ++i) sources.push_back("127.0.131." + std::to_string(i));
  SourceFilter filter;
  REQUIRE(filter.set(sources, false));
  filter.add_listener(listening.listener.get());
  CHECK(listening.keeps_out("127.0.131.64"));
  CHECK(listening.lets_in("127.0.131.65"));
  CHECK(listening.lets_in("127.0.132.1"));
}

TEST_CASE("where the kernel has little room for a filter, it has as many friends as fit") {
  const char* left_out = nullptr;
  bool is_set = false;
  // Of this thread alone: a network of its own, with the bound of Debian 12.
  std::thread([&] {
    if (::unshare(CLONE_NEWNET) != 0) return void(left_out = "no network of its own: not root");
    const Descriptor bound(::open("/proc/sys/net/core/optmem_max", O_WRONLY | O_CLOEXEC));
    if (!bound || ::write(bound.get(), "20480", 5) != 5)
      return void(left_out = "the bound is the machine's: Linux < 6.8");
    const Descriptor listener(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
    SourceFilter filter;
    filter.add_listener(listener.get());
    std::vector<std::string> blocked;
    std::vector<std::string> friends;
    for (int i = 0; i < 64; ++i) blocked.push_back("2001:db9:0:" + std::to_string(i) + "::/64");
    for (int i = 0; i < 256; ++i) friends.push_back("2001:db8:0:" + std::to_string(i) + "::/64");
    is_set = filter.set(blocked, true, friends);
  }).join();
  if (left_out != nullptr) {
    MESSAGE(left_out);
    return;
  }
  CHECK(is_set);
}

TEST_CASE("IPv6 is told apart by its first 64 bits") {
  const Fd probe(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in6 own{};
  own.sin6_family = AF_INET6;
  own.sin6_addr = in6addr_loopback;
  if (probe.get() < 0 || ::bind(probe.get(), reinterpret_cast<sockaddr*>(&own), sizeof own) != 0) return;
  const ListeningSocket listening(AF_INET6);
  SourceFilter filter;
  filter.add_listener(listening.listener.get());
  REQUIRE(filter.set({"2001:db8::/64", "127.0.0.1"}, false));
  const Fd client = listening.connect();
  const Fd accepted(::accept(listening.listener.get(), nullptr, nullptr));
  CHECK(remote_end(accepted.get())->source == "::/64");
  REQUIRE(filter.set({"2001:db8::/64", "::/64"}, false));
  CHECK(listening.keeps_out());
}

TEST_CASE("one connection is cut, unless its descriptor is another one's by now") {
  const ListeningSocket listening(AF_INET);
  const Fd client = listening.connect("127.0.130.66");
  const Fd accepted(::accept(listening.listener.get(), nullptr, nullptr));
  const auto end = remote_end(accepted.get());
  REQUIRE(end);
  CHECK(end->source == "127.0.130.66");
  CHECK(end->address.starts_with("127.0.130.66:"));
  char byte = 0;
  cut_connection(accepted.get(), {"127.0.130.66:1", "127.0.130.66"});
  CHECK(::recv(client.get(), &byte, 1, MSG_DONTWAIT) < 0);
  cut_connection(accepted.get(), *end);
  pollfd item{client.get(), POLLIN, 0};
  REQUIRE(::poll(&item, 1, kPatienceMs) == 1);
  CHECK(::recv(client.get(), &byte, 1, MSG_DONTWAIT) == 0);
  CHECK(!remote_end(listening.listener.get()));
  CHECK(!remote_end(-1));
}
