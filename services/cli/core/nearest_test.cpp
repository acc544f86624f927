#include "services/cli/core/nearest.hpp"

#include <doctest/doctest.h>

using trb::cli::edits_between;
using trb::cli::nearest;

TEST_CASE("edits: letters put in, left out, exchanged, and swapped with the next") {
  CHECK(edits_between("", "") == 0);
  CHECK(edits_between("", "abc") == 3);
  CHECK(edits_between("route", "route") == 0);
  CHECK(edits_between("rout", "route") == 1);
  CHECK(edits_between("routee", "route") == 1);
  CHECK(edits_between("roude", "route") == 1);
  CHECK(edits_between("roteu", "route") == 2);
  CHECK(edits_between("orute", "route") == 1);
}

TEST_CASE("nearest: what was probably meant, and nothing if it is far from all") {
  const std::vector<std::string> known{"robot", "route", "run", "up", "--timeout"};
  CHECK(nearest("rout", known) == "route");
  CHECK(nearest("robt", known) == "robot");
  CHECK(nearest("rnu", known) == "run");
  CHECK(nearest("--time-out", known) == "--timeout");
  CHECK(nearest("zebra", known).empty());
  CHECK(nearest("", known).empty());
  CHECK(nearest("x", known).empty());
  CHECK(nearest(std::string(100'000, 'r'), known).empty());
}
