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

TEST_CASE("an empty word names nothing: an unset variable of a script meant some run, not the newest") {
  const Error refused = parse_arguments(kStop, {""}).error();
  CHECK(refused.code == Errc::bad_value);
  CHECK(refused.what == "the first word is empty");
  CHECK(refused.hint.find("is a variable of a script not set?") == 0);
}

TEST_CASE("a number is positive, and within its bound") {
  const auto given = [](const std::string& text) { return *parse_arguments(kStop, {"--timeout", text}); };
  CHECK(*given("36500").number("--timeout", 3, 36500) == 36500);
  CHECK(*parse_arguments(kStop, {})->number("--timeout", 3, 36500) == 3);
  for (const std::string bad : {"0", "-1", "soon", "nan"}) {
    CHECK(given(bad).number("--timeout", 3).error().what == "--timeout: '" + bad + "' is no positive number");
  }
  const Error over = given("36501").number("--timeout", 3, 36500).error();
  CHECK(over.what == "--timeout: '36501' is over 36500");
  CHECK(over.hint == "use at most 36500");
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

TEST_CASE("of an option that is given several times every value is kept, in its order") {
  const auto given = parse_arguments(kStop, {"--timeout", "1", "--timeout=2"});
  REQUIRE(given.ok());
  CHECK(given->get("--timeout") == "2");
  CHECK(given->every.at("--timeout") == std::vector<std::string>{"1", "2"});
}
