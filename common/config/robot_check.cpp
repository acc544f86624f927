#include "common/config/robot_check.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/base/files.hpp"
#include "common/config/described_names.hpp"
#include "common/config/described_places.hpp"
#include "common/config/json_file.hpp"
#include "common/config/readers.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOption = "--framework";

/// Each member function is one file or one question; none stops at a fault.
class RobotChecker {
 public:
  RobotChecker(const RobotFiles& files, const Transports& known) : files_(files), known_(known) {}

  RobotCheck check() && {
    const auto json = load(files_.description);
    if (!json) return std::move(out_);
    out_.description = read_description(*json, files_.description, out_.faults);
    if (const auto hall = load(find("places.json", files_.places))) {
      out_.places = read_places(*hall, path_, out_.faults);
      check_place_names(out_.description, out_.places, sink(path_));
      check_described_places(out_.description, out_.places, files_.description, path_, out_.faults);
    }
    read_words();
    const std::string framework = files_.framework.empty() ? node_framework() : files_.framework;
    framework.empty() ? look_for_words() : check_words_of(framework);
    return std::move(out_);
  }

 private:
  FileFaults sink(const std::string& file) { return {file, out_.faults}; }

  /// The file's path; empty if it is not named and not found.
  std::string find(const std::string& name, const std::string& given) {
    if (!given.empty()) return given;
    const fs::path folder = fs::path(files_.description).parent_path();
    for (const fs::path& beside : {folder / name, folder / ".." / name}) {
      if (file_exists(beside.string())) return beside.lexically_normal().string();
    }
    out_.absent.push_back(name);
    return {};
  }

  /// The framework of the node whose description this is, if it lies in the node's folder: its words are meant, however
  /// many others would fit. What is wrong with node.json itself is told by `trb check`.
  std::string node_framework() {
    const fs::path folder = fs::path(files_.description).parent_path();
    for (const fs::path& beside : {folder, folder / ".."}) {
      const std::string path = (beside / "node.json").lexically_normal().string();
      const auto text = read_file(path);
      const auto json = text ? parse_json(*text) : Result<Value>(text.error());
      const Value* described = json ? json->find("description") : nullptr;
      const Value* framework = json ? json->find("framework") : nullptr;
      if (described == nullptr || !described->is_text() || framework == nullptr || !framework->is_text()) continue;
      std::error_code problem;
      if (!fs::equivalent(beside / described->text(), files_.description, problem)) continue;
      named_in_ = path;
      return framework->text();
    }
    return {};
  }

  std::optional<Value> load(const std::string& path) {
    path_ = path;
    if (path.empty()) return std::nullopt;
    return load_json(path, "name a file that is there", sink(path));
  }

  void read_words() {
    if (const auto json = load(find("profile.json", files_.profile))) profile_ = read_profile(*json, sink(path_));
    if (const auto json = load(find("commands.json", files_.commands)))
      words_ = read_commands(*json, known_, sink(path_));
    commands_path_ = path_;
  }

  /// The faults that a node of that framework would report about its commands.
  ConfigFaults faults_of(const std::string& framework, Mode mode, VendorCommands& words) {
    ConfigFaults faults;
    if (words.transport.empty()) words.transport = known_.default_of(mode);
    NodeConfig node;
    node.framework = framework;
    node.mode = mode;
    node.description = out_.description;
    node.places = out_.places;
    node.commands = words;
    known_.check(node, {commands_path_, faults});
    check_described_names(node, known_, files_.description, faults);
    return faults;
  }

  void check_words_of(const std::string& framework) {
    if (profile_.empty()) return;
    const auto mode = profile_.find(framework);
    if (mode == profile_.end()) {
      sink(named_in_).add(named_in_ == kOption ? "" : "framework", in_quotes(framework) + " is not in profile.json",
                          did_you_mean(framework, frameworks(), "add it there with its mode, or use one of"));
      return;
    }
    const bool known = words_.contains(framework);
    VendorCommands words = known ? words_[framework] : VendorCommands();
    if (!known && mode->second != Mode::interpreter) {
      if (commands_path_.empty()) return;
      return sink(commands_path_)
          .add(framework, "is missing: this mode needs the vendor's words",
               "add \"" + framework + R"(": {"port": …, "commands": {"stop": …}})");
    }
    const ConfigFaults faults = faults_of(framework, mode->second, words);
    out_.faults.insert(out_.faults.end(), faults.begin(), faults.end());
    out_.spoken_to.push_back({framework, mode->second, words.transport});
  }

  std::vector<std::string> frameworks() const {
    std::vector<std::string> names;
    for (const auto& [name, ignored] : profile_) names.push_back(name);
    return names;
  }

  /// The maker's own commands serve every skill, whatever else may be wrong with them.
  [[nodiscard]] bool serves(const VendorCommands& words) const {
    const std::vector<Skill>& skills = out_.description.skills;
    return std::all_of(skills.begin(), skills.end(),
                       [&](const Skill& skill) { return words.commands.contains(skill.subtype); });
  }

  /// A maker's own commands fit if they serve every skill, or let the robot's program serve the others, and nothing is
  /// missing; fields fit a framework whose robots use them.
  bool fits(const std::string& framework, Mode mode, VendorCommands& words) {
    const bool well = faults_of(framework, mode, words).empty();
    const Transport* transport = known_.find(words.transport);
    if (transport != nullptr && !transport->names_values) return out_.description.has_field_channel;
    const bool takes_fields = transport != nullptr && transport->takes_fields && out_.description.has_field_channel;
    return well && (takes_fields || serves(words));
  }

  void look_for_words() {
    if (profile_.empty() || commands_path_.empty()) return;
    std::multimap<std::size_t, std::string> nearly;  ///< by the number of faults
    for (const auto& [framework, mode] : profile_) {
      const auto at = words_.find(framework);
      VendorCommands words = at == words_.end() ? VendorCommands() : at->second;
      if (mode == Mode::none || (at == words_.end() && mode != Mode::interpreter)) continue;
      if (fits(framework, mode, words)) {
        out_.spoken_to.push_back({framework, mode, words.transport});
      } else if (!out_.description.skills.empty() && serves(words)) {
        nearly.emplace(faults_of(framework, mode, words).size(), framework);
      }
    }
    if (!out_.spoken_to.empty() || !out_.faults.empty()) return;
    // The one that has all words and the fewest faults is the one that is meant: what is wrong with it is told.
    if (!nearly.empty() && nearly.count(nearly.begin()->first) == 1) return check_words_of(nearly.begin()->second);
    std::string names;
    for (const std::string& name : frameworks()) names += (names.empty() ? "" : ", ") + name;
    sink(files_.description)
        .add("skills", "no framework of " + commands_path_ + " has the words for all of them",
             "see what one lacks with --framework NAME (" + names +
                 R"(), or add "field_channel" for a robot that is programmed to speak fields)");
  }

  const RobotFiles& files_;
  const Transports& known_;
  RobotCheck out_;
  Profile profile_;
  AllCommands words_;
  std::string path_;                ///< of the file that was loaded last
  std::string named_in_ = kOption;  ///< where the framework is named
  std::string commands_path_;
};

}  // namespace

RobotCheck check_robot_files(const RobotFiles& files, const Transports& known) {
  return RobotChecker(files, known).check();
}

}  // namespace trb
