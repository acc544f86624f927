#include "common/simulation/job_nodes.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::simulation;

TEST_CASE("of so many robots the nodes are the cloud, r0, r1 and so on, written in one way") {
  const JobNodes nodes(12);
  for (const char* id : {"cloud", "r0", "r9", "r10", "r11"}) {
    CAPTURE(id);
    CHECK(nodes.has(id));
  }
  for (const char* id : {"", "r", "r12", "r00", "r01", "r-1", "r+1", "r 1", "r1 ", "r1x", "x1", "R1", "1",
                         "r4294967296", "r18446744073709551616"}) {
    CAPTURE(id);
    CHECK_FALSE(nodes.has(id));
  }
  CHECK_FALSE(JobNodes(0).has("r0"));
}

TEST_CASE("of a fleet the nodes are the cloud and its robots") {
  const JobNodes nodes(std::map<std::string, NodeProfile>{{"arm", {}}, {"r7", {}}});
  for (const char* id : {"cloud", "arm", "r7"}) {
    CAPTURE(id);
    CHECK(nodes.has(id));
  }
  CHECK_FALSE(nodes.has("r0"));
  CHECK_FALSE(nodes.has("belt"));
}
