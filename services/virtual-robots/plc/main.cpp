#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <system_error>

#include "services/virtual-robots/plc/virtual_plc.hpp"
#include "services/virtual-robots/support/options.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  plc::Settings settings;
  bool die_with_parent = false;
};

std::vector<Option> options_of(Request& request) {
  plc::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.2)", [&](auto text) { settings.where.address = text; }},
      {"--port", "N|auto", "the Modbus TCP port (502); auto takes a free one",
       [&](auto text) {
         settings.where.port = text == "auto" ? 0 : static_cast<std::uint16_t>(number_option(text, 1, 65535));
       }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      {"--length-mm", "N", "how long the belt is (2000)",
       [&](auto text) { settings.conveyor.length_mm = number_option(text, 100, 60000); }},
      {"--bring-boxes", "", "a box lies at the entry whenever the belt starts with none on its way",
       [&](auto) { settings.conveyor.brings_boxes = true; }},
      control_option(settings.control),
      {"--die-with-parent", "", "end when the starting process ends", [&](auto) { request.die_with_parent = true; }},
  };
}

int complain(const std::exception& error) {
  std::fprintf(stderr, "trb-virtual-plc: %s\n", error.what());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const int parent = ::getppid();
  Request request;
  const std::vector<Option> options = options_of(request);
  try {
    if (!parse_options({argv + 1, argv + argc}, options)) {
      std::fputs(describe_options("trb-virtual-plc", "a belt conveyor's controller on Modbus TCP", options).c_str(),
                 stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    plc::VirtualPlc(request.settings).run(end);
    return 0;
  } catch (const std::system_error& error) {
    if (error.code().value() == EACCES) {
      std::fputs("trb-virtual-plc: a port below 1024 needs root; use --port, and \"port\" in commands.json\n", stderr);
    }
    return complain(error);
  } catch (const std::exception& error) {
    return complain(error);
  }
}
