// What the transport http-json asks of commands.json.
#include <set>

#include "common/config/transports.hpp"
#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/polled_check.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {

void check_http_json(const NodeConfig& config, const FileFaults& faults);
void read_http_json_keys(ObjectReader& vendor, VendorCommands& into);

namespace {

constexpr Range kPoll{0.05, 60, false};
constexpr Range kTimeout{0.1, 30, false};

/// One vendor's part of commands.json.
class Checker {
 public:
  Checker(const NodeConfig& config, const FileFaults& faults)
      : config_(config),
        vendor_(config.commands),
        faults_(faults),
        check_(config, faults,
               {"http-json", "JSON only", "GET /status /NAME",
                R"(its request, for example "POST /mission_queue {\"mission_id\": {0}}")"}) {}

  void check() {
    check_.check_foreign_keys();
    require_port(config_, faults_, "80");
    check_words(vendor_, config_.framework, faults_);
    for (const auto& [subtype, words] : vendor_.commands) command(subtype, words);
    for (const auto& [name, words] : vendor_.values) value(name, words);
    for (const auto& [subtype, words] : vendor_.commands) paths(subtype, words);
    check_.check_names();
  }

 private:
  void command(const std::string& subtype, const std::string& words) {
    const auto read = read_http_words(words);
    if (!read) return check_.add("commands." + subtype, read.error().what, read.error().hint);
    if (read->empty() && !words.empty())
      check_.add("commands." + subtype, "is blank", "write METHOD PATH [JSON], a line each");
    for (const HttpWords& one : *read) {
      if (!one.remembers.empty()) remembered_.insert(one.remembers);
      const bool fills = one.body && !one.body->fill("", json_literal).ok();
      if (fills && (subtype == "stop" || subtype == "release")) {
        check_.add("commands." + subtype, "needs data, and a " + subtype + " has none", "write the JSON itself");
      }
    }
  }

  void value(const std::string& name, const std::string& words) {
    const auto read = read_http_question(words);
    if (!read) return check_.add("values." + name, read.error().what, read.error().hint);
    names("values." + name, read->path);
  }

  void paths(const std::string& subtype, const std::string& words) const {
    const auto read = read_http_words(words);
    if (!read) return;
    for (const HttpWords& one : *read) names("commands." + subtype, one.path);
  }

  /// What a path needs must be told by some command's answer.
  void names(const std::string& key, const HttpPath& path) const {
    for (const std::string& name : path.names()) {
      if (remembered_.contains(name)) continue;
      check_.add(key, "needs <" + name + ">, which no command's answer tells",
                 did_you_mean(name, {remembered_.begin(), remembered_.end()},
                              "let a command end with -> " + name + " /POINTER, or use one of"));
    }
  }

  const NodeConfig& config_;
  const VendorCommands& vendor_;
  const FileFaults& faults_;
  PolledCheck check_;
  std::set<std::string> remembered_;
};

}  // namespace

void check_http_json(const NodeConfig& config, const FileFaults& faults) {
  Checker(config, faults).check();
}

void read_http_json_keys(ObjectReader& vendor, VendorCommands& into) {
  if (const auto poll_s = vendor.number("poll_s", Need::optional, kPoll)) into.numbers["poll_s"] = *poll_s;
  if (const auto timeout_s = vendor.number("timeout_s", Need::optional, kTimeout))
    into.numbers["timeout_s"] = *timeout_s;
}

}  // namespace trb::drivers
