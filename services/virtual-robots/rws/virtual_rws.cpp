#include "services/virtual-robots/rws/virtual_rws.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::rws {

VirtualRws::VirtualRws(const Settings& settings)
    : clock_(settings.speed),
      controller_(settings.access),
      server_(settings.where,
              [this](const HttpRequest& request) {
                controller_.advance(clock_.now());
                return controller_.answer(request, clock_.now());
              }),
      console_(settings.control) {}

void VirtualRws::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(controller_.next_deadline()))) return;
    controller_.advance(clock_.now());
    server_.serve(polled);
    for (const std::string& line : console_.read(polled)) take_line(line);
    for (const std::string& event : controller_.take_events()) print_line(event);
    flush_lines();
  }
}

void VirtualRws::take_line(const std::string& line) {
  if (line == "where") {
    const arm::Joints at = controller_.joints(clock_.now());
    print_line(where_line({at[0], at[1], at[2], at[3], at[4], at[5]}));
  } else if (line == "sessions") {
    print_line("sessions " + std::to_string(controller_.sessions()));
  } else {
    print_line("unknown_line");
  }
}

}  // namespace trb::virtual_robots::rws
