#include <doctest/doctest.h>

#include "common/fleet/description.hpp"

using namespace trb;

namespace {

struct ReadDrives {
  Description is;
  ConfigFaults faults;
};

ReadDrives drives_of(const std::string& drives, const std::string& more = {}) {
  const std::string text =
      R"({"maker":"m","model":"n","capabilities":["mobile"],"skills":{},)" + more + R"("drives":)" + drives + "}";
  const auto json = parse_json(text);
  REQUIRE_MESSAGE(json.ok(), text);
  ReadDrives out;
  out.is = read_description(*json, "r.json", out.faults);
  return out;
}

/// The one fault of a drive with these keys.
ConfigFault drive_fault(const std::string& keys) {
  const ConfigFaults faults = drives_of("[{" + keys + "}]").faults;
  REQUIRE_MESSAGE(faults.size() == 1, (keys + "\n" + to_text(faults)));
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0];
}

const std::string kDriveBase = R"("part": "base", "capability": "mobile", )";
const std::string kDriveAxes = R"("axes": {"x": 0.5, "yaw": 1}, )";
const std::string kDriveWords = R"("command": {"subtype": "drive", "data": "[{x}, {yaw}]"})";

}  // namespace

TEST_CASE("a drive: its part, its axes in their order, its words") {
  const auto read =
      drives_of("[{" + kDriveBase + R"("axes": {"x": 0.5, "yaw": {"limit": 1, "factor": -2, "one_way": true}},)" +
                kDriveWords + R"(, "stand": {"subtype": "halt"}}])");
  CHECK(to_text(read.faults).empty());
  REQUIRE(read.is.drives.size() == 1);
  const Drive& drive = *read.is.find_drive(DrivePart::base);
  CHECK(drive.info() == DriveInfo{DrivePart::base, {"x", "yaw"}, {0.5, 1}});
  CHECK(drive.axes[1].factor == -2.0);
  CHECK(drive.axes[1].one_way);
  CHECK(drive.command.subtype == "drive");
  CHECK(drive.command.capability == "mobile");
  CHECK(drive.command.parameters[0].unit == "m/s");
  CHECK(drive.command.parameters[1].unit.empty());  // the factor counts, not the frame
  CHECK(drive.stand->subtype == "halt");
  CHECK(read.is.find_drive(DrivePart::belt) == nullptr);
}

TEST_CASE("joints have names of their own, in rad/s") {
  const auto read = drives_of(R"([{"part": "joints", "capability": "mobile", "axes": {"x": 1, "wrist": 2},
                                   "command": {"subtype": "j", "data": "{x} {wrist}"}}])");
  CHECK(to_text(read.faults).empty());
  CHECK(read.is.drives[0].command.parameters[0].unit == "rad/s");
}

TEST_CASE("every fault of a drive is told, with its key and a cure") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("part": "wheels", "capability": "mobile", )" + kDriveAxes + kDriveWords, "drives[0].part"},
      {R"("part": "base", )" + kDriveAxes + kDriveWords, "drives[0].capability"},
      {R"("part": "base", "capability": "fly", )" + kDriveAxes + kDriveWords, "drives[0].capability"},
      {kDriveBase + R"("command": {"subtype": "drive"})", "drives[0].axes"},
      {kDriveBase + R"("axes": {}, "command": {"subtype": "drive"})", "drives[0].axes"},
      {kDriveBase + R"("axes": {"w": 1}, "command": {"subtype": "drive", "data": "{w}"})", "drives[0].axes.w"},
      {R"("part": "belt", "capability": "mobile", "axes": {"y": 1}, "command": {"subtype": "drive", "data": "{y}"})",
       "drives[0].axes.y"},
      {R"("part": "joints", "capability": "mobile", "axes": {"1": 1}, "command": {"subtype": "d", "data": "{}"})",
       "drives[0].axes.1"},
      {kDriveBase + R"("axes": {"x": 0, "yaw": 1}, )" + kDriveWords, "drives[0].axes.x"},
      {kDriveBase + R"("axes": {"x": -1, "yaw": 1}, )" + kDriveWords, "drives[0].axes.x"},
      {kDriveBase + R"("axes": {"x": "fast", "yaw": 1}, )" + kDriveWords, "drives[0].axes.x"},
      {kDriveBase + R"("axes": {"x": {}, "yaw": 1}, )" + kDriveWords, "drives[0].axes.x.limit"},
      {kDriveBase + R"("axes": {"x": {"limit": 1, "factor": 0}, "yaw": 1}, )" + kDriveWords, "drives[0].axes.x.factor"},
      {kDriveBase + R"("axes": {"x": {"limit": 1, "speed": 0}, "yaw": 1}, )" + kDriveWords, "drives[0].axes.x.speed"},
      {kDriveBase + kDriveAxes + R"("command": {"data": "{x} {yaw}"})", "drives[0].command.subtype"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "1", "data": "{x} {yaw}"})", "drives[0].command.subtype"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "stop", "data": "{x} {yaw}"})", "drives[0].command.subtype"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "drive", "data": "{x} {yaw} {z}"})",
       "drives[0].command.data"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "drive", "data": "{x} {yaw} {yaw.x}"})",
       "drives[0].command.data"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "drive", "data": "{x}"})", "drives[0].command.data"},
      {kDriveBase + kDriveAxes + R"("command": {"subtype": "drive", "data": "{x} {yaw"})", "drives[0].command.data"},
      {kDriveBase + kDriveAxes + kDriveWords + R"(, "stand": {"subtype": "halt", "data": "{x}"})",
       "drives[0].stand.data"},
      {kDriveBase + kDriveAxes + kDriveWords + R"(, "stand": {})", "drives[0].stand.subtype"},
      {kDriveBase + kDriveAxes + kDriveWords + R"(, "speed": 1)", "drives[0].speed"}};
  for (const auto& [keys, key] : cases) {
    const std::string given = keys;
    CAPTURE(given);
    if (key == "drives[0].axes.1") {
      CHECK(drives_of("[{" + keys + "}]").faults.front().key == key);
    } else {
      CHECK(drive_fault(keys).key == key);
    }
  }
}

TEST_CASE("a part is driven in one way only, and there are four parts") {
  const std::string drive = "{" + kDriveBase + kDriveAxes + kDriveWords + "}";
  CHECK(drives_of("[" + drive + "," + drive + "]").faults.at(0).key == "drives[1].part");
  CHECK(drives_of("[" + drive + "," + drive + "," + drive + "," + drive + "," + drive + "]").faults.at(0).key ==
        "drives");
  CHECK(drives_of("{}").faults.at(0).key == "drives");
}

TEST_CASE("a controller that reads numbers needs one for the drive's subtype, and no words in its data") {
  const std::string channel =
      R"("field_channel": {"encoding": "numeric", "codes": {"subtypes": {"done": 1, "failed": 2}}},)";
  const auto read = drives_of("[{" + kDriveBase + kDriveAxes + kDriveWords + "}]", channel);
  REQUIRE(read.faults.size() == 2);
  CHECK(read.faults[0].key == "field_channel.codes.subtypes.drive");
  CHECK(read.faults[1].key == "drives[0].command.data");
}
