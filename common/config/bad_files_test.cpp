// The golden set of bad files: for each the file, the key and the fault, and that there is a hint.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>

#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

void check_cures(const ConfigFaults& faults) {
  for (const ConfigFault& fault : faults) {
    CAPTURE(to_text({fault}));
    CHECK_FALSE(fault.hint.empty());
  }
}

/// The folder's only fault, apart from the missing keys.
ConfigFault only_fault(const NodeFolder& folder, bool running = true) {
  const ConfigFaults faults = without_keys(folder.check(running).faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  check_cures(faults);
  return faults[0];
}

struct Change {
  std::string file, from, to, key, what;
};

/// Each change of a valid folder causes exactly this fault.
void check_changes(const std::string& framework, const std::vector<Change>& changes) {
  for (const Change& one : changes) {
    CAPTURE(one.to);
    const NodeFolder folder(framework);
    folder.change(one.file, one.from, one.to);
    const ConfigFault fault = only_fault(folder);
    CHECK(fault.file == one.file);
    CHECK(fault.key == one.key);
    CHECK_MESSAGE(fault.what.find(one.what) != std::string::npos, fault.what);
  }
}

/// places.json with so many places: p0, p1, ...
std::string hall_of(std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += (i == 0 ? "\"p" : ", \"p") + std::to_string(i) + R"(": {"x": 1, "y": 2})";
  }
  return R"({"places": {)" + text + "}}";
}

}  // namespace

TEST_CASE("no folder, and an empty one") {
  const NodeCheck nowhere = check_node_dir("/nowhere/at/all", true);
  REQUIRE(nowhere.faults.size() == 1);
  CHECK(nowhere.faults[0].file == "/nowhere/at/all");
  check_cures(nowhere.faults);
  const NodeFolder folder;
  folder.remove("node.json");
  folder.remove("network.json");
  const ConfigFaults faults = folder.check().faults;
  REQUIRE_MESSAGE(faults.size() == 2, to_text(faults));
  CHECK(faults[0].file == "node.json");
  CHECK(faults[1].file == "network.json");
  check_cures(faults);
}

TEST_CASE("a file that is missing") {
  for (const char* file : {"network.json", "profile.json", "commands.json", "places.json", "robots/r.json"}) {
    CAPTURE(file);
    const NodeFolder folder("ur");
    folder.remove(file);
    const ConfigFault fault = only_fault(folder);
    CHECK(fault.file == file);
    CHECK(fault.what.find("no such file") != std::string::npos);
  }
}

TEST_CASE("a file that is malformed is told with line and column") {
  for (const char* file :
       {"node.json", "network.json", "profile.json", "commands.json", "places.json", "robots/r.json"}) {
    CAPTURE(file);
    const NodeFolder folder("ur");
    folder.write(file, "{\n  \"a\": 1\n  \"b\": 2\n}");
    const ConfigFaults faults = without_keys(folder.check().faults);
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].file == file);
    CHECK(faults[0].what.find("line 3, column 5") != std::string::npos);
    check_cures(faults);
  }
}

TEST_CASE("a file that is empty, a list, too large, not UTF-8, too deep, or a folder") {
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string((1U << 20U) + 1, ' '), std::string("{\"a\xff\": 1}"),
        std::string(1000, '['), std::string("{\"a\":1,\"a\":2}")}) {
    for (const char* file :
         {"node.json", "network.json", "profile.json", "commands.json", "places.json", "robots/r.json"}) {
      CAPTURE(file);
      CAPTURE(text.substr(0, 20));
      const NodeFolder folder("ur");
      folder.write(file, text);
      const ConfigFaults faults = without_keys(folder.check().faults);
      REQUIRE_FALSE(faults.empty());
      CHECK(faults[0].file == file);
      check_cures(faults);
    }
  }
  const NodeFolder folder;
  folder.change("node.json", "robots/r.json", "robots");
  CHECK(only_fault(folder).file == "robots");
}

TEST_CASE("a description watches what the robot tells, and nothing else") {
  check_changes("ur", {{"robots/r.json", R"("skills":)",
                        R"("faults": {"off": {"value": "robot_mod", "equals": 3, "severity": "WARNING"}}, "skills":)",
                        "faults.off.value", "no value that commands.json names under 'ur'"},
                       {"robots/r.json", R"("skills":)", R"("sensors": ["robot_mode", "battery"], "skills":)",
                        "sensors", "'battery' is no value"}});
  const NodeFolder folder("ur");
  folder.change("robots/r.json", R"("skills":)", R"("sensors": ["robot_mode", "joints"], "skills":)");
  CHECK(without_keys(folder.check().faults).empty());
}

TEST_CASE("node.json: values") {
  const std::string key(64, '0');
  check_changes(
      "lines",
      {{"node.json", R"("id": "r1")", R"("id": "R 1")", "id", "is no id"},
       {"node.json", R"("id": "r1", )", "", "id", "is missing"},
       {"node.json", R"("id": "r1")", R"("id": 7)", "id", "whole number"},
       {"node.json", R"("beacon": true)", R"("beacon": "yes")", "beacon", "is a text"},
       {"node.json", R"("id": "r1")", R"("id": true)", "id", "is true"},
       {"node.json", R"("id": "r1")", R"("id": {})", "id", "is an object"},
       {"node.json", R"("beacon": true)", R"("becon": true)", "becon", "no key"},
       {"node.json", R"("framework": "lines")", R"("framework": "line")", "framework", "not in profile.json"},
       {"node.json", R"("framework": "lines", )", "", "framework", "is missing"},
       {"node.json", R"("description": "robots/r.json",)", "", "description", "is missing"},
       {"node.json", R"("id": "r1")", R"("id": "r1", "role": "boss")", "role", "'boss'"},
       {"node.json", R"("127.0.77.9")", R"("the-robot")", "robot.host", "no IPv4 address"},
       {"node.json", R"("host": "127.0.77.9", )", "", "robot.host", "is missing"},
       {"node.json", R"("interface": "lo")", R"("interface": "lo", "fault_injection": "6000")", "robot.fault_injection",
        "no address with a port"},
       {"node.json", R"("interface": "lo")", R"("interface": "lo", "fault_injection": "robot:6000")",
        "robot.fault_injection", "no address with a port"},
       {"node.json", R"("interface": "lo")", R"("interface": "eth99")", "robot.interface", "no interface"},
       {"node.json", R"("scheduler"])", R"("resilient"])", "services", "no service of this version"},
       {"node.json", R"("scheduler"])", R"("cloud-gateway"])", "services", "a robot's node has no cloud-gateway"},
       {"node.json", R"("scheduler"])", R"("router"])", "services[2]", "occurs twice"},
       {"node.json", R"(["router", )", "[", "services", "has no \"router\""},
       {"node.json", R"("seeds": [])", R"("seeds": [{"address": "10.0.0.1", "key": ")" + key + "\"}]",
        "seeds[0].address", "no HOST:PORT"},
       {"node.json", R"("seeds": [])", R"("seeds": [{"address": "10.0.0.1:70000", "key": ")" + key + "\"}]",
        "seeds[0].address", "no HOST:PORT"},
       {"node.json", R"("seeds": [])", R"("seeds": [{"address": "10.0.0.1:1", "key": "12"}])", "seeds[0].key",
        "no link key"},
       {"node.json", R"("seeds": [])",
        R"("seeds": [{"address": "a:1", "key": ")" + key + R"("}, {"address": "a:1", "key": ")" + key + "\"}]",
        "seeds[1].address", "occurs twice"}});
}

TEST_CASE("node.json: services of an operator's own have names of their own, and programs") {
  const std::string after = R"("seeds": [])";
  const auto own = [&](const std::string& json) { return after + R"(, "own_services": )" + json; };
  check_changes(
      "lines",
      {{"node.json", after, own(R"(["fault-tally"])"), "own_services", "is a list"},
       {"node.json", after, own(R"({"Fault Tally": "x"})"), "own_services.Fault Tally", "is no id"},
       {"node.json", after, own(R"({"scheduler": "x"})"), "own_services.scheduler", "the middleware's"},
       {"node.json", after, own(R"({"cloud-gateway": "x"})"), "own_services.cloud-gateway", "the middleware's"},
       {"node.json", after, own(R"({"tally": ""})"), "own_services.tally", "no path"},
       {"node.json", after, own(R"({"tally": ["x"]})"), "own_services.tally", "no path"}});
}

TEST_CASE(
    "node.json: a service of an operator's own is one of the node's, and its program is there before the node starts") {
  const NodeFolder folder;
  folder.change("node.json", R"("seeds": [])", R"("seeds": [], "own_services": {"fault-tally": "bin/fault-tally"})");
  const NodeCheck elsewhere = folder.check(true);  // a container does not have the other services' programs
  CHECK(to_text(without_keys(elsewhere.faults)) == "");
  CHECK(elsewhere.config.has_service("fault-tally"));
  CHECK(elsewhere.config.own_services.at("fault-tally") == folder.path() + "/bin/fault-tally");

  CHECK(only_fault(folder, false).key == "own_services.fault-tally");
  folder.write("bin/fault-tally", "#!/bin/sh\n");
  CHECK(only_fault(folder, false).what.find("no program that can be started") != std::string::npos);
  REQUIRE(::chmod((folder.path() + "/bin/fault-tally").c_str(), 0755) == 0);
  CHECK(to_text(without_keys(folder.check(false).faults)) == "");
}

TEST_CASE("node.json: a cloud node has no robot") {
  const NodeFolder folder("cloud");
  folder.write("node.json", R"({"id":"cloud","role":"cloud","framework":"ur","services":["router","mode-adapter"]})");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].key == "framework");
  CHECK(faults[1].key == "services");
  check_cures(faults);
}

TEST_CASE("node.json: a cloud node that names the gateway has it") {
  const NodeFolder folder("cloud");
  folder.write("node.json", R"({"id":"cloud","role":"cloud","services":["router","cloud-gateway"]})");
  const NodeCheck check = folder.check(true);
  CHECK(to_text(without_keys(check.faults)) == "");
  CHECK(check.config.has_service("cloud-gateway"));
}

TEST_CASE("network.json: values") {
  check_changes("lines",
                {{"network.json", "50000", "0", "UDP_PORT", "out of range"},
                 {"network.json", "45000", "70000", "TCP_PORT_EXT", "out of range"},
                 {"network.json", "40000", "\"40000\"", "TCP_PORT", "is a text"},
                 {"network.json", "40000", "45000", "TCP_PORT", "the same as TCP_PORT_EXT"},
                 {"network.json", "\"127.0.77.1\"", "3", "HOST_INT", "whole number"},
                 {"network.json", "\"HOST_INT\"", "\"HOST_INTERFACE\": 1, \"HOST_INT\"", "HOST_INTERFACE", "no key"},
                 {"network.json", "127.0.77.1", "eth99", "HOST_INT", "no interface or address 'eth99'"},
                 {"network.json", "127.0.77.1", "203.0.113.77", "HOST_INT", "no interface or address '203.0.113.77'"},
                 {"network.json", "127.0.77.1", "Wi-Fi", "HOST_INT", "Windows"}});
}

TEST_CASE("an interface that does not exist is told with those that do") {
  const NodeFolder folder;
  folder.change("network.json", "127.0.77.1", "eth99");
  CHECK(only_fault(folder).hint.find("lo (127.0.0.1)") != std::string::npos);
}

TEST_CASE("profile.json: unknown modes") {
  check_changes("lines",
                {{"profile.json", R"("abb": "interpreter")", R"("abb": "interpretor")", "abb", "'interpretor'"},
                 {"profile.json", R"("lines": "interpreter")", R"("lines": "none")", "lines", "'none'"},
                 {"profile.json", R"("lines": "interpreter")", R"("lines": 1)", "lines", "whole number"}});
  const NodeFolder folder;
  folder.change("profile.json", R"("lines": "interpreter")", R"("lines": "serial")");
  CHECK(only_fault(folder).hint == "use one of: interpreter, direct, ros");
}

TEST_CASE("a maker's words that a former profile.json calls interpreter are direct: the fault says so") {
  const NodeFolder folder("ur");
  folder.change("profile.json", R"("ur": "direct")", R"("ur": "interpreter")");
  folder.change("commands.json", R"("port": 30002)", R"("port": 30002, "transport": "arcos")");
  const ConfigFaults faults = without_keys(folder.check().faults);
  const auto told = std::ranges::find(faults, "ur.transport", &ConfigFault::key);
  REQUIRE_MESSAGE(told != faults.end(), to_text(faults));
  CHECK(told->what == "'arcos' is of the direct mode, and profile.json says 'interpreter'");
  CHECK(told->hint.starts_with(R"(write "ur": "direct" in profile.json)"));
}

TEST_CASE("the ros mode: its service, topics, types, data, and ends that it can see") {
  check_changes("ros",
                {{"node.json", R"( "ros-bridge",)", "", "services", "has no \"ros-bridge\""},
                 {"commands.json", R"("/cmd_vel")", R"("cmd vel!")", "ros.commands.move", "is no message type"},
                 {"commands.json", R"("/cmd_vel")", R"("/cmd-vel")", "ros.commands.move", "is no topic"},
                 {"commands.json", R"("/cmd_vel")", R"("2d_vel")", "ros.commands.move", "is no topic"},
                 {"commands.json", R"("/odom pose.x")", R"("_odom pose.x")", "ros.requests.position", "is no topic"},
                 {"commands.json", "geometry_msgs/Point", "Point", "ros.commands.go", "is no message type"},
                 {"commands.json", R"({0}})", "{0}", "ros.commands.go", "the data of /goal: no JSON"},
                 {"commands.json", R"(, "stop": "/cmd_vel {}")", "", "ros.commands.stop", "must say how it is stopped"},
                 {"commands.json", R"("/odom pose.x")", R"("?")", "ros.requests.position", "is no topic"}});
  const NodeFolder acknowledged("ros");
  acknowledged.change("robots/r.json", R"("time", "duration_s": 2)", R"("acknowledgement")");
  CHECK(only_fault(acknowledged).what == "ends skill 'go' with an acknowledgement, which ROS never gives");
  const NodeFolder watched("ros");
  watched.change("robots/r.json", R"("time", "duration_s": 2)", R"("state", "state": "mode", "equals": 1)");
  CHECK(only_fault(watched).key == "ros.requests.mode");
}

TEST_CASE("commands.json: values") {
  check_changes(
      "ur",
      {{"commands.json", R"("stop": "stop program", )", "", "ur.commands.stop",
        "every vendor must say how it is stopped"},
       {"commands.json", R"("stop program")", R"("")", "ur.commands.stop", "no words"},
       {"commands.json", R"("port": 30002, )", "", "ur.port", "is missing"},
       {"commands.json", "30002", "99999", "ur.port", "out of range"},
       {"commands.json", "ur-primary", "ur-rtde", "ur.monitor.protocol", "'ur-rtde'"},
       {"commands.json", R"("language")", R"("rtde_port": 0, "language")", "ur.rtde_port", "out of range"},
       {"commands.json", R"("language")", R"("rtde_port": 30004, "rtde_hz": 500, "language")", "ur.rtde_hz",
        "out of range"},
       {"commands.json", "urscript-program", "program", "ur.wrap", "'program'"},
       {"commands.json", R"("language": "urscript")", R"("language": "plain")", "ur.wrap", "wraps URScript"},
       {"commands.json", R"("language")", R"("rtde_hz": 50, "language")", "ur.rtde_hz", "without \"rtde_port\""},
       {"commands.json", R"("language")", R"("values": {"a": "b"}, "language")", "ur.values", "is no part of tcp-text"},
       {"commands.json", R"("joints")", R"("joint")", "ur.requests.position", "is not one of the values"},
       {"commands.json", R"("port": 30002)", R"("port": 30002, "transport": "lines")", "ur.transport",
        "is of the interpreter mode"},
       {"commands.json", R"("port": 30002)", R"("port": 30002, "transport": "tcp")", "ur.transport", "'tcp'"},
       {"commands.json", R"("port": 30002)", R"("prt": 1, "port": 30002)", "ur.prt", "no key"},
       {"commands.json", "{data}", "{joints}", "ur.commands.move", "no placeholder"},
       {"commands.json", R"("go":)", R"("goo":)", "ur.commands.go", "skill 'go' sends it"},
       {"commands.json", R"("go":)", R"("go": 1, "go2":)", "ur.commands.go", "whole number"},
       {"commands.json", R"("stop": "stop program")", R"("stop": "stop prgram")", "ur.commands.stop", "'stop prgram'"},
       {"commands.json", R"("ur":)", R"("kuka":)", "ur", "needs the vendor's words"}});
}

TEST_CASE("a UR's skill ends by a value that its monitor tells, by its name or by its request's") {
  const NodeFolder folder("ur");
  const std::string end = R"({"kind": "acknowledgement"})";
  const auto end_by = [&](const std::string& state) {
    return R"({"kind": "state", "state": ")" + state + R"(", "equals": 0})";
  };
  folder.change("robots/r.json", end, end_by("program_runing"));
  const ConfigFault fault = only_fault(folder);
  CHECK(fault.key == "ur.monitor");
  CHECK(fault.what == "does not tell 'program_runing', by which the end of skill 'go' is seen");
  CHECK(fault.hint == "did you mean 'program_running'?");
  folder.change("robots/r.json", "program_runing", "program_running");
  CHECK(without_keys(folder.check().faults).empty());
  folder.change("robots/r.json", "program_running", "position");
  CHECK(without_keys(folder.check().faults).empty());
  folder.change("robots/r.json", end_by("position"), R"({"kind": "position", "value": "flange", "target": "place"})");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(!faults.empty(), "flange");
  CHECK(faults.back().what.starts_with("does not tell 'flange'"));
}

TEST_CASE("places and descriptions: the fault names the file as node.json does") {
  check_changes("lines", {{"places.json", R"("x": 1)", R"("x": true)", "places.dock.x", "is true"},
                          {"places.json", R"("y": 2)", R"("y": 2, "yaw": 90)", "places.dock.yaw", "more than a turn"},
                          {"robots/r.json", R"("end": {"kind": "acknowledgement"})", R"("timeout_s": 5)",
                           "skills.go.end", "has no end"},
                          {"robots/r.json", "{place.x}", "{plaze.x}", "skills.go.command.data", "no parameter"}});
}

TEST_CASE("places.json: more places than a robot's profile takes, its own among them") {
  const NodeFolder folder("ur");
  folder.write("places.json", hall_of(255));
  const NodeCheck most = folder.check();
  CHECK_MESSAGE(without_keys(most.faults).empty(), to_text(most.faults));
  folder.change("robots/r.json", R"("skills": {)", R"("places": {"p0": [1], "bench": [2]}, "skills": {)");
  const ConfigFault fault = only_fault(folder);
  CHECK(fault.file == "places.json");
  CHECK(fault.key == "places");
  CHECK(fault.what == "has 256 places with the robot's own, and a robot's profile takes 255");
  CHECK(fault.hint == "leave out those that this robot is not sent to");
  folder.write("places.json", hall_of(254));
  CHECK(without_keys(folder.check().faults).empty());
}

TEST_CASE("places.json: a cloud node may know more places than a robot is sent to") {
  const NodeFolder folder("cloud");
  folder.write("places.json", hall_of(1000));
  const NodeCheck check = folder.check();
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.places.size() == 1000);
}

TEST_CASE("every fault of every file at once") {
  const NodeFolder folder("ur");
  folder.change("node.json", R"("beacon": true)", R"("beacon": 1)");
  folder.change("network.json", "50000", "0");
  folder.change("profile.json", R"("abb": "interpreter")", R"("abb": "x")");
  folder.change("commands.json", R"("stop": "stop program", )", "");
  folder.change("places.json", R"("x": 1)", R"("x": "1")");
  folder.change("robots/r.json", R"("maker": "m", )", "");
  const ConfigFaults faults = folder.check().faults;
  CHECK_MESSAGE(faults.size() == 7, to_text(faults));
  check_cures(without_keys(faults));
}
