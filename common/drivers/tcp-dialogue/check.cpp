// What the transport tcp-dialogue requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/place_items.hpp"
#include "common/drivers/polled_check.hpp"
#include "common/drivers/tcp-dialogue/commands.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {

void check_tcp_dialogue(const NodeConfig& config, const FileFaults& faults);
void read_tcp_dialogue_keys(ObjectReader& vendor, VendorCommands& into);

namespace {

constexpr Range kPoll{0.05, 60, false};
constexpr Range kTimeout{0.1, 30, false};
constexpr Range kKeepAlive{0.05, 60, false};
constexpr std::size_t kMostPatterns = 8;
constexpr std::size_t kMostBegin = 16;

/// Several texts are a list, and a list equals nothing.
std::optional<Error> never(const DialogueCommands& commands, const WaitedValue& one) {
  const auto at = commands.values.find(one.name);
  if (at == commands.values.end()) return std::nullopt;
  const DialogueQuestion& question = at->second;
  if (question.pattern.holes() > 1) {
    return fail(Errc::bad_value, "it is a list of " + std::to_string(question.pattern.holes()) + " values",
                "name the part that counts as a value of its own, with one {0}");
  }
  if (!one.wanted.is_number() || question.numbers.empty()) return std::nullopt;
  std::string given;
  for (const auto& [text, number] : question.numbers) {
    if (number == one.wanted.number()) return std::nullopt;
    given += (given.empty() ? "" : ", ") + text + "=" + number_text(number);
  }
  return fail(Errc::bad_value, "it gives its texts the numbers " + given,
              "write one of these numbers there, or add TEXT=" + number_text(one.wanted.number()) + " to the value");
}

void read_text(ObjectReader& vendor, const char* key, VendorCommands& into) {
  if (const auto text = vendor.text(key, Need::optional)) into.texts[key] = {*text};
}

void read_list(ObjectReader& vendor, const char* key, std::size_t most, VendorCommands& into) {
  auto texts = vendor.texts(key, Need::optional, most);
  if (!texts.empty()) into.texts[key] = std::move(texts);
}

void read_number(ObjectReader& vendor, const char* key, const Range& range, VendorCommands& into) {
  if (const auto number = vendor.number(key, Need::optional, range)) into.numbers[key] = *number;
}

}  // namespace

void check_tcp_dialogue(const NodeConfig& config, const FileFaults& faults) {
  const PolledCheck check(
      config, faults,
      {"tcp-dialogue", "lines of text only", "get NAME -> {0}", R"(the robot's words, for example "goto {0}")"});
  check.check_foreign_keys();
  require_port(config, faults, "29999");
  check_words(config.commands, config.framework, faults);
  const auto commands =
      read_dialogue_commands(config.commands, config.description, VendorFaults(config.framework, faults));
  check.check_names();
  for (const Skill& skill : config.description.skills) check_place_items(config, skill, Items::list, faults);
  check.check_waited([&](const WaitedValue& one) { return never(commands, one); });
}

void read_tcp_dialogue_keys(ObjectReader& vendor, VendorCommands& into) {
  for (const char* key : {"line_end", "answer_end", "keep_alive"}) read_text(vendor, key, into);
  read_list(vendor, "begin", kMostBegin, into);
  for (const char* key : {"good", "bad", "ignore"}) read_list(vendor, key, kMostPatterns, into);
  if (const auto greeting = vendor.boolean("greeting", Need::optional)) into.numbers["greeting"] = *greeting ? 1 : 0;
  read_number(vendor, "keep_alive_s", kKeepAlive, into);
  read_number(vendor, "poll_s", kPoll, into);
  read_number(vendor, "timeout_s", kTimeout, into);
  read_hold_key(vendor, into);
}

}  // namespace trb::drivers
