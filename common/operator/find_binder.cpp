#include "common/operator/find_binder.hpp"

#include <algorithm>

#include "common/operator/routes.hpp"

namespace trb::op {
namespace {

constexpr Duration kWait = std::chrono::seconds(2);

bool names_every_robot(const Scenario& scenario) {
  return std::ranges::none_of(scenario.tasks, [](const Task& task) { return task.robot.empty(); });
}

}  // namespace

void find_binder(Session& session, const Scenario& scenario, const RouteTable& table,
                 const std::function<void(Binder)>& found) {
  const auto finish = [&](Binder binder) {
    session.after(Duration::zero(), [found, binder = std::move(binder)] { found(binder); });
  };
  if (names_every_robot(scenario)) return finish({});
  const auto first = std::ranges::find(table.routes, Role::cloud, &Route::role);
  if (first == table.routes.end()) return finish({"", "the fleet has no cloud node"});
  const std::string name = "node '" + first->id + "', which decides, ";
  if (!is_reached(*first)) return finish({"", name + "is not reached"});
  const auto answered = [found, name, node = first->id](const Result<Message>& answer) {
    if (answer) return found({node, ""});
    found({"", name + "has no resilience that answers: " + answer.error().what});
  };
  session.request(Send{.type = MessageType::request, .target = first->id, .body = AlertListRequest{}}, answered, kWait);
}

}  // namespace trb::op
