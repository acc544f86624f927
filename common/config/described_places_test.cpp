// The places that a robot's skills name.
#include "common/config/described_places.hpp"

#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

/// The faults of a UR's folder whose skill takes a place in this way.
ConfigFaults faults_of(const std::string& parameter, const std::string& data, const std::string& own = {}) {
  const NodeFolder folder("ur");
  folder.change("robots/r.json", R"("type": "place")", R"("type": "place", )" + parameter);
  folder.change("robots/r.json", R"({place.x})", data);
  if (!own.empty()) folder.change("robots/r.json", R"("skills")", R"("places": {)" + own + R"(}, "skills")");
  folder.change("commands.json", R"(movej({0}, a={1}))", "go({data})");
  return without_keys(folder.check().faults);
}

}  // namespace

TEST_CASE("a place that neither the description nor the hall knows is named, with what the robot knows") {
  const auto faults = faults_of(R"("one_of": ["left", "middle"])", "{place}", R"("left": "L", "right": "R")");
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK(faults[0].file == "robots/r.json");
  CHECK(faults[0].key == "skills.go.parameters.place");
  CHECK(faults[0].what == R"('middle' is no place: neither "places" of the description nor places.json has it)");
  CHECK(faults[0].hint ==
        R"(add it to "places" of the description, with the robot's own term for it, or use one of: left, right)");
}

TEST_CASE("a default is a place, too; a hall's place is sent by its name") {
  CHECK(faults_of(R"("default": "dok")", "{place}", R"("left": "L")").size() == 1);
  CHECK(faults_of(R"("one_of": ["dock"])", "{place}").empty());
  CHECK(faults_of(R"("one_of": ["left"])", "{place}", R"("left": "L")").empty());
}

TEST_CASE("coordinates are those of a place in the hall: the robot's own term has none") {
  const auto faults = faults_of(R"("one_of": ["left"])", "{place.y}", R"("left": "L")");
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK(faults[0].what == "the coordinates of 'left' are sent, and places.json has no such place");
  CHECK(faults[0].hint == "add it there with its pose, or use one of: dock");
}
