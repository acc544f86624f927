#include "services/virtual-robots/mir/virtual_mir.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::mir {

VirtualMir::VirtualMir(const Settings& settings)
    : clock_(settings.speed),
      robot_(settings.robot),
      rest_(robot_, settings.user.empty() ? "" : authorization_of(settings.user, settings.password)),
      server_(settings.where, [this](const HttpRequest& request) { return answer(request); }),
      console_(settings.control) {}

void VirtualMir::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(robot_.next_deadline()))) return;
    robot_.advance(clock_.now());
    server_.serve(polled);
    for (const std::string& line : console_.read(polled)) take_line(line);
    robot_.advance(clock_.now());
    for (const std::string& event : robot_.take_events()) print_line(event);
    flush_lines();
  }
}

HttpReply VirtualMir::answer(const HttpRequest& request) {
  Answer given = rest_.answer(request.method, request.target, request.header("authorization"), request.body);
  return {given.status, std::move(given.body)};
}

void VirtualMir::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (line == "estop" || (fault && fault->severity == "FATAL")) {
    robot_.emergency_stop();
  } else if (fault) {
    robot_.fail({fault->severity == "CRITICAL" ? 10104 : 10107, fault->text.empty() ? "Motor fault" : fault->text,
                 fault->severity == "CRITICAL"});
  } else if (line == "clear") {
    robot_.end_emergency();
    robot_.clear_errors();
  } else {
    print_line("unknown_line");
  }
}

}  // namespace trb::virtual_robots::mir
