#include "common/operator/run_report.hpp"

#include "common/operator/scenario_check.hpp"
#include "common/scenario/graph.hpp"

namespace trb::op {
namespace {

void add_profile(Value& task, const Profiles& profiles) {
  const auto profile = profiles.find(task.find("robot")->text());
  if (profile == profiles.end()) return;
  auto& fields = std::get<Value::Object>(task.is);
  fields.emplace_back("mode", Value{profile->second.mode});
  fields.emplace_back("transport", Value{profile->second.transport});
}

}  // namespace

Value run_report(const RunView& view, const RouteTable& table) {
  const Profiles profiles = profiles_of(table);
  Value json = *parse_json(to_json(view));
  auto& top = std::get<Value::Object>(json.is);
  for (auto& [key, member] : top) {
    if (key != "tasks") continue;
    for (Value& task : std::get<Value::List>(member.is)) add_profile(task, profiles);
  }
  std::vector<std::string> robots;
  for (const TaskView& task : view.tasks) robots.push_back(task.robot);
  const Blocks blocks = blocks_of(robots);
  top.emplace_back("blocks_k", Value{static_cast<std::int64_t>(blocks.k)});
  top.emplace_back("blocks_sum_m", Value{static_cast<std::int64_t>(blocks.sum_m)});
  return json;
}

}  // namespace trb::op
