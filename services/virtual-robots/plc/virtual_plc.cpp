#include "services/virtual-robots/plc/virtual_plc.hpp"

#include <limits>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::plc {
namespace {

/** A motor and a belt know no capabilities: how bad it is says what has happened. */
FaultCode code_of(const std::string& severity) {
  if (severity == "WARNING") return FaultCode::MotorHot;
  if (severity == "URGENT") return FaultCode::BeltSlips;
  return severity == "FATAL" ? FaultCode::EmergencyStop : FaultCode::MotorOverload;
}

}  // namespace

VirtualPlc::VirtualPlc(const Settings& settings)
    : speed_(settings.speed), conveyor_(settings.conveyor), server_(settings.where), control_(settings.control) {}

void VirtualPlc::run(const Fd& end) {
  print_line("ready " + std::to_string(server_.port()));
  control_.announce();
  for (;;) {
    std::vector<pollfd> polled{
        {end.get(), POLLIN, 0}, {console_.fd(), POLLIN, 0}, {control_.fd(), POLLIN, 0}, {stdout_to_poll(), POLLOUT, 0}};
    server_.add_to_poll(polled);
    const int found = ::poll(polled.data(), polled.size(), poll_timeout(wall_seconds(), next_deadline()));
    if (polled[0].revents != 0) return;
    // The scan: first what time has done, then what is asked.
    conveyor_.advance(robot_now());
    registers_.set_time(robot_now());
    if (found > 0) {
      server_.serve(polled, registers_);
      if (polled[1].revents != 0) {
        for (const std::string& line : console_.read()) take_line(line);
      }
      if (polled[2].revents != 0) {
        for (const std::string& line : control_.read()) take_line(line);
      }
    }
    tell_events();
    flush_lines();
  }
}

void VirtualPlc::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    conveyor_.fault(code_of(fault->severity), robot_now());
  } else if (line == "overload") {
    conveyor_.fault(FaultCode::MotorOverload, robot_now());
  } else if (line == "estop") {
    conveyor_.fault(FaultCode::EmergencyStop, robot_now());
  } else if (line == "clear") {
    conveyor_.clear(robot_now());
  } else if (line == "box") {
    conveyor_.place_box(robot_now());
  } else if (line == "take") {
    conveyor_.take_box(robot_now());
  } else {
    print_line("unknown_line");
  }
}

void VirtualPlc::tell_events() {
  for (const std::string& event : conveyor_.take_events()) print_line(event);
}

double VirtualPlc::next_deadline() const {
  const auto step = conveyor_.next_deadline();
  return step ? begin_ + *step / speed_ : std::numeric_limits<double>::infinity();
}

}  // namespace trb::virtual_robots::plc
