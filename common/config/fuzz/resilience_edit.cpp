// A change of resilience.json as the gateway's API takes it: refused with faults, each with a cure, or a file that has
// none, whose other parts are what they were.
#include "common/config/resilience_edit.hpp"

#include "common/config/resilience_file.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

constexpr const char* kFiles[] = {
    "", R"({"_comment": "\"policy\": {", "policy": {"mode": "ask"}, "expires_s": 60, "_comment": "}"})",
    R"({"criteria": {"battery": {"weight": 1, "at_least": 20}, "distance": 2}})",
    R"({"criteria": {"battery": {}, "distance": {}}, "judgments": [["battery", "distance", 3]]})"};

Value read(std::string_view text) {
  return text.empty() ? Value{Value::Object{}} : *parse_json(text);
}

/// Members that this part does not change.
std::vector<const char*> kept_by(ResiliencePart part) {
  if (part == ResiliencePart::policy) return {"criteria", "judgments"};
  if (part == ResiliencePart::criteria) return {"policy", "expires_s"};
  return {"policy", "expires_s", "judgments"};
}

void check_same(const Value& before, const Value& after, const char* key) {
  const Value* was = before.find(key);
  const Value* is = after.find(key);
  require((was == nullptr) == (is == nullptr), "no other part comes or goes");
  require(was == nullptr || *was == *is, "no other part changes");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {R"({"mode": "automatic", "bind": "ask", "max_moves": 3, "conditions": {"min_score": 0.5}, "expires_s": 120})",
          R"({"criteria": {"battery": {"weight": 3}, "payload": {"from": "description", "best": 10, "worst": 0}}})",
          R"({"criteria": {"battery": {}, "distance": {}}, "judgments": [["battery", "distance", 3]]})",
          R"({"battery": {"at_least": 20}, "distance": {"at_most": 40}})",
          R"({"policy": {"mode": "ask"}, "\u0000": [[]]})",
          "[]"};
}

void run(BytesView input) {
  const auto change = parse_json(input);
  if (!change) return;
  for (const char* file : kFiles) {
    for (const auto part : {ResiliencePart::policy, ResiliencePart::criteria, ResiliencePart::minimums}) {
      ConfigFaults faults;
      const auto text = edit_resilience(file, part, *change, faults);
      require(text.has_value() == faults.empty(), "a new text, or faults");
      for (const ConfigFault& one : faults) require(!one.hint.empty(), "each fault has a cure");
      if (!text) continue;
      const auto after = parse_json(*text);
      require(after.ok(), "the new text is JSON");
      read_resilience(*after, "resilience.json", faults);
      require(faults.empty(), "the new file has no faults");
      for (const char* key : kept_by(part)) check_same(read(file), *after, key);
    }
  }
}

}  // namespace trb::fuzz
