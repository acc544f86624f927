// Stored scenarios alone: their outline, versions and bounds.
#include "services/cloud-gateway/core/scenarios/scenario_shelf.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr UtcTime kNow{1'800'000'000'000'000'000};

ScenarioText draft(const std::string& text) {
  auto read = read_draft(text);
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  return *read;
}

ScenarioText draft_of_size(std::size_t size) {
  std::string text = R"({"name": "long", "tasks": [], "description": ")";
  text.append(size - text.size() - 2, 'x');
  return draft(text + "\"}");
}

void check_refused(const std::string& text, Errc code, const std::string& about) {
  CAPTURE(text.substr(0, 80));
  const auto read = read_draft(text);
  REQUIRE_FALSE(read.ok());
  CHECK(read.error().code == code);
  CHECK(read.error().what.find(about) != std::string::npos);
  CHECK_FALSE(read.error().hint.empty());
}

}  // namespace

TEST_CASE("a draft is kept byte by byte, whatever its tasks are worth") {
  const std::string text = "{ \"tasks\" : [ {\"skill\": 5, \"_comment\": \"later\"} ],\n  \"name\":\"a \\u00e9\" }\n";
  const ScenarioText read = draft(text);
  CHECK(read.text == text);
  CHECK(read.name == "a \xc3\xa9");
  CHECK(read.tasks == 1);
}

TEST_CASE("what has no outline of a scenario is refused, and told why") {
  check_refused("", Errc::malformed, "");
  check_refused("{", Errc::malformed, "");
  check_refused("[]", Errc::bad_value, "no object");
  check_refused(R"({"tasks": []})", Errc::missing, "name:");
  check_refused(R"({"name": 5, "tasks": []})", Errc::bad_value, "name:");
  check_refused(R"({"name": "", "tasks": []})", Errc::bad_value, "name:");
  check_refused(R"({"name": ")" + std::string(65, 'n') + R"(", "tasks": []})", Errc::bad_value, "name:");
  check_refused(R"({"name": "a"})", Errc::missing, "tasks:");
  check_refused(R"({"name": "a", "tasks": {}})", Errc::bad_value, "tasks:");
  check_refused(R"({"name": "a", "tasks": [{}, 5]})", Errc::bad_value, "tasks[1]:");
  check_refused(R"({"name": "a", "name": "b", "tasks": []})", Errc::duplicate, "name");
  check_refused(std::string(kMaxScenarioSize + 1, ' '), Errc::too_large, "bytes");
}

TEST_CASE("1,000 tasks fit, one more does not") {
  std::string tasks = "{}";
  for (int i = 1; i < 1000; ++i) tasks += ",{}";
  CHECK(draft(R"({"name": "a", "tasks": [)" + tasks + "]}").tasks == 1000);
  check_refused(R"({"name": "a", "tasks": [)" + tasks + ",{}]}", Errc::too_large, "tasks:");
}

TEST_CASE("a scenario is added, changed and removed, and each is a change to store") {
  ScenarioShelf shelf(Parts::counted_bytes());
  const auto added = shelf.add(draft(R"({"name": "one", "tasks": []})"), "olga", kNow);
  REQUIRE(added);
  const std::string id = (*added)->id;
  CHECK(id.size() == 16);
  CHECK((*added)->version == 1);
  const auto changed = shelf.change(id, draft(R"({"name": "two", "tasks": [{}]})"), "otto", {kNow.ns + 1});
  REQUIRE(changed);
  CHECK(**changed == StoredScenario{id, draft(R"({"name": "two", "tasks": [{}]})"), 2, "otto", {kNow.ns + 1}});
  REQUIRE(shelf.remove(id));
  CHECK(shelf.find(id) == nullptr);
  const auto changes = shelf.take_changes();
  REQUIRE(changes.size() == 3);
  CHECK(changes[1].row == StoredScenario{id, draft(R"({"name": "two", "tasks": [{}]})"), 2, "otto", {kNow.ns + 1}});
  CHECK_FALSE(changes[2].row);
  CHECK(shelf.take_changes().empty());
}

TEST_CASE("an unknown scenario is neither changed nor removed") {
  ScenarioShelf shelf(Parts::counted_bytes());
  CHECK(shelf.change("0", draft(R"({"name": "a", "tasks": []})"), "olga", kNow).error().code == Errc::missing);
  CHECK(shelf.remove("0").error().code == Errc::missing);
  CHECK(shelf.take_changes().empty());
}

TEST_CASE("the number of scenarios is bounded, and a removed one makes room") {
  ScenarioShelf shelf(Parts::counted_bytes());
  const ScenarioText text = draft(R"({"name": "a", "tasks": []})");
  for (std::size_t i = 0; i < kMaxScenarios; ++i) REQUIRE(shelf.add(text, "olga", kNow));
  CHECK(shelf.add(text, "olga", kNow).error().code == Errc::queue_full);
  REQUIRE(shelf.remove(shelf.all().begin()->first));
  CHECK(shelf.add(text, "olga", kNow));
}

TEST_CASE("their bytes are bounded together; a smaller text makes room, a restored one takes it") {
  ScenarioShelf shelf(Parts::counted_bytes());
  const ScenarioText largest = draft_of_size(kMaxScenarioSize);
  for (std::size_t i = 0; i < kMaxScenarioSizes / kMaxScenarioSize - 1; ++i) REQUIRE(shelf.add(largest, "olga", kNow));
  shelf.restore({"0123456789abcdef", largest, 7, "olga", kNow});
  const ScenarioText small = draft(R"({"name": "a", "tasks": []})");
  CHECK(shelf.add(small, "olga", kNow).error().code == Errc::queue_full);
  REQUIRE(shelf.change("0123456789abcdef", small, "olga", kNow));
  CHECK(shelf.find("0123456789abcdef")->version == 8);
  CHECK(shelf.add(small, "olga", kNow));
  CHECK(shelf.change("0123456789abcdef", largest, "olga", kNow).error().code == Errc::queue_full);
}
