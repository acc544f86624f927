#include "services/virtual-robots/plc/virtual_plc.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::plc {
namespace {

/** Motor and belt have no capabilities: the severity selects the fault. */
FaultCode code_of(const std::string& severity) {
  if (severity == "WARNING") return FaultCode::motor_hot;
  if (severity == "URGENT") return FaultCode::belt_slips;
  return severity == "FATAL" ? FaultCode::emergency_stop : FaultCode::motor_overload;
}

/** How long a jog holds is a time-out of the wire: it keeps real time. */
ConveyorSettings in_robot_time(ConveyorSettings settings, double speed) {
  settings.jog_holds_s *= speed;
  return settings;
}

}  // namespace

VirtualPlc::VirtualPlc(const Settings& settings)
    : clock_(settings.speed),
      conveyor_(in_robot_time(settings.conveyor, settings.speed)),
      server_(settings.where),
      console_(settings.control) {}

void VirtualPlc::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(conveyor_.next_deadline()))) return;
    // The scan: first the passage of time, then the requests.
    conveyor_.advance(clock_.now());
    registers_.set_time(clock_.now());
    server_.serve(polled, registers_);
    for (const std::string& line : console_.read(polled)) take_line(line);
    tell_events();
    flush_lines();
  }
}

void VirtualPlc::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    conveyor_.fault(code_of(fault->severity), clock_.now());
  } else if (line == "overload") {
    conveyor_.fault(FaultCode::motor_overload, clock_.now());
  } else if (line == "estop") {
    conveyor_.fault(FaultCode::emergency_stop, clock_.now());
  } else if (line == "clear") {
    conveyor_.clear(clock_.now());
  } else if (line == "where") {
    print_line(where_line({conveyor_.position_mm(clock_.now()) / 1000}));
  } else if (line == "box") {
    conveyor_.place_box(clock_.now());
  } else if (line == "take") {
    conveyor_.take_box(clock_.now());
  } else {
    print_line("unknown_line");
  }
}

void VirtualPlc::tell_events() {
  for (const std::string& event : conveyor_.take_events()) print_line(event);
}

}  // namespace trb::virtual_robots::plc
