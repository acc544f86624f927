#include "common/config/transports.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb {

const Transport* Transports::find(std::string_view name) const {
  const auto at = std::ranges::find(rows_, name, &Transport::name);
  return at == rows_.end() ? nullptr : *at;
}

std::string Transports::default_of(Mode mode) const {
  const auto at = std::ranges::find(rows_, mode, &Transport::mode);
  return at == rows_.end() ? std::string() : std::string((*at)->name);
}

std::vector<std::string> Transports::names() const {
  std::vector<std::string> names;
  for (const Transport* row : rows_) names.emplace_back(row->name);
  return names;
}

std::string Transports::names_of(Mode mode) const {
  std::string names;
  for (const Transport* row : rows_) {
    if (row->mode == mode) names += (names.empty() ? "" : ", ") + std::string(row->name);
  }
  return names;
}

std::vector<std::string> Transports::all_of(std::vector<std::string_view> Transport::*list,
                                            std::vector<std::string> first) const {
  for (const Transport* row : rows_) first.insert(first.end(), (row->*list).begin(), (row->*list).end());
  return first;
}

void Transports::check(const NodeConfig& config, const FileFaults& faults) const {
  const Transport* found = find(config.commands.transport);
  if (found == nullptr) return;
  if (found->mode == config.mode) return found->check(config, faults);
  std::string hint = "use one of " + names_of(config.mode) + ", or correct profile.json";
  // So arcos, rapid and c3 were called before: what commands.json translates is direct.
  if (config.mode == Mode::interpreter && found->mode == Mode::direct) {
    hint = "write \"" + config.framework +
           R"(": "direct" in profile.json: the interpreter mode sends fields to a program of yours)";
  }
  faults.add(config.framework + ".transport",
             in_quotes(found->name) + " is of the " + std::string(name_of(found->mode)) +
                 " mode, and profile.json says " + in_quotes(name_of(config.mode)),
             hint);
}

void check_words(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (!vendor.commands.contains("stop")) {
    faults.add(name + ".commands.stop", "is missing: every vendor must say how it is stopped",
               "add \"stop\" with the vendor's words for stopping all motion, for example \"stop program\"");
  }
  for (const auto& [subtype, words] : vendor.commands) {
    if (!words.empty() || subtype == "release") continue;
    std::string key = name;
    key.append(".commands.").append(subtype);
    faults.add(key, "has no words, the robot would be sent nothing",
               "write the vendor's words, or remove it; only \"release\" may be empty");
  }
}

void require_port(const NodeConfig& config, const FileFaults& faults, const std::string& example) {
  if (config.commands.port) return;
  faults.add(config.framework + ".port", "is missing: the node dials a port of the robot",
             "add \"port\", for example " + example);
}

}  // namespace trb
