// A driver is made only from texts that can be parsed.
#include "common/drivers/registry.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::drivers;

namespace {

struct Bad {
  const char* transport;
  const char* words;
};

DriverSettings settings(const Bad& bad) {
  DriverSettings out;
  out.id = "robot";
  out.commands.transport = bad.transport;
  out.commands.commands = {{"go", bad.words}};
  return out;
}

}  // namespace

TEST_CASE("words that cannot be read make no driver, and the error names their key") {
  for (const Bad& bad : std::vector<Bad>{{"rapid", "two"},
                                         {"rapid", "service 2"},
                                         {"c3", "A B = 1"},
                                         {"ros", "no topic"},
                                         {"udp-at", "FLY"},
                                         {"arcos", "FLY"},
                                         {"modbus", "speed = 1"},
                                         {"http-json", "FETCH /status"},
                                         {"tcp-dialogue", "go -> *"}}) {
    const DriverRow* row = find_driver(bad.transport);
    REQUIRE(row != nullptr);
    const auto made = row->make(settings(bad));
    REQUIRE_FALSE_MESSAGE(made.ok(), bad.words);
    CHECK(made.error().what.starts_with("commands.json: " + std::string(bad.transport) + ".commands.go: "));
    CHECK_FALSE(made.error().hint.empty());
    CHECK_THROWS(make_driver(settings(bad)));
  }
}

TEST_CASE("a robot that is spoken to in fields alone, or by no transport, has no driver of its own") {
  CHECK(make_driver(settings({"lines", "anything"})) == nullptr);
  CHECK(make_driver(settings({"", "anything"})) == nullptr);
}
