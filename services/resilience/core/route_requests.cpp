#include "services/resilience/core/route_requests.hpp"

#include <algorithm>
#include <utility>

namespace trb::resilience {

void RouteRequests::want(Now now, Duration pause) {
  const MonotonicTime at = sent_ ? std::max(now.mono, *sent_ + pause) : now.mono;
  due_ = earlier(due_, at);
}

void RouteRequests::want_with_next(Now now) {
  want(now, kAtOnce);
  and_next_ = true;
}

void RouteRequests::tick(const std::string& router, Duration again, Now now, Outbox& out) {
  if (!due_ || *due_ > now.mono) return;
  out.request(router, RouteListRequest{});
  sent_ = now.mono;
  due_ = now.mono + (std::exchange(and_next_, false) ? std::min(again, kAtOnce) : again);
}

std::optional<RouteTable> RouteRequests::receive(const RouteTable& page, const std::string& router, Outbox& out) {
  RoutePages::Taken taken = pages_.take(page);
  if (!taken.whole && taken.next) out.request(router, std::move(*taken.next));
  return std::move(taken.whole);
}

}  // namespace trb::resilience
