// trb-bench-gateway: the gateway's robots and its pages, for scripts/bench gateway (tests/bench/README.md).
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/transport/signals.hpp"
#include "tests/bench/bench_main.hpp"
#include "tests/bench/gateway/feeder.hpp"
#include "tests/bench/gateway/pages.hpp"

namespace trb::bench {
namespace {

constexpr const char* kHelp =
    "trb-bench-gateway ROLE ARGUMENT...\n\n"
    "  feed NODE_DIR ROBOTS CHANGES                                 the node's router, and robots with so many "
    "changes\n"
    "                                                               a second each; until SIGTERM\n"
    "  look PORT CERTIFICATE TOKEN PAGES STALLED ROBOTS CHANGES WARM_S SECONDS\n"
    "                                                               pages of the gateway at that port of 127.0.0.1\n\n"
    "Usually started by scripts/bench gateway. Example: trb-bench-gateway feed nodes/cloud 1000 10";

using Words = std::vector<std::string>;

int feed(const Words& words) {
  block_signals();
  const NodeCheck check = check_node_dir(words[0], false);
  auto keys = load_node_keys(words[0]);
  if (!keys) throw std::runtime_error(keys.error().text());
  if (check.config.bus.empty()) throw std::runtime_error(words[0] + "/node.json: \"bus\" has to be tcp://");
  Feeder feeder(check.config, std::move(*keys), std::stoi(words[1]), std::stod(words[2]));
  if (const Status opened = feeder.open(); !opened) throw std::runtime_error(opened.error().text());
  std::puts("feeding");
  std::fflush(stdout);
  feeder.run();
  return 0;
}

int look(const Words& words) {
  PagesSettings settings;
  settings.port = static_cast<std::uint16_t>(std::stoi(words[0]));
  settings.certificate_file = words[1];
  settings.token = words[2];
  settings.pages = std::stoi(words[3]);
  settings.stalled = std::stoi(words[4]);
  settings.robots = std::stoi(words[5]);
  settings.changes = std::stod(words[6]);
  settings.warm_s = std::stod(words[7]);
  settings.seconds = std::stod(words[8]);
  return watch_as_pages(settings) ? 0 : 1;
}

int run(const std::string& role, const Words& words) {
  if (role == "feed" && words.size() == 3) return feed(words);
  if (role == "look" && words.size() == 9) return look(words);
  std::puts(kHelp);
  return role == "--help" ? 0 : 2;
}

}  // namespace
}  // namespace trb::bench

int main(int argc, char** argv) {
  return trb::bench::bench_main("trb-bench-gateway", argc, argv, trb::bench::run);
}
