#include "services/cloud-gateway/io/skill_schemas.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace trb;
using namespace trb::gateway;

namespace {

std::string schema_of(const ParameterInfo& parameter) {
  NodeProfile profile;
  profile.places = {"dock", "table"};
  profile.skills = {{.name = "do", .capability = "c", .parameters = {parameter}}};
  const Value schemas = skill_schemas(profile);
  const Value* of = schemas.find("do")->find("properties")->find(parameter.name);
  return dump_json(*of);
}

}  // namespace

TEST_CASE("each type of a parameter has its schema, with bounds, choices and unit") {
  constexpr double kOpen = std::numeric_limits<double>::max();
  CHECK(schema_of({.name = "t", .type = "number", .unit = "s", .range = {0.1, 300}}) ==
        R"({"type":"number","minimum":0.1,"maximum":300.0,"x-unit":"s"})");
  CHECK(schema_of({.name = "n", .type = "integer", .range = {1, kOpen}}) == R"({"type":"integer","minimum":1.0})");
  CHECK(schema_of({.name = "n", .type = "number", .range = {-kOpen, kOpen}}) == R"({"type":"number"})");
  CHECK(schema_of({.name = "j", .type = "numbers", .count = 6}) ==
        R"({"type":"array","items":{"type":"number"},"minItems":6,"maxItems":6})");
  CHECK(schema_of({.name = "b", .type = "bool"}) == R"({"type":"boolean"})");
  CHECK(schema_of({.name = "p", .type = "place"}) == R"({"type":"string","enum":["dock","table"]})");
  CHECK(schema_of({.name = "p", .type = "place", .one_of = {"dock"}}) == R"({"type":"string","enum":["dock"]})");
  CHECK(schema_of({.name = "w", .type = "text"}) == R"({"type":"string"})");
  CHECK(schema_of({.name = "w", .type = "later"}) == "{}");
}

TEST_CASE("what is required is listed, nothing else is allowed, and a name is only ever a name") {
  NodeProfile profile;
  profile.skills = {
      {.name = R"(a":1,"b)", .capability = "c", .parameters = {{"x", "text", true}, {"y", "text", false}}}};
  const Value schemas = skill_schemas(profile);
  const auto again = parse_json(dump_json(schemas));
  REQUIRE(again);
  CHECK(again->object().size() == 1);
  const Value* schema = again->find(R"(a":1,"b)");
  REQUIRE(schema != nullptr);
  CHECK(dump_json(*schema->find("required")) == R"(["x"])");
  CHECK_FALSE(schema->find("additionalProperties")->boolean());
}
