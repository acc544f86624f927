// The notation of a KUKA over C3: what can be parsed, and the faults that trb check reports for the rest.
#include "common/drivers/c3/syntax.hpp"

#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

constexpr const char* kGood = R"json({"kuka": {"port": 7000, "transport": "c3",
  "values": {"position": "$POS_ACT X Y", "trb_done": "READY"},
  "commands": {"go": "GOAL = {E6POS: X {0}}\nGO = TRUE", "stop": "HALT_IT = TRUE"}, "requests": {"where": "position"}}})json";

/// A folder of a KUKA with a program of its integrator's own; each change must make one fault at that key.
struct Change {
  std::string file, from, to, key, text;
};

NodeFolder folder() {
  return NodeFolder("kuka");
}

void prepare(const NodeFolder& folder) {
  folder.write("profile.json", R"({"kuka": "direct"})");
  folder.write("commands.json", kGood);
}

}  // namespace

TEST_CASE("assignments: variables, values and their placeholders") {
  const auto read =
      read_c3_assignments("TRB_AXIS = {E6AXIS: A1 {0}, A2 {1}}\n\n NAME[] = {data}\n$FLAG[3] = TRUE\nA.B=-1.5E3");
  REQUIRE(read.ok());
  REQUIRE(read->size() == 4);
  CHECK((*read)[0].value == "{E6AXIS: A1 {0}, A2 {1}}");
  CHECK((*read)[1].variable == "NAME[]");
  CHECK((*read)[3].value == "-1.5E3");
  for (const char* bad :
       {"NAME", "NAME =", "= 1", "2X = 1", "A B = 1", "X = 1, 2", "X = \"open", "X = {A 1", "X = A}", "X = \"{0}\"",
        "X = 1 ; Y = 2", "A_NAME_OF_MORE_THAN_24_CHARACTERS = 1", "X[a] = 1", "X. = 1"}) {
    CHECK_FALSE_MESSAGE(read_c3_assignments(bad).ok(), bad);
  }
}

TEST_CASE("questions: a variable and its components") {
  CHECK(read_c3_question("$POS_ACT X  Y")->components == std::vector<std::string>{"X", "Y"});
  CHECK(read_c3_question("TRB_TEXT[]")->components.empty());
  CHECK_FALSE(read_c3_question("").ok());
  CHECK_FALSE(read_c3_question("$POS_ACT 1").ok());
}

TEST_CASE("the hand-shake's names: all of them with fields, else those that are named") {
  CHECK(read_c3_names({}, true)->data == "TRB_DATA[]");
  CHECK(read_c3_names({{"trb_data", "MINE[]"}, {"position", "X"}}, true)->data == "MINE[]");
  CHECK(read_c3_names({{"trb_done", "READY"}}, false)->done == "READY");
  CHECK(read_c3_names({{"trb_done", "READY"}}, false)->command.empty());
  CHECK(read_c3_names({{"trb_dne", "READY"}}, false).error().hint == "did you mean 'trb_done'?");
}

TEST_CASE("a KUKA's files: each mistake is told with its key") {
  {
    const NodeFolder good = folder();
    prepare(good);
    const ConfigFaults faults = without_keys(good.check().faults);
    CHECK_MESSAGE(faults.empty(), to_text(faults));
  }
  for (const Change& change :
       std::vector<Change>{{"commands.json", "\"port\": 7000, ", "", "kuka.port", "is missing"},
                           {"commands.json", "GO = TRUE", "GO IS TRUE", "kuka.commands.go", "no variable"},
                           {"commands.json", "\"stop\"", "\"halt\"", "kuka.commands.stop", "is missing"},
                           {"commands.json", "$POS_ACT X Y", "$POS ACT.", "kuka.values.position", "no component"},
                           {"commands.json", "\"where\": \"position\"", "\"where\": \"positon\"", "kuka.requests.where",
                            "not one of the values"},
                           {"commands.json", "trb_done", "trb_dome", "kuka.values", "no part of the hand-shake"},
                           {"commands.json", ", \"trb_done\": \"READY\"", "", "kuka.values.trb_done", "is missing"},
                           {"commands.json", "\"go\":", "\"goo\":", "kuka.commands.go", "is missing"}}) {
    const NodeFolder changed = folder();
    prepare(changed);
    changed.change(change.file, change.from, change.to);
    const ConfigFaults faults = without_keys(changed.check().faults);
    REQUIRE_MESSAGE(!faults.empty(), change.to);
    CHECK_MESSAGE(faults[0].key == change.key, to_text(faults));
    CHECK_MESSAGE(faults[0].what.find(change.text) != std::string::npos, to_text(faults));
    CHECK_FALSE(faults[0].hint.empty());
  }
}
