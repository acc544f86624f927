// Whether a value fits a skill's parameter, and what is offered in its place.
#include "common/scenario/parameters.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

const std::vector<std::string> kPlaces = {"conveyor_entry", "dock", "left"};

std::string cure(const ParameterInfo& info, const std::string& word) {
  const Value value{word};
  return misfit_cure(misfit_of(info, value, kPlaces), info, value, kPlaces);
}

}  // namespace

TEST_CASE("only places that the skill takes and the robot knows are offered") {
  const ParameterInfo side{.name = "side", .type = "place", .one_of = {"left", "middle"}};
  CHECK(choices_of(side, kPlaces) == std::vector<std::string>{"left"});
  CHECK(cure(side, "middle") ==
        R"(add it to "places" of the robot's description (its own term), or to places.json if coordinates are sent; )"
        "or use one of: left");
  CHECK(cure(side, "dock") == "use one of: left");
  CHECK(cure(side, "lefd") == "did you mean 'left'?");
}

TEST_CASE("a skill that takes any place offers all that are known") {
  const ParameterInfo place{.name = "place", .type = "place"};
  CHECK(cure(place, "moon") == "add it to places.json of its node, or use one of: conveyor_entry, dock, left");
  CHECK(cure(place, "dok") == "did you mean 'dock'?");
}

TEST_CASE("the words of a text are offered as they are") {
  const ParameterInfo way{.name = "way", .type = "text", .one_of = {"fast", "slow"}};
  CHECK(choices_of(way, kPlaces) == way.one_of);
  CHECK(cure(way, "quick") == "use one of: fast, slow");
}

TEST_CASE("a value of another kind is told as a person says it") {
  const ParameterInfo place{.name = "place", .type = "place"};
  const auto told = [&](const char* json) {
    const Value value = *parse_json(json);
    return misfit_text(misfit_of(place, value, kPlaces), place, value, "cart");
  };
  CHECK(told("{}") == "is an object, not a place");
  CHECK(told("true") == "is true, not a place");
  CHECK(told("false") == "is false, not a place");
  CHECK(told("null") == "is null, not a place");
  CHECK(told("[]") == "is a list, not a place");
  CHECK(told("4") == "is a whole number, not a place");
}
