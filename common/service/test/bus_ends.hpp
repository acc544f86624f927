// A service's bus link and its router's end of it, and what waits until one of them has received something.
#pragma once

#include <doctest/doctest.h>

#include <optional>
#include <set>
#include <string_view>

#include "common/service/bus_link.hpp"
#include "common/service/test/router_end.hpp"

namespace trb::test {

/// Advances time on the link, in steps of 20 ms without waiting, until the router's end has received one of the
/// subtypes.
inline std::optional<Message> hear(BusLink& link, Router& router, const std::set<std::string_view>& subtypes) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  for (Now now = read_clocks(); now.mono < end; now = read_clocks()) {
    link.tick(now);
    link.receive(now);
    zmq::pollitem_t items[] = {{router.socket->handle(), 0, ZMQ_POLLIN, 0}, {link.handle(), 0, ZMQ_POLLIN, 0}};
    zmq::poll(items, 2, std::chrono::milliseconds(20));
    if (auto message = router.receive(); message && subtypes.count(message->subtype) != 0) return message;
  }
  return std::nullopt;
}

inline std::optional<Message> hear(BusLink& link, Router& router, std::string_view subtype) {
  return hear(link, router, std::set{subtype});
}

template <class Condition>
bool link_until(BusLink& link, Condition condition) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!condition() && read_clocks().mono < end) {
    zmq::pollitem_t item{link.handle(), 0, ZMQ_POLLIN, 0};
    zmq::poll(&item, 1, std::chrono::milliseconds(20));
    link.receive(read_clocks());
  }
  return condition();
}

inline ServiceHello hello() {
  return {"cli", {"wave"}, 7, 1, "test"};
}

/// A service's link and its router's end of it.
struct Ends {
  Folder folder;
  Router router;
  Context context;
  BusLink link{context, ipc_bus("probe"), hello()};

  void welcome() {
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
  }
};

}  // namespace trb::test
