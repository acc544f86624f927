#include "services/virtual-robots/abb/virtual_abb.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::abb {

VirtualAbb::VirtualAbb(const Settings& settings)
    : clock_(settings.speed),
      controller_(settings.failures),
      program_({settings.address, settings.port}, 1, TcpServer::Extra::waits),
      service_({settings.address, settings.service_port}, 1, TcpServer::Extra::waits),
      console_(settings.control) {}

void VirtualAbb::run(const Fd& end) {
  console_.announce(std::to_string(program_.port()) + " " + std::to_string(service_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    program_.add_to_poll(polled);
    service_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(controller_.next_deadline()))) return;
    for (const std::string& line : console_.read(polled)) take_line(line);
    program_.serve(polled, [this](TcpServer::Client& client) { serve_program(client); });
    service_.serve(polled, [this](TcpServer::Client& client) { serve_service(client); });
    flush_lines();
    follow();
  }
}

/** The program reads nothing while a move blocks it. */
void VirtualAbb::serve_program(TcpServer::Client& client) {
  while (!controller_.blocked()) {
    const auto text = take_string(client.input);
    if (!text) return;
    requester_ = client.id;
    answer(controller_.program(*text, clock_.now()));
    tell_events();
  }
}

void VirtualAbb::serve_service(TcpServer::Client& client) {
  while (const auto text = take_string(client.input)) service_.send(client, controller_.service(*text, clock_.now()));
}

/** A client that has left gets no answer. */
void VirtualAbb::answer(const std::optional<std::string>& text) {
  TcpServer::Client* client = text ? program_.find(requester_) : nullptr;
  if (client != nullptr) program_.send(*client, *text);
}

void VirtualAbb::follow() {
  const auto ended = controller_.advance(clock_.now());
  answer(ended);
  tell_events();
  TcpServer::Client* client = ended ? program_.find(requester_) : nullptr;
  if (client != nullptr) serve_program(*client);
}

void VirtualAbb::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    const std::string text = fault->text.empty() ? "fault of " + fault->capability : fault->text;
    answer(controller_.raise_fault(fault->capability, fault->severity, text, clock_.now()));
  } else if (order == "clear") {
    controller_.clear();
  } else {
    print_line("unknown_line");
  }
}

void VirtualAbb::tell_events() {
  for (const std::string& event : controller_.take_events()) print_line(event);
}

}  // namespace trb::virtual_robots::abb
