// What the transport http-json requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/http-json/commands.hpp"
#include "common/drivers/polled_check.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {

void check_http_json(const NodeConfig& config, const FileFaults& faults);

namespace {

/// A text becomes the number that TEXT=NUMBER gives it, and no other.
std::optional<Error> never(const VendorCommands& vendor, const WaitedValue& one) {
  const auto words = vendor.values.find(one.name);
  if (words == vendor.values.end() || !one.wanted.is_number()) return std::nullopt;
  const auto question = read_http_question(words->second);
  if (!question || question->parts.size() != 1 || question->parts[0].numbers.empty()) return std::nullopt;
  std::string given;
  for (const auto& [text, number] : question->parts[0].numbers) {
    if (number == one.wanted.number()) return std::nullopt;
    given += (given.empty() ? "" : ", ") + text + "=" + number_text(number);
  }
  return fail(Errc::bad_value, "it gives its texts the numbers " + given,
              "write one of these numbers there, or add TEXT=" + number_text(one.wanted.number()) + " to the value");
}

}  // namespace

void check_http_json(const NodeConfig& config, const FileFaults& faults) {
  const PolledCheck check(config, faults,
                          {"http-json", "JSON only", "GET /status /NAME",
                           R"(its request, for example "POST /mission_queue {\"mission_id\": {0}}")"});
  check.check_foreign_keys();
  require_port(config, faults, "80");
  check_words(config.commands, config.framework, faults);
  read_http_commands(config.commands, config.description, VendorFaults(config.framework, faults));
  check.check_names();
  check.check_waited([&](const WaitedValue& one) { return never(config.commands, one); });
}

}  // namespace trb::drivers
