// What commands.json may contain for a drone, and the faults that trb check reports for the rest.
#include "common/drivers/udp-at/syntax.hpp"

#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

constexpr const char* kProfile = R"({"ardrone": "direct"})";
constexpr const char* kCommands = R"json({"ardrone": {"port": 5556, "transport": "udp-at",
  "monitor": {"protocol": "ar-navdata", "port": 5554},
  "commands": {"go": "REF take_off", "stop": "hover", "release": "", "move": "PCMD {0} {1} {2} {3} for 2",
    "lights": "LED {0} 2 3", "both": "FTRIM\nREF land"},
  "values": {"up": "altitude"}, "requests": {"height": "up"}}})json";
constexpr const char* kRobot = R"({"maker": "m", "model": "n", "capabilities": ["fly"],
  "skills": {"go": {"capability": "fly", "end": {"kind": "acknowledgement"}}}})";

struct Change {
  std::string file, from, to, key, what;
};

ConfigFaults faults_of(const std::string& file = {}, const std::string& from = {}, const std::string& to = {}) {
  const NodeFolder folder("ardrone");
  folder.write("profile.json", kProfile);
  folder.write("commands.json", kCommands);
  folder.write("robots/r.json", kRobot);
  if (!file.empty()) folder.change(file, from, to);
  return without_keys(folder.check(true).faults);
}

std::string fault_of(const std::string& words) {
  const auto lines = read_at_lines(words);
  return lines ? "" : lines.error().text();
}

}  // namespace

TEST_CASE("AT words: a command of the maker's a line, its arguments of their types") {
  CHECK(fault_of("REF take_off").empty());
  CHECK(fault_of("FTRIM\nREF take_off\n").empty());
  CHECK(fault_of("  hover   for  {data} ").empty());
  CHECK(fault_of("PCMD 0 -0.8 {0} 1").empty());
  CHECK(fault_of(R"(CONFIG "control:flight_anim" "18,15")").empty());
  CHECK(fault_of(R"(CONFIG {0} {1})").empty());
  const auto lines = read_at_lines("LED {0} 2 {data}");
  REQUIRE(lines.ok());
  CHECK(lines->front().arguments[0].item == 0);
  CHECK(lines->front().arguments[1].item == AtArgument::kLiteral);
  CHECK(lines->front().arguments[2].item == AtArgument::kWhole);
  CHECK(at_tells_end(read_at_lines("hover for 3")->front()));
  CHECK_FALSE(at_tells_end(read_at_lines("hover")->front()));
}

TEST_CASE("AT words: what is wrong is said with a cure") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"REF takeoff", "did you mean 'take_off'"},
      {"REF", "what the drone shall do"},
      {"PCDM 0 0 0 0", "did you mean 'PCMD'"},
      {"REF=1,290718208", "is no AT command"},
      {"COMWDG", "is no AT command"},
      {"PCMD 0 0 0", "has 3 arguments, where 4 are needed"},
      {"PCMD 0 0 0 2", "from -1 to 1"},
      {"PCMD 0 0 0 fast", "is no argument"},
      {"LED 1.5 2 3", "no whole number"},
      {"CONFIG \"k\" \"v", "without its second quote"},
      {"CONFIG \"k\" \"a{0}\"", "without quotes"},
      {"FTRIM for 3", "remove \"for\""},
      {"hover for 0", "more than 0"},
      {"hover for", "has 1 arguments"},
      {"REF take_off\nhover for 3", "one at a time"},
      {"FTRIM\nFTRIM\nFTRIM\nFTRIM\nFTRIM\nFTRIM\nFTRIM\nFTRIM\nFTRIM", "more than 8 lines"}};
  for (const auto& [words, said] : cases) {
    const std::string fault = fault_of(words);
    CHECK_MESSAGE(fault.find(said) != std::string::npos, fault);
  }
}

TEST_CASE("a drone's commands.json: every fault with its key") {
  CHECK_MESSAGE(faults_of().empty(), to_text(faults_of()));
  const std::vector<Change> changes = {
      {"commands.json", R"("port": 5556, )", "", "ardrone.port", "is missing"},
      {"commands.json", R"("monitor": {"protocol": "ar-navdata", "port": 5554},)", "", "ardrone.monitor", "is missing"},
      {"commands.json", "ar-navdata", "ur-primary", "ardrone.monitor", "is missing"},
      {"commands.json", R"("stop": "hover", )", "", "ardrone.commands.stop", "must say how it is stopped"},
      {"commands.json", R"("stop": "hover")", R"("stop": "REF emergency")", "ardrone.commands.stop", "stops no drone"},
      {"commands.json", R"("stop": "hover")", R"("stop": "hover for 3")", "ardrone.commands.stop", "stops no drone"},
      {"commands.json", R"("release": "")", R"("release": "REF land")", "ardrone.commands.release", "moves no drone"},
      {"commands.json", "REF take_off", "REF takeoff", "ardrone.commands.go", "what the drone shall do"},
      {"commands.json", R"("altitude")", R"("altitud")", "ardrone.values.up", "nothing that navdata tells"},
      {"commands.json", R"("height": "up")", R"("height": "upp")", "ardrone.requests.height", "nothing that navdata"},
      {"commands.json", R"("go": "REF take_off")", R"("fly": "REF take_off")", "ardrone.commands.go", "skill 'go'"},
      {"commands.json", R"("go": "REF take_off")", R"("go": "FTRIM")", "ardrone.commands.go", "has no end"},
      {"robots/r.json", R"("acknowledgement")", R"("state", "state": "high", "equals": 1)", "ardrone.commands.go",
       "nothing that navdata"}};
  for (const Change& one : changes) {
    CAPTURE(one.to);
    const ConfigFaults faults = faults_of(one.file, one.from, one.to);
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
    CHECK_MESSAGE(faults[0].what.find(one.what) != std::string::npos, faults[0].what);
  }
}
