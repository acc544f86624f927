#include "services/scheduler/core/handlers/route_handler.hpp"

#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {

void RouteHandler::handle(const RouteTable& body, const Inbound& from, Step step) {
  if (from.source != node_) {
    return refuse(from, fail(Errc::not_permitted, "only the own router tells whom it reaches"), step);
  }
  auto taken = pages_.take(body);
  if (taken.next) step.out.request(node_, std::move(*taken.next));
  if (!taken.whole) return;
  conditions_.on_routes(*taken.whole, step);
  definitions_.on_routes(*taken.whole, step);
  robots_.on_routes(*taken.whole);
}

}  // namespace trb::scheduler
