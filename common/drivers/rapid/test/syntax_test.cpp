// The notation of an ABB with a RAPID server: what can be parsed, and the faults that trb check reports for the rest.
#include "common/drivers/rapid/syntax.hpp"

#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

constexpr const char* kGood = R"json({"abb": {"port": 5000, "transport": "rapid",
  "monitor": {"protocol": "rapid-service", "port": 5001}, "values": {"position": "service 3 0 1"},
  "commands": {"go": "2 {0} 5\n20 1", "stop": "service 91", "release": "service 92"},
  "requests": {"where": "position", "motors": "motors"}}})json";

struct Change {
  std::string from, to, key, text;
};

}  // namespace

TEST_CASE("requests: a code, and parameters that end nothing") {
  const auto read = read_rapid_requests("2 {0}  -1.5 fast\n\nservice 91");
  REQUIRE(read.ok());
  REQUIRE(read->size() == 2);
  CHECK((*read)[0].text == "2 {0} -1.5 fast #");
  CHECK((*read)[1].service);
  for (const char* bad : {"move 1", "service", "-1", "2 a#b", "2 {word}", "2 \"x\"", "10000"}) {
    CHECK_FALSE_MESSAGE(read_rapid_requests(bad).ok(), bad);
  }
  CHECK(read_rapid_requests("2 " + std::string(80, '1')).error().code == Errc::too_large);
}

TEST_CASE("questions: a code and the indices of its numbers") {
  CHECK(read_rapid_question("service 4 0 5")->indices == std::vector<std::size_t>{0, 5});
  CHECK(read_rapid_question("4")->request.text == "4 #");
  for (const char* bad : {"", "x", "4 -1", "4 99", "4 a"}) CHECK_FALSE_MESSAGE(read_rapid_question(bad).ok(), bad);
}

TEST_CASE("an ABB's files: each mistake is told with its key") {
  const std::vector<Change> changes = {
      {"", "", "", ""},
      {"\"port\": 5000, ", "", "abb.port", "is missing"},
      {"\"monitor\": {\"protocol\": \"rapid-service\", \"port\": 5001}, ", "", "abb.monitor", "a stop would wait"},
      {"rapid-service", "ur-primary", "abb.monitor.protocol", "not of the transport"},
      {"20 1", "grip 1", "abb.commands.go", "does not begin with a request's code"},
      {"service 91", "91", "abb.commands.stop", "wait for the end of a move"},
      {"2 {0} 5", "service 2", "abb.commands.go", "moves nothing"},
      {"service 3 0 1", "service 3 x", "abb.values.position", "no index"},
      {"\"where\": \"position\"", "\"where\": \"positon\"", "abb.requests.where", "not one of the values"},
      {"\"go\":", "\"goo\":", "abb.commands.go", "is missing"}};
  for (const Change& change : changes) {
    const NodeFolder folder("abb");
    folder.write("profile.json", R"({"abb": "direct"})");
    folder.write("commands.json", kGood);
    if (!change.key.empty()) folder.change("commands.json", change.from, change.to);
    const ConfigFaults faults = without_keys(folder.check().faults);
    CHECK_MESSAGE(faults.empty() == change.key.empty(), change.to, "\n", to_text(faults));
    if (faults.empty()) continue;
    CHECK_MESSAGE(faults[0].key == change.key, to_text(faults));
    CHECK_MESSAGE(faults[0].what.find(change.text) != std::string::npos, to_text(faults));
    CHECK_FALSE(faults[0].hint.empty());
  }
}
