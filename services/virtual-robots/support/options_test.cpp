#include "services/virtual-robots/support/options.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/support/socket.hpp"

using namespace trb::virtual_robots;

TEST_CASE("options: values, switches, help and mistakes") {
  std::string name;
  bool quiet = false;
  const std::vector<Option> options = {
      {"--name", "NAME", "a name", [&](auto text) { name = text; }},
      {"--quiet", "", "no words", [&](auto) { quiet = true; }},
  };
  CHECK(parse_options({"--quiet", "--name", "--quiet"}, options));
  CHECK(quiet);
  CHECK(name == "--quiet");
  CHECK_FALSE(parse_options({"--help"}, options));
  CHECK_THROWS_AS(parse_options({"--name"}, options), OptionError);
  CHECK_THROWS_AS(parse_options({"--loud"}, options), OptionError);
  CHECK_THROWS_AS(number_option("nan", 0, 1), OptionError);
  CHECK_THROWS_AS(number_option("2", 0, 1), OptionError);
  CHECK(number_option("0.5", 0, 1) == 0.5);
}

TEST_CASE("endpoints: an address and a port") {
  CHECK(parse_endpoint("127.0.1.1:40000")->port == 40000);
  for (const char* bad : {"", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:70000", "host:1", ":1"}) {
    CHECK_FALSE(parse_endpoint(bad));
  }
}
