#include "services/virtual-robots/kuka/program.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/kuka/text.hpp"

using namespace trb::virtual_robots::kuka;

namespace {

/** A node that sends messages as config/robots/README.md describes. */
struct Node {
  explicit Node(std::vector<Failure> failures = {}) : program(std::move(failures)) { program.advance(0); }

  void set(const std::string& name, const std::string& value) {
    CHECK_MESSAGE(program.variables().write(name, value), name, " = ", value);
    program.advance(now);
  }
  std::string get(const std::string& name) { return program.variables().read(name).value_or("-"); }
  void order(const std::string& subtype, const std::string& type = "command") {
    set("TRB_TYPE[]", '"' + type + '"');
    set("TRB_SUBTYPE[]", '"' + subtype + '"');
    set("TRB_NUMBER", std::to_string(++number));
    set("TRB_COMMAND", "TRUE");
  }
  void wait(double seconds) {
    now += seconds;
    program.advance(now);
  }
  std::string end() {
    if (get("TRB_DONE") != "TRUE") return "";
    const std::string told = get("TRB_DONE_NUMBER") + " " + get("TRB_RESULT") + " " + get("TRB_TEXT[]");
    set("TRB_DONE", "FALSE");
    return told;
  }

  Program program;
  double now = 0;
  int number = 0;
};

constexpr const char* kTarget = "{E6AXIS: A1 60, A2 -90, A3 90, A4 0, A5 0, A6 0}";

}  // namespace

TEST_CASE("a move whose target nobody has written goes to what trb.dat has") {
  Node node;
  CHECK(node.get("TRB_AXIS").starts_with("{E6AXIS: A1 0.0000, A2 -90.0000, A3 90.0000, A4 0.0000,"));
  CHECK(node.get("TRB_POS.S") == "2");
  CHECK(node.get("TRB_POS.T") == "35");
  node.order("move");
  node.wait(5);
  CHECK(node.end() == "1 0 \"\"");
  CHECK(node.get("$AXIS_ACT.A2") == "-90.0000");
}

TEST_CASE("a command is taken, moves the arm, and its end is told until it is read") {
  Node node;
  node.set("TRB_AXIS", kTarget);
  node.order("move");
  CHECK(node.get("TRB_COMMAND") == "FALSE");
  node.wait(0.5);
  CHECK(node.get("$AXIS_ACT.A1") == "30.0000");
  CHECK(node.end().empty());
  node.wait(0.6);
  CHECK(node.get("TRB_DONE") == "TRUE");
  node.order("go_home");
  CHECK(node.get("TRB_COMMAND") == "TRUE");
  CHECK(node.end() == "1 0 \"\"");
  CHECK(node.get("TRB_COMMAND") == "FALSE");
}

TEST_CASE("what is refused is over before it is taken") {
  Node node({{"go_home", std::nullopt}});
  node.set("TRB_AXIS", "{E6AXIS: A1 200}");
  node.order("move");
  CHECK(node.end() == "1 4 \"A1 200.0 is not in -170.0..170.0\"");
  node.order("go_home");
  CHECK(node.end() == "2 3 \"injected failure\"");
  node.order("dance", "request");
  CHECK(node.end() == "3 5 \"unknown request dance\"");
  node.order("dance");
  CHECK(node.end() == "4 0 \"\"");
}

TEST_CASE("information is over at once, and moves nothing, whatever its name") {
  Node node;
  node.order("go_home", "information");
  for (const std::string& event : node.program.take_events()) CHECK_FALSE(event.starts_with("start"));
  CHECK(node.get("TRB_COMMAND") == "FALSE");
  CHECK(node.end() == "1 0 \"\"");
}

TEST_CASE("its camera has found a box: the result is JSON") {
  Node node({{"find_box", 2}});
  node.order("find_box");
  CHECK(node.end() == R"(1 0 "{\qplace\q:\qtable1\q}")");
  node.order("find_box");
  CHECK(node.end() == "2 3 \"injected failure\"");
}

TEST_CASE("a stop brakes, ends what runs, and holds until it is lifted") {
  Node node;
  node.set("TRB_AXIS", kTarget);
  node.order("move");
  node.wait(0.5);
  node.set("TRB_STOP", "TRUE");
  CHECK(node.get("TRB_STOPPED") == "TRUE");
  CHECK(node.end() == "1 2 \"stopped\"");
  node.wait(5);
  CHECK(node.get("$AXIS_ACT.A1") == "30.0000");
  node.order("move");
  CHECK(node.get("TRB_COMMAND") == "TRUE");
  node.set("TRB_STOP", "FALSE");
  CHECK(node.get("TRB_STOPPED") == "FALSE");
}

TEST_CASE("a fault stops the program in the middle; a person lets it go on") {
  Node node;
  node.set("TRB_AXIS", kTarget);
  node.order("move");
  node.wait(0.5);
  node.program.raise_fault("grab", "CRITICAL", "gripper \"1\" lost", node.now);
  CHECK(node.get("$STOPMESS") == "TRUE");
  CHECK(node.get("TRB_ERROR[]") == "\"grab CRITICAL gripper \\q1\\q lost\"");
  node.set("TRB_STOP", "TRUE");
  node.wait(5);
  CHECK(node.get("TRB_STOPPED") == "FALSE");
  node.program.clear(node.now);
  CHECK(node.get("TRB_STOPPED") == "TRUE");
  CHECK(node.end() == "1 2 \"stopped\"");
}

TEST_CASE("long data come in chunks, and go in chunks") {
  Node node;
  node.set("TRB_DATA[]", "\"one \\q\"");
  node.set("TRB_CHUNK", "TRUE");
  CHECK(node.get("TRB_CHUNK") == "FALSE");
  node.set("TRB_DATA[]", "\"two\"");
  node.order("wave");
  CHECK(node.program.take_events().front() == "message command wave  0 one \"two");
  node.program.say("information", "greeting", "", std::string(150, 'x') + "\"\n");
  node.wait(0);
  std::string all;
  for (int chunks = 0; chunks < 2; ++chunks) {
    CHECK(node.get("TRB_OUT") == "TRUE");
    CHECK(node.get("TRB_OUT_SIZE") == "152");
    const std::string data = node.get("TRB_OUT_DATA[]");
    all += data.substr(1, data.size() - 2);
    node.set("TRB_OUT", "FALSE");
  }
  CHECK(unescape_field(all) == std::string(150, 'x') + "\"\n");
  CHECK(node.get("TRB_OUT") == "FALSE");
}
