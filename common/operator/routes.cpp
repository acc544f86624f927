#include "common/operator/routes.hpp"

#include <memory>

#include "common/actor/route_pages.hpp"

namespace trb::op {
namespace {

void request_page(Session& session, const std::shared_ptr<RoutePages>& pages, const RouteListRequest& page,
                  const Callback<RouteTable>& done, Duration wait) {
  const auto take = [&session, pages, done, wait](RouteTable table) {
    auto taken = pages->take(std::move(table));
    if (taken.whole) return done(std::move(*taken.whole));
    if (taken.next) return request_page(session, pages, *taken.next, done, wait);
    done(fail(Errc::conflict, "the router of '" + session.node() + "' tells another page than it was asked"));
  };
  session.ask_node<RouteTable>(page, on_success<RouteTable>(done, take), wait);
}

}  // namespace

void request_routes(Session& session, Callback<RouteTable> done, Duration wait) {
  request_page(session, std::make_shared<RoutePages>(), RouteListRequest{}, done, wait);
}

std::vector<std::string> robots_of(const RouteTable& table) {
  std::vector<std::string> out;
  for (const Route& route : table.routes) {
    if (route.role == Role::robot) out.push_back(route.id);
  }
  return out;
}

Status check_whole(const RouteTable& table) {
  if (!table.gathers) return Done{};
  return fail(Errc::peer_unreachable,
              "the router of '" + table.node +
                  "' has just started, and may not have heard all members of the fleet yet: what the scenario needs "
                  "may be there",
              "try again in some seconds");
}

bool is_reached(const Route& route) {
  return route.state == "self" || route.state == "ONLINE";
}

}  // namespace trb::op
