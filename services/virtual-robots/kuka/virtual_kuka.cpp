#include "services/virtual-robots/kuka/virtual_kuka.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::kuka {
namespace {

constexpr std::size_t kMostClients = 16;

}  // namespace

VirtualKuka::VirtualKuka(const Settings& settings)
    : clock_(settings.speed),
      program_(settings.failures),
      server_({settings.address, settings.port}, kMostClients),
      console_(settings.control) {}

void VirtualKuka::run(const Fd& end) {
  console_.announce(std::to_string(server_.port()));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    server_.add_to_poll(polled);
    if (!Console::wait(polled, clock_.deadline(program_.next_deadline()))) return;
    for (const std::string& line : console_.read(polled)) take_line(line);
    server_.serve(polled, [this](TcpServer::Client& client) { serve(client); });
    flush_lines();
    program_.advance(clock_.now());
    tell_events();
  }
}

void VirtualKuka::serve(TcpServer::Client& client) {
  while (auto request = take_request(client.input)) {
    if (!request->well_formed) {
      // The lengths contradict each other: what follows may be anything.
      server_.send(client, reply(*request, "", Code::protocol));
      return client.drop("bad_request");
    }
    server_.send(client, answer(*request));
    program_.advance(clock_.now());
    tell_events();
  }
}

std::string VirtualKuka::answer(const Request& request) {
  Variables& variables = program_.variables();
  if (request.type > 1) return reply(request, "", Code::not_implemented);
  program_.advance(clock_.now());
  if (request.type == 0) {
    if (request.name == "PING") return reply(request, "PONG", Code::success);
    const auto value = variables.read(request.name);
    return value ? reply(request, *value, Code::success) : reply(request, "", Code::general);
  }
  const bool taken = variables.write(request.name, request.value);
  print_line((taken ? "write " : "refused ") + escape_line(request.name) + " " + escape_line(request.value));
  return taken ? reply(request, request.value, Code::success) : reply(request, "", Code::general);
}

void VirtualKuka::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    const std::string text = fault->text.empty() ? "fault of " + fault->capability : fault->text;
    program_.raise_fault(fault->capability, fault->severity, text, clock_.now());
  } else if (order == "clear") {
    program_.clear(clock_.now());
  } else if (line == "program cancel" || line == "program select") {
    program_.select(line == "program select", clock_.now());
  } else if (order == "say") {
    const std::string type(take_word(words));
    const std::string subtype(take_word(words));
    const std::string target(take_word(words));
    program_.say(type, subtype, target == "-" ? "" : target, unescape_line(words));
  } else {
    print_line("unknown_line");
  }
}

void VirtualKuka::tell_events() {
  for (const std::string& event : program_.take_events()) print_line(event);
}

}  // namespace trb::virtual_robots::kuka
