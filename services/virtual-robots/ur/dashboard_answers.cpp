#include "services/virtual-robots/ur/dashboard_answers.hpp"

#include <utility>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/intake.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::string_view kFolder = "/programs/";
constexpr std::string_view kTooEarly =
    "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before unlocking";

std::string mode_name(RobotMode mode) {
  if (mode == RobotMode::power_off) return "POWER_OFF";
  return mode == RobotMode::idle ? "IDLE" : "RUNNING";
}

std::string safety_word(SafetyMode mode) {
  if (mode == SafetyMode::normal) return "NORMAL";
  return mode == SafetyMode::protective_stop ? "PROTECTIVE_STOP" : "ROBOT_EMERGENCY_STOP";
}

/** What is always answered the same. */
struct Phrase {
  std::string_view line;
  std::string_view answer;
};
constexpr Phrase kPhrases[] = {
    {"quit", "Disconnected"},         {"close popup", "closing popup"}, {"close safety popup", "closing safety popup"},
    {"is in remote control", "true"}, {"get robot model", "UR3"},       {"get serial number", "20175399999"},
    {"get operational mode", "NONE"}, {"version", kSoftwareVersion},
};

/** What the controller may refuse. */
struct Order {
  std::string_view line;
  bool (*give)(Controller& controller, double now);
  std::string_view answer;
  std::string_view refusal;
};
constexpr Order kOrders[] = {
    {"power on", [](Controller& c, double now) { return c.power_on(now); }, "Powering on", ""},
    {"power off",
     [](Controller& c, double now) {
       c.power_off(now);
       return true;
     },
     "Powering off", ""},
    {"brake release", [](Controller& c, double now) { return c.release_brakes(now); }, "Brake releasing", ""},
    {"stop", [](Controller& c, double now) { return c.stop(now); }, "Stopped", ""},
    {"pause", [](Controller& c, double now) { return c.pause(now); }, "Pausing program", ""},
    {"unlock protective stop", [](Controller& c, double now) { return c.unlock(now); }, "Protective stop releasing",
     kTooEarly},
};

std::optional<std::string> fixed_answer(std::string_view line) {
  for (const Phrase& phrase : kPhrases) {
    if (line == phrase.line) return std::string(phrase.answer);
  }
  if (line == "PolyscopeVersion") return "URSoftware " + std::string(kSoftwareVersion) + " (Jan 01 2022)";
  if (line.starts_with("popup ")) return "showing popup";
  if (line == "addToLog") return "No log message to add";
  if (line.starts_with("addToLog ")) return "Added log message";
  return std::nullopt;
}

/** A name without a folder: what is loaded lies in the one folder of programs. */
bool is_file_name(std::string_view name) {
  return !name.empty() && name.size() <= 255 && name.front() != '.' && name.find('/') == std::string_view::npos;
}

/** The one program that the text of a file is. */
std::optional<std::string> the_program_of(std::string_view text) {
  Intake intake;
  std::vector<std::string> scripts = intake.take(text);
  if (!intake.fault().empty() || scripts.size() != 1) return std::nullopt;
  const auto compiled = compile(scripts.front());
  const auto* program = std::get_if<Program>(&compiled);
  if (program == nullptr || program->secondary) return std::nullopt;
  return std::move(scripts.front());
}

}  // namespace

std::string DashboardAnswers::answer(std::string_view line, Controller& controller, double now) {
  if (auto fixed = fixed_answer(line)) return *fixed;
  const RobotState state = controller.state(now);
  if (line == "running") return state.program_running ? "Program running: true" : "Program running: false";
  if (line == "programState") return program_state(state, controller);
  if (line == "robotmode") return "Robotmode: " + mode_name(state.mode);
  if (line == "safetymode") return "Safetymode: " + safety_word(state.safety);
  if (line == "safetystatus") return "Safetystatus: " + safety_word(state.safety);
  if (line == "get loaded program") {
    return loaded_.empty() ? "No program loaded" : "Loaded program: " + std::string(kFolder) + loaded_;
  }
  if (line == "isProgramSaved") return loaded_.empty() ? "true" : "true " + loaded_;
  if (line.starts_with("load ")) return load(trim(line.substr(5)));
  if (line == "play") return play(controller, now);
  // Where there is nothing to unlock, nothing is refused.
  if (line == "unlock protective stop" && state.safety != SafetyMode::protective_stop)
    return "Protective stop releasing";
  for (const Order& order : kOrders) {
    if (line != order.line) continue;
    if (order.give(controller, now)) return std::string(order.answer);
    return order.refusal.empty() ? "Failed to execute: " + std::string(line) : std::string(order.refusal);
  }
  return "could not understand: '" + escape_line(line) + "'";
}

std::string DashboardAnswers::program_state(const RobotState& state, const Controller& controller) const {
  const std::string name = played_ == controller.programs_started() ? loaded_ : controller.program_name();
  if (state.program_running) return "PLAYING " + name;
  if (state.program_paused) return "PAUSED " + name;
  return "STOPPED " + (loaded_.empty() ? "<unnamed>" : loaded_);
}

std::string DashboardAnswers::load(std::string_view path) {
  const std::string_view name = path.starts_with(kFolder) ? path.substr(kFolder.size()) : path;
  auto text = is_file_name(name) && programs_ ? programs_(name) : std::nullopt;
  if (!text) return "File not found: " + escape_line(path);
  const auto script = the_program_of(*text + "\n");
  if (!script) return "Error while loading program: " + escape_line(path);
  loaded_ = name;
  text_ = *script;
  return "Loading program: " + escape_line(path);
}

std::string DashboardAnswers::play(Controller& controller, double now) {
  constexpr std::string_view kFailed = "Failed to execute: play";
  if (controller.resume(now)) return "Starting program";
  const std::uint64_t before = controller.programs_started();
  const RobotState state = controller.state(now);
  if (loaded_.empty() || state.program_running || state.program_paused) return std::string(kFailed);
  controller.take(text_, now);
  if (controller.programs_started() == before) return std::string(kFailed);
  played_ = controller.programs_started();
  return "Starting program";
}

}  // namespace trb::virtual_robots::ur
