#include "services/cli/core/command_text.hpp"

#include <doctest/doctest.h>

#include "services/cli/core/completion.hpp"
#include "services/cli/core/manual.hpp"

using namespace trb::cli;

namespace {

const std::vector<CommandText> kTable{
    {{"up"}, {"up NODE_DIR", "Starts a node. It goes on.", {"--json|for programs"}, {"trb up ."}, 1, 1}},
    {{"run", "list"},
     {"run list", "What isn't over", {"--node DIR|the node", "--timeout S|how long: seconds"}, {}, 0, 0}},
    {{"run", "show"}, {"run show RUN", "A run", {"--to FILE|where"}, {}, 1, 1}},
    {{"check"}, {"check [FILE]", "Checks", {}, {}, 0, 1}},
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("an option's parts: name, value and what it is") {
  const OptionText timeout = option_text("--timeout S|how long | at most");
  CHECK(timeout.name == "--timeout");
  CHECK(timeout.value == "S");
  CHECK(timeout.what == "how long | at most");
  CHECK(timeout.kind == ValueKind::text);
  CHECK(option_text("--json|for programs").kind == ValueKind::none);
  CHECK(option_text("--node NODE_DIR|x").kind == ValueKind::folder);
  CHECK(option_text("--faults FILE|x").kind == ValueKind::file);
}

TEST_CASE("a command's first word may be a folder, a file, a name, or nothing") {
  CHECK(kind_of_words(kTable[0]) == ValueKind::folder);
  CHECK(kind_of_words(kTable[1]) == ValueKind::none);
  CHECK(kind_of_words(kTable[2]) == ValueKind::text);
  CHECK(kind_of_words(kTable[3]) == ValueKind::file);
}

TEST_CASE("a summary's first sentence ends at its full stop, not within a file's name") {
  CHECK(first_sentence("Writes certificate.json beside it. Then it ends.") == "Writes certificate.json beside it");
  CHECK(first_sentence("Lists robots.\nAlso sensors.") == "Lists robots");
  CHECK(first_sentence("Lists robots\nand sensors.") == "Lists robots and sensors");
  CHECK(first_sentence("Lists robots.") == "Lists robots");
  CHECK(first_sentence("").empty());
}

TEST_CASE("what may follow a word") {
  CHECK(words_after(kTable, "") == std::vector<std::string>{"up", "run", "check"});
  CHECK(words_after(kTable, "run") == std::vector<std::string>{"list", "show"});
  CHECK(words_after(kTable, "up").empty());
}

TEST_CASE("completion has each command's options, and a quotation mark ends no text") {
  CHECK(has(bash_completion(kTable), "'--node --timeout --help'"));
  CHECK(has(zsh_completion(kTable), R"('list:What isn'\''t over')"));
  CHECK(has(fish_completion(kTable), R"(-d 'What isn\'t over')"));
  CHECK(has(fish_completion(kTable), "-l to -d 'where' -r -F"));
}

TEST_CASE("the manual: what troff would take for its own is escaped") {
  const std::string page = manual_page(kTable, {{"stop", ".x\n'y\n"}}, "1.0");
  CHECK(has(page, ".SS trb up NODE_DIR\nStarts a node. It goes on.\n"));
  CHECK(has(page, "\\fB\\-\\-timeout\\fR \\fIS\\fR\nhow long: seconds\n"));
  CHECK(has(page, ".SH \"TOPIC STOP\"\n.EX\n\\&.x\n\\&'y\n.EE\n"));
}
