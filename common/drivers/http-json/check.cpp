// What the transport http-json asks of commands.json.
#include <set>

#include "common/config/transports.hpp"
#include "common/drivers/http-json/syntax.hpp"
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
      : config_(config), vendor_(config.commands), faults_(faults) {}

  void check() {
    if (vendor_.monitor) add("monitor", "is no part of http-json, whose values are asked for", "remove it");
    if (vendor_.language != "plain") add("language", "is no part of http-json, which has JSON only", "remove it");
    require_port(config_, faults_, "80");
    check_words(vendor_, config_.framework, faults_);
    for (const auto& [subtype, words] : vendor_.commands) command(subtype, words);
    for (const auto& [name, words] : vendor_.values) value(name, words);
    for (const auto& [subtype, words] : vendor_.commands) paths(subtype, words);
    for (const auto& [subtype, name] : vendor_.requests) {
      if (!vendor_.values.contains(name)) no_value("requests." + subtype, name, "");
    }
    for (const Skill& skill : config_.description.skills) this->skill(skill);
  }

 private:
  void add(const std::string& key, std::string what, std::string cure) const {
    faults_.add(config_.framework + "." + key, std::move(what), std::move(cure));
  }

  void command(const std::string& subtype, const std::string& words) {
    const auto read = read_http_words(words);
    if (!read) return add("commands." + subtype, read.error().what, read.error().cure);
    if (read->empty() && !words.empty())
      add("commands." + subtype, "is blank", "write METHOD PATH [JSON], a line each");
    for (const HttpWords& one : *read) {
      if (!one.remembers.empty()) remembered_.insert(one.remembers);
      const bool fills = one.body && !one.body->fill("", json_literal).ok();
      if (fills && (subtype == "stop" || subtype == "release")) {
        add("commands." + subtype, "needs data, and a " + subtype + " has none", "write the JSON itself");
      }
    }
  }

  void value(const std::string& name, const std::string& words) {
    const auto read = read_http_question(words);
    if (!read) return add("values." + name, read.error().what, read.error().cure);
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
      add(key, "needs <" + name + ">, which no command's answer tells",
          did_you_mean(name, {remembered_.begin(), remembered_.end()},
                       "let a command end with -> " + name + " /POINTER, or use one of"));
    }
  }

  void no_value(const std::string& key, const std::string& name, const std::string& why) const {
    std::vector<std::string> known;
    for (const auto& [one, ignored] : vendor_.values) known.push_back(one);
    add(key, in_quotes(name) + " is no name of \"values\"" + why,
        known.empty() ? "add \"values\": {\"" + name + "\": \"GET /status /" + name + "\"}"
                      : did_you_mean(name, known, "add it there, or use one of"));
  }

  void skill(const Skill& skill) const {
    const bool spoken = vendor_.commands.contains(skill.subtype);
    if (!spoken && !config_.description.has_field_channel) {
      add("commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
          "add it with its request, for example \"POST /mission_queue {\\\"mission_id\\\": {0}}\"");
    }
    const bool position = skill.end.kind == EndKind::position;
    if (!spoken || (!position && skill.end.kind != EndKind::state)) return;
    const std::string watched = skill.end.state.empty() ? "position" : skill.end.state;
    if (vendor_.values.contains(watched) || vendor_.requests.contains(watched)) return;
    no_value("values." + watched, watched, ": the end of skill '" + skill.name + "' is seen by it");
  }

  const NodeConfig& config_;
  const VendorCommands& vendor_;
  const FileFaults& faults_;
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
