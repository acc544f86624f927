#include "services/virtual-robots/kuka/virtual_kuka.hpp"

#include <algorithm>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::kuka {
namespace {

constexpr std::size_t kMostClients = 16;
constexpr double kIdle = 60;

}  // namespace

VirtualKuka::VirtualKuka(const Settings& settings)
    : speed_(settings.speed),
      program_(settings.failures),
      server_({settings.address, settings.port}, kMostClients),
      control_(settings.control) {}

void VirtualKuka::run(const Fd& end) {
  print_line("ready " + std::to_string(server_.port()));
  control_.announce();
  for (;;) {
    std::vector<pollfd> polled{
        {end.get(), POLLIN, 0}, {console_.fd(), POLLIN, 0}, {control_.fd(), POLLIN, 0}, {stdout_to_poll(), POLLOUT, 0}};
    server_.add_to_poll(polled);
    const int found = ::poll(polled.data(), polled.size(), poll_timeout(wall_seconds(), next_deadline()));
    if (polled[0].revents != 0) return;
    if (found > 0) {
      if (polled[1].revents != 0) {
        for (const std::string& line : console_.read()) take_line(line);
      }
      if (polled[2].revents != 0) {
        for (const std::string& line : control_.read()) take_line(line);
      }
      server_.serve(polled, [this](TcpServer::Client& client) { serve(client); });
    }
    flush_lines();
    program_.advance(robot_now());
    tell_events();
  }
}

void VirtualKuka::serve(TcpServer::Client& client) {
  while (auto request = take_request(client.input)) {
    if (!request->well_formed) {
      // The lengths contradict each other: what follows may be anything.
      server_.send(client, reply(*request, "", Code::Protocol));
      return TcpServer::drop(client, "bad_request");
    }
    server_.send(client, answer(*request));
    program_.advance(robot_now());
    tell_events();
  }
}

std::string VirtualKuka::answer(const Request& request) {
  Variables& variables = program_.variables();
  if (request.type > 1) return reply(request, "", Code::NotImplemented);
  program_.advance(robot_now());
  if (request.type == 0) {
    if (request.name == "PING") return reply(request, "PONG", Code::Success);
    const auto value = variables.read(request.name);
    return value ? reply(request, *value, Code::Success) : reply(request, "", Code::General);
  }
  const bool taken = variables.write(request.name, request.value);
  print_line((taken ? "write " : "refused ") + escape_line(request.name) + " " + escape_line(request.value));
  return taken ? reply(request, request.value, Code::Success) : reply(request, "", Code::General);
}

void VirtualKuka::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  if (fault) {
    const std::string text = fault->text.empty() ? "fault of " + fault->capability : fault->text;
    program_.raise_fault(fault->capability, fault->severity, text, robot_now());
  } else if (order == "clear") {
    program_.clear(robot_now());
  } else if (line == "program cancel" || line == "program select") {
    program_.select(line == "program select", robot_now());
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

double VirtualKuka::next_deadline() const {
  const auto step = program_.next_deadline();
  return step ? begin_ + *step / speed_ : wall_seconds() + kIdle;
}

}  // namespace trb::virtual_robots::kuka
