// Checks that commands.json has what a robot with ARCOS needs.
#include "common/config/transports.hpp"
#include "common/drivers/arcos/commands.hpp"
#include "common/drivers/check_requests.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

class ArcosCheck {
 public:
  ArcosCheck(const NodeConfig& config, const FileFaults& faults) : config_(config), faults_(faults) {}

  void run() {
    commands_ = read_arcos_commands(vendor(), config_.description, VendorFaults(config_.framework, faults_));
    check_requests(config_, names_in(vendor().values), faults_);
    for (const Skill& skill : config_.description.skills) this->skill(skill);
  }

 private:
  [[nodiscard]] const VendorCommands& vendor() const { return config_.commands; }
  [[nodiscard]] std::string key(const char* part, const std::string& name) const {
    return config_.framework + "." + part + "." + name;
  }

  void skill(const Skill& skill) {
    if (!vendor().commands.contains(skill.subtype)) {
      if (config_.description.has_field_channel) return;
      return faults_.add(key("commands", skill.subtype), "is missing: skill '" + skill.name + "' sends it",
                         "add it, for example \"goto {0} {1} {2}\"");
    }
    const auto steps = commands_.commands.find(skill.subtype);
    const bool read = steps != commands_.commands.end();
    const bool ends = read && !steps->second.empty() && steps->second.back().travel;
    if (read && !ends && skill.end.kind == EndKind::acknowledgement) {
      faults_.add(key("commands", skill.subtype),
                  "ends skill '" + skill.name + "' with an acknowledgement, which only goto gives",
                  R"(use goto, or give the skill an end of kind "position", "state" or "time")");
    }
    if (ends) units(skill);
    const bool position = skill.end.kind == EndKind::position;
    const std::string watched = skill.end.state.empty() ? "position" : skill.end.state;
    if ((position || skill.end.kind == EndKind::state) && !vendor().values.contains(watched)) {
      faults_.add(key("values", watched), "is missing: the end of skill '" + skill.name + "' is seen by it",
                  "add it with what tells it, for example \"x y heading\"");
    }
  }

  /// A place in metres would be a step of some millimetres.
  void units(const Skill& skill) {
    const RobotFrame& frame = config_.description.frame;
    const bool millimetres = frame.length == 1000;
    if (millimetres && frame.angle != 1) return;
    faults_.add(key("commands", skill.subtype),
                std::string("takes millimetres and degrees, and the description's \"frame\" has ") +
                    (millimetres ? "radians" : "metres"),
                R"(write "frame": {"length_unit": "mm", "angle_unit": "deg"} in the description)");
  }

  const NodeConfig& config_;
  const FileFaults& faults_;
  ArcosCommands commands_;
};

}  // namespace

void check_arcos(const NodeConfig& config, const FileFaults& faults) {
  require_port(config, faults, "8101 for a Pioneer");
  check_words(config.commands, config.framework, faults);
  ArcosCheck(config, faults).run();
}

}  // namespace trb::drivers
