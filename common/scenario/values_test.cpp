#include "common/scenario/values.hpp"

#include <doctest/doctest.h>

#include <map>

#include "proto/value.hpp"

using namespace trb;

namespace {

Task task_with(std::string data, std::vector<ValueFrom> values) {
  Task out;
  out.id = "carry";
  out.data = std::move(data);
  out.values = std::move(values);
  return out;
}

TaskResult result(std::string data, TaskOutcome outcome = TaskOutcome::finished) {
  TaskResult out;
  out.outcome = outcome;
  out.data = std::move(data);
  return out;
}

using Told = std::map<std::string, TaskResult>;

Result<std::string> fill(const Task& task, const Told& results) {
  return fill_values(task, [&](const std::string& id) {
    const auto at = results.find(id);
    return at == results.end() ? nullptr : &at->second;
  });
}

Error error_of(const Task& task, const Told& results) {
  const auto filled = fill(task, results);
  REQUIRE_FALSE(filled.ok());
  CHECK(filled.error().what.find("'carry'") != std::string::npos);
  CHECK_FALSE(filled.error().hint.empty());
  return filled.error();
}

}  // namespace

TEST_CASE("a task without values keeps its data to the byte") {
  CHECK(*fill(task_with("", {}), {}) == "");
  CHECK(*fill(task_with(R"({ "b" : 1 })", {}), {}) == R"({ "b" : 1 })");
}

TEST_CASE("values of results stand behind what the file gives, in their order") {
  const Task task = task_with(R"({"speed":1})", {{"to", "scan", "place"}, {"box", "weigh", ""}});
  const Told results{{"scan", result(R"({"place":"dock","n":7})")}, {"weigh", result("[2.5,\"kg\"]")}};
  CHECK(*fill(task, results) == R"({"speed":1,"to":"dock","box":[2.5,"kg"]})");
  CHECK(*fill(task_with("", {{"box", "weigh", ""}}), results) == R"({"box":[2.5,"kg"]})");
  CHECK(*fill(task_with("{}", {{"box", "weigh", ""}}), {{"weigh", result("null")}}) == R"({"box":null})");
}

TEST_CASE("what has no value names task and parameter") {
  const Task task = task_with("", {{"to", "scan", "place"}});
  const auto refused = [&](const Told& results) {
    const Error error = error_of(task, results);
    CHECK(error.what.starts_with("task 'carry', parameter 'to': "));
    CHECK(error.what.find("'scan'") != std::string::npos);
    return error.code;
  };
  CHECK(refused({}) == Errc::missing);
  CHECK(refused({{"scan", result("")}}) == Errc::missing);
  CHECK(refused({{"scan", result("", TaskOutcome::skipped)}}) == Errc::missing);
  CHECK(refused({{"scan", result(R"({"place":"a"})", TaskOutcome::failed)}}) == Errc::missing);
  CHECK(refused({{"scan", result("{}")}}) == Errc::missing);
  CHECK(refused({{"scan", result("\"dock\"")}}) == Errc::bad_value);
  CHECK(refused({{"scan", result("dock")}}) == Errc::malformed);
  CHECK(error_of(task, {{"scan", result(R"({"plcae":"a"})")}}).hint == "did you mean 'plcae'?");
}

TEST_CASE("values that no robot's node would take") {
  const Task task = task_with("", {{"to", "scan", ""}});
  const std::string deep = std::string(31, '[') + std::string(31, ']');
  REQUIRE(fill(task, {{"scan", result(deep)}}).ok());
  CHECK(parse_json(*fill(task, {{"scan", result(deep)}})).ok());
  CHECK(error_of(task, {{"scan", result("[" + deep + "]")}}).code == Errc::too_large);
  CHECK(error_of(task, {{"scan", result("\"" + std::string(kMaxTaskData - 2, 'x') + "\"")}}).code == Errc::too_large);
  CHECK(error_of(task_with("[1]", {{"to", "scan", ""}}), {}).code == Errc::malformed);
  CHECK(error_of(task_with(R"({"to":1})", {{"to", "scan", ""}}), {{"scan", result("1")}}).code == Errc::duplicate);
}
