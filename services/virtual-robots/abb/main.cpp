#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/abb/virtual_abb.hpp"
#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  abb::Settings settings;
  bool die_with_parent = false;
};

abb::Failure failure_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  abb::Failure failure{static_cast<int>(number_option(text.substr(0, colon), 0, 9999)), std::nullopt};
  if (colon != std::string_view::npos) failure.call = static_cast<int>(number_option(text.substr(colon + 1), 1, 1e6));
  return failure;
}

void set_ports(abb::Settings& settings, std::string_view text) {
  settings.port = static_cast<std::uint16_t>(text == "auto" ? 0 : number_option(text, 1, 65534));
  settings.service_port = static_cast<std::uint16_t>(settings.port == 0 ? 0 : settings.port + 1);
}

std::vector<Option> options_of(Request& request) {
  abb::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.2)", [&](auto text) { settings.address = text; }},
      {"--port", "N|auto", "the program's port (5000), and N+1 the service task's; auto takes free ones",
       [&](auto text) { set_ports(settings, text); }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      {"--fail", "CODE[:N]", "the Nth request of that code fails, or every one; repeated: several",
       [&](auto text) { settings.failures.push_back(failure_of(text)); }},
      control_option(settings.control),
      {"--die-with-parent", "", "end when the starting process ends", [&](auto) { request.die_with_parent = true; }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const int parent = ::getppid();
  Request request;
  const std::vector<Option> options = options_of(request);
  try {
    if (!parse_options({argv + 1, argv + argc}, options)) {
      std::fputs(describe_options("trb-virtual-abb", "a virtual ABB with a RAPID server and its service task", options)
                     .c_str(),
                 stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    abb::VirtualAbb(request.settings).run(end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-abb: %s\n", error.what());
    return 2;
  }
}
