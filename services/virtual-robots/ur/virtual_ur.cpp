#include "services/virtual-robots/ur/virtual_ur.hpp"

#include <algorithm>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr double kStatePeriod = 0.1;

}  // namespace

VirtualUr::VirtualUr(const Settings& settings)
    : speed_(settings.speed),
      controller_(settings.mode),
      server_(settings.address, settings.port_base),
      dashboard_(server_.take_dashboard()),
      control_(settings.control) {}

void VirtualUr::run(const Fd& end) {
  print_line("ready " + std::to_string(server_.primary_port()) + " " + std::to_string(server_.secondary_port()) + " " +
             std::to_string(dashboard_.port()));
  control_.announce();
  for (;;) {
    std::vector<pollfd> polled{
        {end.get(), POLLIN, 0}, {console_.fd(), POLLIN, 0}, {control_.fd(), POLLIN, 0}, {stdout_to_poll(), POLLOUT, 0}};
    server_.add_to_poll(polled);
    dashboard_.add_to_poll(polled);
    const int found = ::poll(polled.data(), polled.size(), poll_timeout(wall_seconds(), next_deadline()));
    if (polled[0].revents != 0) return;
    if (found > 0) serve(polled);
    flush_lines();
    controller_.advance(robot_now());
    tell_events();
    send_state();
  }
}

void VirtualUr::serve(const std::vector<pollfd>& polled) {
  for (const std::string& script : server_.serve(polled)) {
    controller_.take(script, robot_now());
    tell_events();
  }
  dashboard_.serve(polled, controller_, robot_now());
  server_.greet(version_packet() + robot_state_packet(controller_.state(robot_now()), time_us()));
  if (polled[1].revents != 0) {
    for (const std::string& line : console_.read()) take_console_line(line);
  }
  if (polled[2].revents != 0) {
    for (const std::string& line : control_.read()) take_console_line(line);
  }
}

void VirtualUr::take_console_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    take_fault(*fault);
  } else if (line == "protective_stop") {
    controller_.set_safety(SafetyMode::ProtectiveStop, robot_now());
  } else if (line == "estop") {
    controller_.set_safety(SafetyMode::EmergencyStop, robot_now());
  } else if (line == "clear") {
    controller_.set_safety(SafetyMode::Normal, robot_now());
  } else {
    print_line("unknown_line");
  }
}

/** An arm's controller knows no capabilities: whatever fails stops the whole arm, or is a mere warning. */
void VirtualUr::take_fault(const FaultOrder& order) {
  const bool warning = order.severity == "WARNING";
  const bool fatal = order.severity == "FATAL";
  const ErrorLevel level = warning ? ErrorLevel::Warning : fatal ? ErrorLevel::Fault : ErrorLevel::Violation;
  controller_.raise_error(level, order.text.empty() ? "fault of " + order.capability : order.text, robot_now());
  if (warning) return;
  controller_.set_safety(fatal ? SafetyMode::EmergencyStop : SafetyMode::ProtectiveStop, robot_now());
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
  // After a long pause of the process the missed packets are not sent one after the other.
  next_state_ = std::max(next_state_ + kStatePeriod, now);
  server_.send_to_all(robot_state_packet(controller_.state(robot_now()), time_us()));
}

double VirtualUr::next_deadline() const {
  const auto step = controller_.next_deadline();
  return step ? std::min(next_state_, begin_ + *step / speed_) : next_state_;
}

}  // namespace trb::virtual_robots::ur
