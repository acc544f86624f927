#include "services/cli/core/table.hpp"

#include <doctest/doctest.h>

using namespace trb::cli;

TEST_CASE("a table's columns are aligned, by what a terminal shows") {
  CHECK(format_table({{"ROBOT", "STATE"}, {"ur3", "ONLINE"}, {"größer", ""}}) ==
        "ROBOT   STATE\nur3     ONLINE\ngrößer\n");
  CHECK(format_table({}).empty());
}

TEST_CASE("a foreign text in a cell forges no row and no column") {
  CHECK(format_table({{"ROBOT", "WHY"}, {"ur3", "hot\nur5  ONLINE\r\tx"}}) ==
        "ROBOT  WHY\nur3    hot\\u000aur5  ONLINE\\u000d\\u0009x\n");
}
