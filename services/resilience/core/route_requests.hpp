// When to request the router's table: the router does not notify services of changed profiles.
#pragma once

#include <optional>
#include <string>

#include "common/actor/outbox.hpp"
#include "common/actor/route_pages.hpp"
#include "common/base/time.hpp"

namespace trb::resilience {

class RouteRequests {
 public:
  static constexpr Duration kAtOnce = std::chrono::seconds(1);  ///< the shortest time between two requests
  static constexpr Duration kWhileOpen = std::chrono::seconds(5);
  static constexpr Duration kIdle = std::chrono::seconds(30);

  /// Requests a table as soon as `pause` has passed since the last request.
  void want(Now now, Duration pause);
  /// At once, and once more after that: what a robot reports, or that its node has joined, is here a moment before its
  /// node's profile.
  void want_with_next(Now now);
  /// Sends the request that is due; the next follows after `again`, or earlier if want() is called.
  void tick(const std::string& router, Duration again, Now now, Outbox& out);
  /// The whole table once its last page has come; before that the next page is requested.
  std::optional<RouteTable> receive(const RouteTable& page, const std::string& router, Outbox& out);

  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return due_; }

 private:
  RoutePages pages_;
  std::optional<MonotonicTime> due_;
  std::optional<MonotonicTime> sent_;
  bool and_next_ = false;
};

}  // namespace trb::resilience
