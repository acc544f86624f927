#include "services/virtual-robots/kuka/variables.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::kuka;

namespace {

Variables some() {
  Variables variables;
  variables.declare("FLAG", Type::bool_, "FALSE");
  variables.declare("COUNT", Type::int_, "0");
  variables.declare("NAME", Type::text, "", 5);
  variables.declare("GOAL", Type::axis, "");
  variables.declare_live("$MODE_OP", [] { return std::string("#EX"); });
  return variables;
}

}  // namespace

TEST_CASE("values are written in their type, and read as the controller prints them") {
  Variables variables = some();
  CHECK(variables.write("flag", "true"));
  CHECK(variables.read("FLAG") == "TRUE");
  CHECK(variables.write("NAME[]", "\"a b\""));
  CHECK(variables.read("name[]") == "\"a b\"");
  CHECK(variables.write("GOAL", "{E6AXIS: A1 10, A3 -2.5}"));
  CHECK(variables.write("GOAL.A6", "7"));
  CHECK(variables.read("GOAL") ==
        "{E6AXIS: A1 10.0000, A2 0.0000, A3 -2.5000, A4 0.0000, A5 0.0000, A6 7.0000, E1 0.0000, E2 0.0000, "
        "E3 0.0000, E4 0.0000, E5 0.0000, E6 0.0000}");
  CHECK(variables.read("GOAL.A3") == "-2.5000");
  CHECK(variables.read("$MODE_OP") == "#EX");
}

TEST_CASE("what the controller refuses") {
  Variables variables = some();
  CHECK_FALSE(variables.read("NOBODY"));
  CHECK_FALSE(variables.read("NAME"));
  CHECK_FALSE(variables.read("FLAG[]"));
  CHECK_FALSE(variables.read("GOAL.X"));
  for (const auto& one : std::vector<std::pair<std::string, std::string>>{{"NOBODY", "1"},
                                                                          {"FLAG", "1"},
                                                                          {"COUNT", "1.5"},
                                                                          {"NAME[]", "plain"},
                                                                          {"NAME[]", "\"a\"b\""},
                                                                          {"NAME[]", "\"too long\""},
                                                                          {"GOAL", "{E6POS: X 1}"},
                                                                          {"GOAL", "{X 1}"},
                                                                          {"$MODE_OP", "#T1"}}) {
    CHECK_FALSE_MESSAGE(variables.write(one.first, one.second), one.first, " = ", one.second);
  }
}
