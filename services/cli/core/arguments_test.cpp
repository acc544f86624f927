#include "services/cli/core/arguments.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::cli;

namespace {

const Usage kStop{"stop [ROBOT ...]", "Stops robots.", {"--all|every robot", "--timeout S|how long (3)"}, {}, 0, 9};

}  // namespace

TEST_CASE("an option's value is the next word, or behind '='") {
  for (const std::vector<std::string>& given :
       {std::vector<std::string>{"ur3", "--timeout", "2"}, std::vector<std::string>{"--timeout=2", "ur3"}}) {
    const auto arguments = parse_arguments(kStop, given);
    REQUIRE(arguments.ok());
    CHECK(arguments->words == std::vector<std::string>{"ur3"});
    CHECK(*arguments->number("--timeout", 3) == 2);
    CHECK_FALSE(arguments->has("--all"));
  }
  CHECK(parse_arguments(kStop, {"--timeout"}).error().code == Errc::missing);
}

TEST_CASE("a switch has no value: who writes --all=false did not mean all") {
  for (const std::string word : {"--all=false", "--all=no", "--all=", "--all=true"}) {
    const auto refused = parse_arguments(kStop, {word});
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.error().code == Errc::bad_value);
    CHECK(refused.error().what == word + ": --all takes no value");
    CHECK(refused.error().hint == "write --all, or leave it out");
  }
}
