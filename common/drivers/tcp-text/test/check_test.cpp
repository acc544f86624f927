// What `trb check` says of commands.json for tcp-text: of a Universal Robot, and of a robot that takes lines.
#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

constexpr const char* kMonitor = R"("monitor": {"protocol": "ur-primary", "port": 30001},)";
constexpr const char* kByTime = R"("time", "duration_s": 2)";
constexpr const char* kByState = R"("state", "state": "program_running", "equals": 0)";

/// "KEY: WHAT; HINT" of each fault.
std::string faults_of(const NodeFolder& folder) {
  std::string out;
  for (const ConfigFault& fault : without_keys(folder.check().faults))
    out += fault.key + ": " + fault.what + "; " + fault.hint + "\n";
  return out;
}

void end_by(const NodeFolder& folder, const std::string& end) {
  folder.change("robots/r.json", R"("acknowledgement")", end);
}

/// A robot that takes lines: no script, no monitor.
void speak_lines(const NodeFolder& folder, const std::string& more = "") {
  folder.write("commands.json", R"({"ur": {"transport": "tcp-text", "port": 30100, )" + more +
                                    R"("commands": {"go": "GO {data}", "stop": "HALT"}}})");
}

}  // namespace

TEST_CASE("an acknowledgement that a command never gets is a fault, with the cure for that robot") {
  const NodeFolder lines("ur");
  speak_lines(lines);
  CHECK(faults_of(lines) ==
        "ur.commands.go: has no end that the robot tells, and skill 'go' waits for one; give the skill an end of kind "
        "\"time\"\n");
  const NodeFolder unwrapped("ur");
  CHECK(faults_of(unwrapped) == "");
  unwrapped.change("commands.json", R"("wrap": "urscript-program",)", "");
  CHECK(faults_of(unwrapped) ==
        "ur.commands.go: has no end that the robot tells, and skill 'go' waits for one; add \"wrap\": "
        "\"urscript-program\" and \"monitor\": {\"protocol\": \"ur-primary\", \"port\": 30001}, or give the skill an "
        "end of kind \"time\"\n");
  const NodeFolder interface("ur");
  interface.change("commands.json", "movej({0}, a={1})", "power on");  // never a program
  CHECK(faults_of(interface) ==
        "ur.commands.go: has no end that the robot tells, and skill 'go' waits for one; give the skill an end of kind "
        "\"state\" or \"time\"\n");
  const NodeFolder blind("ur");
  blind.change("commands.json", kMonitor, "");
  blind.change("commands.json", R"(,
    "requests": {"position": "joints"})",
               "");
  CHECK(faults_of(blind).starts_with("ur.commands.go: has no end that the robot tells"));
}

TEST_CASE("a missing monitor is advised to a Universal Robot only") {
  const NodeFolder ur("ur");
  end_by(ur, kByTime);
  ur.change("commands.json", kMonitor, "");
  CHECK(faults_of(ur) ==
        "ur.requests: are answered from the monitor, but no monitor is configured; add \"monitor\": {\"protocol\": "
        "\"ur-primary\", \"port\": 30001}, or remove the requests\n");
  const NodeFolder asked("ur");
  end_by(asked, kByTime);
  speak_lines(asked, R"("requests": {"position": "joints"}, )");
  CHECK(faults_of(asked) ==
        "ur.requests: are answered from the monitor, but no monitor is configured; tcp-text reads nothing but a "
        "Universal Robot's monitor: remove the requests\n");
  const NodeFolder watched("ur");
  end_by(watched, kByState);
  speak_lines(watched);
  CHECK(faults_of(watched) ==
        "ur.monitor: is missing: the end of skill 'go' is seen by it; tcp-text reads nothing but a Universal Robot's "
        "monitor: give the skill an end of kind \"time\"\n");
}
