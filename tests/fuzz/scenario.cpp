// A scenario's file: any bytes give faults with a hint, or a valid scenario: its graph passes every scheduler's check,
// it stays the same on the wire, and values of results give data that a node accepts, or an error.
#include <algorithm>

#include "common/scenario/candidate_index.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/repeat.hpp"
#include "common/scenario/values.hpp"
#include "proto/body.hpp"
#include "tests/fuzz/bits.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

const Profiles& fleet() {
  static const Profiles profiles = [] {
    NodeProfile cart;
    cart.robot = "ONLINE";
    cart.capabilities = {"mobile"};
    cart.places = {"dock", "table1"};
    cart.skills = {
        {"go_to", "mobile", {{"place", "place", true, ""}, {"speed", "number", false, "m/s", {0, 1}}}},
        {"pose", "", {{"joints", "numbers", true, "rad", {}, {}, 2}, {"side", "text", false, "", {}, {"l"}}}}};
    NodeProfile stopped = cart;
    stopped.fenced = true;
    return Profiles{{"a", cart}, {"b", stopped}, {"cloud", {}}};
  }();
  return profiles;
}

void check_faults(const ConfigFaults& faults) {
  for (const ConfigFault& fault : faults) require(!fault.what.empty() && !fault.hint.empty(), "a fault has a cure");
}

void check_fleet(const Scenario& scenario) {
  ConfigFaults faults;
  check_scenario(scenario, fleet(), "s.json", faults);
  CandidateIndex candidates(fleet());
  const auto robots = bind_tasks(scenario, candidates, "", "s.json", faults);
  check_faults(faults);
  require(robots.size() == scenario.tasks.size(), "each task has its robot, or nobody");
  for (const NoSpare& one : tasks_without_spare(scenario, candidates))
    require(!one.why.empty(), "no spare: it says why");
}

void check_values(const Task& task, const std::string& data) {
  TaskResult result;
  result.outcome = TaskOutcome::finished;
  result.data = data;
  const auto filled = fill_values(task, [&](const std::string&) { return &result; });
  if (!filled) return require(!filled.error().what.empty() && !filled.error().hint.empty(), "an error has a cure");
  const auto json = parse_json(filled->empty() ? "{}" : *filled);
  require(json.ok() && json->is_object() && filled->size() <= kMaxTaskData, "filled data are a node's data");
  for (const ValueFrom& value : task.values) {
    require(value.parameter == "_comment" || json->find(value.parameter) != nullptr, "each value is put in");
  }
}

void take(const Value& json, const std::string& result) {
  ConfigFaults faults;
  const Scenario scenario = read_scenario(json, "s.json", faults);
  check_faults(faults);
  if (!faults.empty()) return;
  require(check_graph(scenario).ok(), "what is accepted is a graph");
  const Bytes bytes = encode(scenario);
  const auto again = decode<Scenario>(bytes);
  require(again.ok() && *again == scenario && encode(*again) == bytes, "it stays the same on the wire");
  check_fleet(scenario);
  for (const Task& task : scenario.tasks) {
    if (!is_repetition(task.id)) check_values(task, result);
  }
}

/// A task that is mostly valid: mutated JSON rarely is.
std::string task_of(Bits& bits, std::size_t number) {
  std::string out =
      R"({"id":"t)" + std::to_string(number) + R"(","skill":")" + bits.one_of({"go_to", "pose", "x"}) + "\"";
  out += bits.one_of({R"(,"robot":"a")", R"(,"requires":["mobile"])", R"(,"robot":"b","requires":["fly"])", ""});
  out += bits.one_of({"", R"(,"retries":3,"retry_after_s":0.5)", R"(,"on_failure":"skip")", R"(,"retries":17)",
                      R"(,"pinned":true,"timeout_s":2)",
                      R"(,"when":{"sensor":"temperature","op":">","value":20,"unit":"degC"})"});
  const std::size_t before = bits.below(number + 1);
  if (before > 0) out += R"(,"after":["t)" + std::to_string(before - 1) + "\"]";
  const std::string from = R"({"from":"t)" + std::to_string(before > 0 ? before - 1 : 0) + "\"";
  switch (bits.below(4)) {
    case 0:
      out += R"(,"data":{"place":"dock","speed":0.5})";
      break;
    case 1:
      out += R"(,"data":{"place":)" + from + R"(,"value":"place"}})";
      break;
    case 2:
      out += R"(,"data":{"joints":)" + from + R"(},"side":"l"})";
      break;
    default:
      break;
  }
  return out + "}";
}

void build(BytesView input) {
  Bits bits(input);
  std::string text = R"({"name":"n","repeat":)" + std::to_string(bits.below(5)) + R"(,"tasks":[)";
  const std::size_t tasks = bits.below(12);
  for (std::size_t i = 0; i <= tasks; ++i) text += (i == 0 ? "" : ",") + task_of(bits, i);
  const auto json = parse_json(text + "]}");
  require(json.ok(), "the target writes JSON");
  take(*json, bits.rest());
}

}  // namespace

std::vector<Bytes> seeds() {
  return {R"({"name":"n","description":"d","repeat":3,"tasks":[{"id":"scan","robot":"a","skill":"go_to",
            "data":{"place":"dock","speed":1},"retries":2,"retry_after_s":0.5,"on_failure":"abort"},
            {"id":"carry","skill":"go_to","requires":["mobile"],"after":["scan"],"data":{"place":{"from":"scan",
            "value":"place"}},"timeout_s":5,"pinned":true,"on_failure":"skip","when":{"sensor":"temperature","of":"a",
            "op":"<=","value":20,"unit":"degC"}},{"id":"pose","robot":"b","skill":"pose","after":["scan","carry"],
            "data":{"joints":[1,2.5],"side":"l"}}]})",
          R"({"name":"n","tasks":[{"id":"x","robot":"a","skill":"s","after":["y"]},{"id":"y","robot":"a","skill":"s",
            "after":["x"],"data":{"p":{"from":"x"}}}]})",
          Bytes("\x02\x03\x00\x00\x00\x00\x00\x00\x01\x01\x01\x01\x01\x00\x02\x02\x02{\"place\":\"dock\"}", 33)};
}

void run(BytesView input) {
  build(input);
  const auto json = parse_json(input);
  if (json) take(*json, std::string(input.substr(0, 200)));
}

}  // namespace trb::fuzz
