#include "common/config/sensor_files.hpp"

#include <doctest/doctest.h>

#include "common/base/files.hpp"
#include "tests/support/node_folder.hpp"
#include "tests/support/paths.hpp"

using namespace trb;

TEST_CASE("a node without rules for sensors has no fault") {
  const NodeFolder folder;
  CHECK(without_keys(folder.check().faults).empty());
}

TEST_CASE("the shipped rules are good") {
  ConfigFaults faults;
  const auto rules = read_sensor_files(test::source_dir() + "/config", faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
  REQUIRE(rules.size() == 8);
  CHECK(rules.front().file == "sensors/camera.json");
}

TEST_CASE("trb check tells the faults of every rule") {
  const NodeFolder folder;
  folder.write("sensors/a.json", "{");
  folder.write("sensors/b.json", R"({"match": {"subsystem": "w1"}, "read": "w1", "sensors": [{}]})");
  folder.write("sensors/notes.txt", "{");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(faults.size() == 2, to_text(faults));
  CHECK(faults[0].file == "sensors/a.json");
  CHECK(faults[1].file == "sensors/b.json");
  CHECK(faults[1].key == "sensors[0].kind");
}
