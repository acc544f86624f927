// A description checked by itself: which files are read, which commands fit, and one fault of each kind.
#include <doctest/doctest.h>

#include "common/config/robot_check.hpp"
#include "common/drivers/registry.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

RobotFiles files_of(const NodeFolder& folder, const std::string& framework = "") {
  return {folder.path() + "/robots/r.json", "", "", "", framework};
}

ConfigFault only_fault(const RobotFiles& files) {
  const ConfigFaults faults = check_robot_files(files, drivers::robot_transports()).faults;
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0];
}

struct RobotChange {
  std::string file, from, to, key, what;
};

}  // namespace

TEST_CASE("a good description is told with the frameworks whose words fit") {
  const NodeFolder folder("ur");
  const RobotCheck check = check_robot_files(files_of(folder), drivers::robot_transports());
  CHECK_MESSAGE(check.faults.empty(), to_text(check.faults));
  CHECK(check.absent.empty());
  CHECK(check.places.contains("dock"));
  REQUIRE(check.spoken_to.size() == 1);
  CHECK(check.spoken_to[0].framework == "ur");
  CHECK(check.spoken_to[0].transport == "tcp-text");
}

TEST_CASE("a description in a node's folder is checked with its framework's words, however many others would fit") {
  const NodeFolder folder("lines");
  folder.change("robots/r.json", R"("skills")", R"("field_channel": {}, "skills")");
  const RobotCheck check = check_robot_files(files_of(folder), drivers::robot_transports());
  CHECK_MESSAGE(check.faults.empty(), to_text(check.faults));
  REQUIRE(check.spoken_to.size() == 1);
  CHECK(check.spoken_to[0].framework == "lines");
  folder.change("node.json", R"("lines")", R"("line")");
  const ConfigFault fault = only_fault(files_of(folder));
  CHECK(fault.file.ends_with("node.json"));
  CHECK(fault.key == "framework");
}

TEST_CASE("what a KUKA's own words lack is told, though its description has fields") {
  const NodeFolder folder("lines");
  folder.change("node.json", R"("lines")", R"("kuka")");
  folder.change("profile.json", R"("lines")", R"("kuka": "direct", "lines")");
  folder.change("robots/r.json", R"("skills")", R"("field_channel": {}, "skills")");
  const std::string words = R"json("kuka": {"transport": "c3", "port": 7000, "commands": {"stop": "TRB_STOP = TRUE",
    "move": "A = {0}"}}, )json";
  folder.change("commands.json", R"("ur": {)", words + R"("ur": {)");
  const auto frameworks = [&] {
    const RobotCheck check = check_robot_files(files_of(folder), drivers::robot_transports());
    CHECK_MESSAGE(check.faults.empty(), to_text(check.faults));
    std::vector<std::string> names;
    for (const SpokenTo& one : check.spoken_to) names.push_back(one.framework);
    return names;
  };
  CHECK(frameworks() == std::vector<std::string>{"kuka"});
  folder.change("commands.json", "A = {0}", "A = {nothing}");
  CHECK(only_fault(files_of(folder)).key.find("kuka.commands") == 0);
  folder.change("commands.json", "A = {nothing}", "A = {0}");
  folder.remove("node.json");
  CHECK(frameworks() == std::vector<std::string>{"abb", "kuka", "lines", "ur"});
}

TEST_CASE("a robot that speaks fields is served by the interpreter's frameworks") {
  const NodeFolder folder("lines");
  folder.remove("node.json");
  folder.change("robots/r.json", R"("skills")", R"("field_channel": {}, "skills")");
  folder.change("robots/r.json", R"("command": {"data")", R"("command": {"subtype": "drive", "data")");
  const RobotCheck check = check_robot_files(files_of(folder), drivers::robot_transports());
  CHECK_MESSAGE(check.faults.empty(), to_text(check.faults));
  REQUIRE(check.spoken_to.size() == 2);
  CHECK(check.spoken_to[0].framework == "abb");
  CHECK(check.spoken_to[1].framework == "lines");
}

TEST_CASE("files that are not there are not checked, unless they are named") {
  const NodeFolder folder("ur");
  folder.remove("places.json");
  folder.remove("commands.json");
  CHECK(check_robot_files(files_of(folder), drivers::robot_transports()).absent ==
        std::vector<std::string>{"places.json", "commands.json"});
  RobotFiles named = files_of(folder);
  named.places = folder.path() + "/hall.json";
  CHECK(only_fault(named).what.find("no such file") != std::string::npos);
}

TEST_CASE("one fault of each kind, with its file and key") {
  const std::string robot = "robots/r.json";
  const std::vector<RobotChange> changes = {
      {robot, R"("maker": "m", )", "", "maker", "is missing"},
      {robot, R"("model": "n")", R"("model": 3)", "model", "whole number"},
      {robot, R"(["mobile"])", R"(["mobile", "mo bile"])", "capabilities", "no capability"},
      {robot, R"("capability": "mobile")", R"("capability": "mobil")", "skills.go.capability", "'mobil'"},
      {robot, R"({"kind": "acknowledgement"})", R"({"kind": "ready"})", "skills.go.end.kind", "'ready'"},
      {robot, R"("end": {"kind": "acknowledgement"})", R"("repeatable": true)", "skills.go.end", "has no end"},
      {robot, R"("{place.x}")", R"("{plce.x}")", "skills.go.command.data", "plce"},
      {robot, R"("type": "place")", R"("type": "place", "one_of": ["dok"])", "skills.go.parameters.place", "'dok'"},
      {robot, R"("skills")", R"("skils": {}, "skills")", "skils", "no key"},
      {robot, R"("skills")", R"("frame": {"length_unit": "cm"}, "skills")", "frame.length_unit", "'cm'"},
      {robot, R"("skills")", R"("field_channel": {"framing": "tab"}, "skills")", "field_channel.framing", "'tab'"},
      {"commands.json", R"("stop": "stop program", )", "", "ur.commands.stop", "is missing"},
      {"commands.json", R"json("go": "movej({0}, a={1})", )json", "", "ur.commands.go", "skill 'go' sends it"},
      {"commands.json", R"("port": 30002, )", "", "ur.port", "is missing"},
      {"commands.json", R"({data})", R"({date})", "ur.commands.move", "{date} is no placeholder"},
      {"profile.json", R"("ur": "direct")", R"("ur": "directly")", "ur", "'directly'"},
      {"places.json", R"("x": 1, )", "", "places.dock.x", "is missing"},
  };
  for (const RobotChange& one : changes) {
    CAPTURE(one.to);
    const NodeFolder folder("ur");
    folder.change(one.file, one.from, one.to);
    const ConfigFaults faults = check_robot_files(files_of(folder, "ur"), drivers::robot_transports()).faults;
    REQUIRE_MESSAGE(!faults.empty(), one.key);
    CHECK_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].file.ends_with(one.file));
    CHECK(faults[0].key == one.key);
    CHECK_MESSAGE(faults[0].what.find(one.what) != std::string::npos, faults[0].what);
    CHECK_FALSE(faults[0].hint.empty());
  }
}

TEST_CASE("more places than the robot's profile takes are a fault of the hall's") {
  const NodeFolder folder("ur");
  std::string own;
  for (int i = 0; i < 255; ++i) own += (i == 0 ? "\"p" : ", \"p") + std::to_string(i) + "\": 1";
  folder.change("robots/r.json", R"("skills")", R"("places": {)" + own + R"(}, "skills")");
  const ConfigFault fault = only_fault(files_of(folder, "ur"));
  CHECK(fault.file.ends_with("places.json"));
  CHECK(fault.key == "places");
}

TEST_CASE("a file that is malformed is told with line and column") {
  const NodeFolder folder("ur");
  folder.write("robots/r.json", "{\n  \"a\": 1\n  \"b\": 2\n}");
  CHECK(only_fault(files_of(folder)).what.find("line 3, column 5") != std::string::npos);
}

TEST_CASE("words that fit nobody, and a framework that is not there") {
  const NodeFolder folder("ur");
  folder.change("robots/r.json", R"("command": {"data")", R"("command": {"subtype": "fly", "data")");
  CHECK(only_fault(files_of(folder)).key == "ur.commands.fly");  // of its node.json
  folder.remove("node.json");
  CHECK(only_fault(files_of(folder)).what.find("no framework of") != std::string::npos);
  CHECK(only_fault(files_of(folder, "urr")).hint == "did you mean 'ur'?");
  CHECK(only_fault(files_of(folder, "ur")).key == "ur.commands.fly");
}

TEST_CASE("a pose beyond the reach is named, as far as the description gives reach") {
  const NodeFolder folder("ur");
  folder.change("commands.json", R"("stop": "stop program")",
                R"json("stop": "stop program", "far": "movel(p[10, 0, 0, 0, 0, 0])")json");
  CHECK(check_robot_files(files_of(folder, "ur"), drivers::robot_transports()).faults.empty());
  folder.change("robots/r.json", R"("skills")", R"("numbers": {"reach": {"value": 0.5, "unit": "m"}}, "skills")");
  const ConfigFault fault = only_fault(files_of(folder, "ur"));
  CHECK(fault.key == "ur.commands.far");
  CHECK(fault.what.starts_with("the pose p[10, 0, 0, …] is 10 m away from the robot's foot"));
}

TEST_CASE("a place that a skill may send has the items that its command takes") {
  const auto faults_of = [](const std::string& words, const std::string& places, const std::string& one_of) {
    const NodeFolder folder("ur");
    folder.change("commands.json", R"json("movej({0}, a={1})")json", words);
    folder.change("robots/r.json", R"("skills")", R"("places": )" + places + R"(, "skills")");
    folder.change("robots/r.json", R"("type": "place")", R"("type": "place", "one_of": )" + one_of);
    folder.change("robots/r.json", "{place.x}", "{place}");
    return check_robot_files(files_of(folder, "ur"), drivers::robot_transports()).faults;
  };
  const std::string whole = R"json("movej({data}, a=1)")json";
  const std::string items = R"json("movej([{0}, {1}, {2}, 0, 0, 0])")json";
  const std::string good = R"({"left": [1, 2, 3, 4, 5, 6]})";
  CHECK(faults_of(whole, good, R"(["left"])").empty());
  CHECK(faults_of(items, good, R"(["left"])").empty());
  CHECK(faults_of("\"textmsg({data})\"", R"({"left": 1})", R"(["left", "dock"])").empty());
  const ConfigFaults three = faults_of(whole, R"({"left": [1, 2, 3]})", R"(["left"])");
  REQUIRE_MESSAGE(three.size() == 1, to_text(three));
  CHECK(three[0].key == "ur.commands.go");
  CHECK(three[0].what == "takes 6 items, and place 'left', which skill 'go' may send, has 3");
  CHECK(three[0].hint == "write places.left of the description with 6 numbers");
  CHECK(faults_of(items, R"({"left": [1, 2]})", R"(["left"])").size() == 1);
  const ConfigFaults words = faults_of(whole, good, R"(["left", "dock"])");
  REQUIRE_MESSAGE(words.size() == 1, to_text(words));
  CHECK(words[0].what ==
        "takes 6 items, and place 'dock', which skill 'go' may send, has no numbers of the robot's own");
  CHECK(words[0].hint ==
        "add 'dock' to \"places\" of the description, with 6 numbers, or take it out of the skill's one_of");
  // One that is nowhere is a fault of the description, and of no other file.
  CHECK(faults_of(whole, good, R"(["left", "middle"])").size() == 1);
}

TEST_CASE("a drive whose words commands.json does not have is told with the nearest one") {
  const NodeFolder folder("ur");
  folder.change("robots/r.json", R"("skills")",
                R"("drives": [{"part": "base", "capability": "mobile", "axes": {"x": 1}, "command": {"subtype": "mov",)"
                R"( "data": "{x}"}, "stand": {"subtype": "stand_still"}}], "skills")");
  const ConfigFaults faults = check_robot_files(files_of(folder, "ur"), drivers::robot_transports()).faults;
  REQUIRE_MESSAGE(faults.size() == 2, to_text(faults));
  CHECK(faults[0].key == "drives[0].command.subtype");
  CHECK(faults[0].what == "'mov' is no command that commands.json has under 'ur'");
  CHECK(faults[0].hint.find("move") != std::string::npos);
  CHECK(faults[1].key == "drives[0].stand.subtype");
}
