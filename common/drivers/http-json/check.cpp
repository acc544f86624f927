// What the transport http-json requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/http-json/commands.hpp"
#include "common/drivers/polled_check.hpp"

namespace trb::drivers {

void check_http_json(const NodeConfig& config, const FileFaults& faults);
void read_http_json_keys(ObjectReader& vendor, VendorCommands& into);

namespace {

constexpr Range kPoll{0.05, 60, false};
constexpr Range kTimeout{0.1, 30, false};

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
}

void read_http_json_keys(ObjectReader& vendor, VendorCommands& into) {
  if (const auto poll_s = vendor.number("poll_s", Need::optional, kPoll)) into.numbers["poll_s"] = *poll_s;
  if (const auto timeout_s = vendor.number("timeout_s", Need::optional, kTimeout))
    into.numbers["timeout_s"] = *timeout_s;
}

}  // namespace trb::drivers
