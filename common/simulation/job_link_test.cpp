#include "common/simulation/job_link.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::simulation;

namespace {

struct Read {
  LinkKind link;
  ConfigFaults faults;
};

Read read(const std::string& link) {
  Read out;
  const auto json = parse_json(R"({"link": )" + link + "}");
  REQUIRE(json.ok());
  ObjectReader reader(*json, "", FileFaults("job", out.faults));
  out.link = read_link(reader);
  reader.refuse_unknown_keys();
  return out;
}

}  // namespace

TEST_CASE("a link has a name, or is described") {
  CHECK(read(R"("vpn")").link.delay == std::chrono::milliseconds(40));
  const LinkKind own = read(R"({"delay_s": 0.02, "deviation_s": 0.005, "loss": 0.001, "bytes_a_second": 5000})").link;
  CHECK(own.delay == std::chrono::milliseconds(20));
  CHECK(own.deviation == std::chrono::milliseconds(5));
  CHECK(own.loss == 1000);
  CHECK(read(R"({"delay_s": 0, "loss": 1e-6})").link.loss == 1);
  CHECK(read(R"({"delay_s": 0, "loss": 0})").faults.empty());
  CHECK(own.bytes_a_second == 5000);
  CHECK(read(R"({"delays_s": [0.01, 0.4]})").link.longest() == std::chrono::milliseconds(400));
}

TEST_CASE("what is wrong with a link is named") {
  struct Case {
    const char* link;
    const char* key;
  };
  for (const Case& one :
       {Case{R"("string")", "link"}, Case{"3", "link"}, Case{"{}", "link.delay_s"},
        Case{R"({"delay_s": 11})", "link.delay_s"}, Case{R"({"delay_s": 0.1, "deviation_s": 0.2})", "link.deviation_s"},
        Case{R"({"delays_s": []})", "link.delays_s"}, Case{R"({"delays_s": [0.1, -1]})", "link.delays_s[1]"},
        Case{R"({"delays_s": [0.1], "delay_s": 0.1})", "link.delay_s"},
        Case{R"({"delay_s": 0.1, "loss": 0.6})", "link.loss"}, Case{R"({"delay_s": 0.1, "loss": 9e-7})", "link.loss"},
        Case{R"({"delay_s": 0.1, "bytes_a_second": 1})", "link.bytes_a_second"}}) {
    CAPTURE(one.link);
    const ConfigFaults faults = read(one.link).faults;
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
}
