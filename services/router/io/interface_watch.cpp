#include "services/router/io/interface_watch.hpp"

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace trb::router {

Result<std::unique_ptr<InterfaceWatch>> InterfaceWatch::open(Loop& loop, std::function<void()> on_change) {
  Descriptor fd(::socket(AF_NETLINK, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, NETLINK_ROUTE));
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR | RTMGRP_IPV6_IFADDR;
  if (!fd || ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(Errc::io_error, std::string("netlink: ") + std::strerror(errno),
                "a container may forbid it; restart the node when its address changes");
  }
  return std::unique_ptr<InterfaceWatch>(new InterfaceWatch(loop, std::move(fd), std::move(on_change)));
}

InterfaceWatch::InterfaceWatch(Loop& loop, Descriptor fd, std::function<void()> on_change)
    : loop_(loop), fd_(std::move(fd)), on_change_(std::move(on_change)) {
  loop_.add_fd(fd_.get(), POLLIN, [this](short) { drain(); });
}

InterfaceWatch::~InterfaceWatch() {
  loop_.remove_fd(fd_.get());
}

void InterfaceWatch::drain() {
  // The contents are ignored: too many changes overflow the socket (ENOBUFS), and would then be incomplete.
  constexpr int kBatch = 256;
  std::array<char, 8192> buffer{};
  for (int i = 0; i < kBatch; ++i) {
    if (::recv(fd_.get(), buffer.data(), buffer.size(), 0) < 0 && errno != ENOBUFS) break;
  }
  on_change_();
}

}  // namespace trb::router
