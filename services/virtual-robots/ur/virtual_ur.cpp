#include "services/virtual-robots/ur/virtual_ur.hpp"

#include <algorithm>
#include <fstream>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr double kStatePeriod = 0.1;

DashboardAnswers::Programs programs_in(const std::string& folder) {
  if (folder.empty()) return {};
  return [folder](std::string_view name) -> std::optional<std::string> {
    std::ifstream file(folder + "/" + std::string(name), std::ios::binary);
    if (!file) return std::nullopt;
    std::string text(Intake::kLongestProgram + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.size() > Intake::kLongestProgram) return std::nullopt;
    return text;
  };
}

}  // namespace

VirtualUr::VirtualUr(const Settings& settings)
    : clock_(settings.speed),
      controller_(settings.mode),
      server_(settings.address, settings.port_base),
      dashboard_(server_.take_dashboard(), DashboardAnswers(programs_in(settings.programs))),
      rtde_(server_.take_rtde()),
      console_(settings.control) {}

void VirtualUr::run(const Fd& end) {
  console_.announce(std::to_string(server_.primary_port()) + " " + std::to_string(server_.secondary_port()) + " " +
                    std::to_string(dashboard_.port()) + " " + std::to_string(rtde_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    dashboard_.add_to_poll(polled);
    rtde_.add_to_poll(polled);
    if (!Console::wait(polled, next_deadline())) return;
    serve(polled);
    flush_lines();
    controller_.advance(clock_.now());
    tell_events();
    send_state();
    rtde_.send_due(controller_, clock_.now());
  }
}

void VirtualUr::serve(const std::vector<pollfd>& polled) {
  for (const std::string& script : server_.serve(polled)) {
    controller_.take(script, clock_.now());
    tell_events();
  }
  dashboard_.serve(polled, controller_, clock_.now());
  rtde_.serve(polled, controller_, clock_.now());
  server_.greet(version_packet() + robot_state_packet(controller_.state(clock_.now()), time_us()));
  for (const std::string& line : console_.read(polled)) take_console_line(line);
}

void VirtualUr::take_console_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    take_fault(*fault);
  } else if (line == "where") {
    const Joints joints = controller_.state(clock_.now()).joints.position;
    const auto flange = flange_of(joints);
    print_line(where_line(
        {joints[0], joints[1], joints[2], joints[3], joints[4], joints[5], flange[0], flange[1], flange[2]}));
  } else if (line == "protective_stop") {
    controller_.set_safety(SafetyMode::protective_stop, clock_.now());
  } else if (line == "estop") {
    controller_.set_safety(SafetyMode::emergency_stop, clock_.now());
  } else if (line == "clear") {
    controller_.set_safety(SafetyMode::normal, clock_.now());
  } else if (order == "input") {
    take_input(words);
  } else if (line == "brake_release") {
    controller_.release_brakes(clock_.now());
  } else {
    print_line("unknown_line");
  }
}

/** `input N on|off` */
void VirtualUr::take_input(std::string_view words) {
  constexpr long long kInputs = 18;
  const auto index = parse_integer(take_word(words));
  const bool known = index && *index >= 0 && *index < kInputs && (words == "on" || words == "off");
  if (!known) return print_line("unknown_line");
  controller_.set_input(static_cast<int>(*index), words == "on");
}

/** An arm's controller has no capabilities: a fault stops the whole arm, or is only a warning. */
void VirtualUr::take_fault(const FaultOrder& order) {
  const bool warning = order.severity == "WARNING";
  const bool fatal = order.severity == "FATAL";
  const ErrorLevel level = warning ? ErrorLevel::warning : fatal ? ErrorLevel::fault : ErrorLevel::violation;
  controller_.raise_error(level, order.text.empty() ? "fault of " + order.capability : order.text, clock_.now());
  if (warning) return;
  controller_.set_safety(fatal ? SafetyMode::emergency_stop : SafetyMode::protective_stop, clock_.now());
}

void VirtualUr::tell_events() {
  for (const Event& event : controller_.take_events()) {
    print_line(line_of(event));
    if (const auto packet = packet_of(event, time_us())) server_.send_to_primary(*packet);
  }
}

void VirtualUr::send_state() {
  const double now = wall_seconds();
  if (now < next_state_) return;
  // After a long pause of the process the missed packets are not sent all at once.
  next_state_ = std::max(next_state_ + kStatePeriod, now);
  server_.send_to_all(robot_state_packet(controller_.state(clock_.now()), time_us()));
}

double VirtualUr::next_deadline() const {
  return std::min(std::min(next_state_, rtde_.next_due()), clock_.deadline(controller_.next_deadline()));
}

}  // namespace trb::virtual_robots::ur
