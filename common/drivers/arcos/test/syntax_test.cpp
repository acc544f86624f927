// The notation of a robot with ARCOS, by itself and as trb check reports its faults.
#include "common/drivers/arcos/syntax.hpp"

#include <doctest/doctest.h>

#include "common/base/files.hpp"
#include "tests/support/node_folder.hpp"
#include "tests/support/paths.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

std::string what_of(std::string_view words) {
  const auto steps = read_arcos_steps(words);
  if (steps) return "";
  CHECK_FALSE(steps.error().hint.empty());
  return steps.error().what;
}

/// The node of a Pioneer with the shipped commands.
class PioneerFolder : public NodeFolder {
 public:
  PioneerFolder() : NodeFolder("pioneer") {
    const std::string config = test::source_dir() + "/config/";
    for (const char* file : {"profile.json", "commands.json", "places.json"}) write(file, *read_file(config + file));
    write("robots/r.json", *read_file(config + "robots/pioneer.json"));
  }
};

/// The one fault that a change of commands.json makes: "KEY: WHAT".
std::string fault_of(const std::string& file, const std::string& from, const std::string& to) {
  const PioneerFolder folder;
  folder.change(file, from, to);
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0].key + ": " + faults[0].what;
}

}  // namespace

TEST_CASE("steps: by name, by number, and goto with what it may leave open") {
  const auto steps =
      read_arcos_steps("SETV 400\nVEL {0}\n\n command 42 \"say {data}\" \ncommand 92 1\ngoto {0} {1} 90 angle=2");
  REQUIRE(steps);
  REQUIRE(steps->size() == 5);
  CHECK(steps->at(0).command == 6);
  CHECK(steps->at(0).argument == "400");
  CHECK(steps->at(1).effect == ArcosEffect::moves);
  CHECK(steps->at(1).argument == "{0}");
  CHECK(steps->at(2).kind == ArcosStep::Argument::text);
  CHECK(steps->at(2).argument == "say {data}");
  CHECK(steps->at(3).kind == ArcosStep::Argument::number);
  REQUIRE(steps->at(4).travel);
  CHECK(steps->at(4).travel->heading == "90");
  CHECK(steps->at(4).travel->tolerance == 50);
  CHECK(steps->at(4).travel->angle == 2);
}

TEST_CASE("steps: a command by its number is a motion all the same") {
  CHECK(read_arcos_steps("command 11 300")->at(0).effect == ArcosEffect::moves);
  CHECK(read_arcos_steps("command 55")->at(0).effect == ArcosEffect::stops);
}

TEST_CASE("steps: each mistake is named") {
  CHECK(what_of("VELO 3") == "'VELO' is no step");
  CHECK(what_of("VEL") == "VEL needs one whole number, not ''");
  CHECK(what_of("VEL 1.5") == "VEL needs one whole number, not '1.5'");
  CHECK(what_of("VEL {0} {1}") == "VEL needs one whole number, not '{0} {1}'");
  CHECK(what_of("ENABLE 2") == "ENABLE: 2 is not from 0 to 1");
  CHECK(what_of("STOP 1") == "STOP takes no number");
  CHECK(what_of("command 300") == "'300' is no number of a command");
  CHECK(what_of("command 1") == "'1' is no number of a command");
  CHECK(what_of("command 42 text") == "command 42 needs one whole number, not 'text'");
  CHECK(what_of("goto {0}") == "goto needs x and y");
  CHECK(what_of("goto {0} {1} {2} {3}").starts_with("goto: '{3}' is no number"));
  CHECK(what_of("goto 1 2 speed=3") == "'speed' is no setting of goto");
  CHECK(what_of("goto 1 2 tolerance=0") == "tolerance must be from 5 to 1000");
  CHECK(what_of("goto 1 2 angle=nan") == "angle must be from 1 to 1000");
  CHECK(what_of("goto 1 2\nSTOP") == "a line follows goto, whose end may be far");
}

TEST_CASE("values: fields of the robot's packets") {
  CHECK(read_arcos_value("x y  heading")->size() == 3);
  CHECK(read_arcos_value("digital_out")->front() == ArcosField::digital_out);
  CHECK(read_arcos_value("speed").error().what == "'speed' is not told by the robot");
  CHECK_FALSE(read_arcos_value(" "));
}

TEST_CASE("a Pioneer's shipped files are good, and its node says where it was switched on") {
  const PioneerFolder folder;
  folder.change("node.json", R"("interface": "lo")", R"("interface": "lo", "origin": {"x": 1, "y": 3, "yaw": 0.5})");
  const NodeCheck check = folder.check();
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(check.config.commands.transport == "arcos");
  CHECK(check.config.description.frame.origin == Pose{1, 3, 0, 0.5});
  CHECK(check.config.description.frame.length == 1000);
}

TEST_CASE("trb check tells what is wrong with a Pioneer's words") {
  const std::string commands = "commands.json";
  CHECK(fault_of(commands, R"("port": 8101,)", "") == "pioneer.port: is missing: the node dials a port of the robot");
  CHECK(fault_of(commands, R"("stop": "STOP")", R"("stop": "VEL 0")") == "pioneer.commands.stop: stops nothing");
  CHECK(fault_of(commands, "VEL {0}", "VLE {0}") == "pioneer.commands.speed: 'VLE' is no step");
  CHECK(fault_of(commands, R"("motors": "motors"
    })",
                 R"("motors": "engine"
    })") == "pioneer.values.motors: 'engine' is not told by the robot");
  CHECK(fault_of(commands, R"("battery": "battery",
      "state_of_charge": "state_of_charge",
      "speeds": "speeds",)",
                 R"("battery": "volts",)") == "pioneer.requests.battery: 'volts' is not one of the values");
  CHECK(fault_of(commands, R"("go_to": "goto {0} {1} {2} tolerance=50 angle=3",)", "") ==
        "pioneer.commands.go_to: is missing: skill 'go_to' sends it");
  CHECK(fault_of(commands, "goto {0} {1} {2} tolerance=50 angle=3", "MOVE {0}") ==
        "pioneer.commands.go_to: ends skill 'go_to' with an acknowledgement, which only goto gives");
  CHECK(fault_of("robots/r.json", "\"mm\"", "\"m\"") ==
        "pioneer.commands.go_to: takes millimetres and degrees, and the description's \"frame\" has metres");
  CHECK(fault_of("robots/r.json", "\"deg\"", "\"rad\"").ends_with("has radians"));
  CHECK(fault_of("node.json", R"("interface": "lo")", R"("interface": "lo", "origin": {"x": 1})")
            .starts_with("robot.origin.y"));
}
