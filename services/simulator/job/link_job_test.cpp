#include "services/simulator/job/link_job.hpp"

#include <doctest/doctest.h>

#include "services/simulator/job/test/refused_job.hpp"

using namespace trb;
using namespace trb::simulator;
using namespace trb::simulator::test;

namespace {

std::string linked_job(const std::string& link) {
  return R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "link": )" + link + "}";
}

/// What the run's two hand-overs and its three tasks take by such a link.
double makespan_by(const std::string& link) {
  ConfigFaults faults;
  const Job job = read_job(linked_job(link), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  const world::Played played = world::World(*job.world).play();
  CHECK(played.broken.empty());
  CHECK(played.tasks_done == 3);
  return played.makespan_s;
}

}  // namespace

TEST_CASE("a link of one's own delays as much as it says: constant, about normal, as measured") {
  const double lan = makespan_by(R"("lan")");
  const double constant = makespan_by(R"({"delay_s": 0.1})");
  const double normal = makespan_by(R"({"delay_s": 0.1, "deviation_s": 0.02})");
  const double measured = makespan_by(R"({"delays_s": [0.08, 0.1, 0.12]})");
  // A baton goes over twice, and each needs at least one way.
  for (const double by : {constant, normal, measured}) {
    CHECK(by > lan + 0.15);
    CHECK(by < lan + 2);
  }
  CHECK(makespan_by(R"({"delays_s": [0.1]})") == doctest::Approx(constant).epsilon(0.01));
}

TEST_CASE("a narrow link takes the time that the bytes need, and a lossy one sends again") {
  const double wide = makespan_by(R"({"delay_s": 0.001})");
  CHECK(makespan_by(R"({"delay_s": 0.001, "bytes_a_second": 20000})") > wide + 0.05);
  CHECK(makespan_by(R"({"delay_s": 0.001, "loss": 0.3})") > wide + 0.1);
}

TEST_CASE("what is wrong with a link is named") {
  for (const Wrong& one :
       {Wrong{R"("string")", "link"}, Wrong{"3", "link"}, Wrong{"{}", "link.delay_s"},
        Wrong{R"({"delay_s": 11})", "link.delay_s"},
        Wrong{R"({"delay_s": 0.1, "deviation_s": 0.2})", "link.deviation_s"},
        Wrong{R"({"delays_s": []})", "link.delays_s"}, Wrong{R"({"delays_s": [0.1, -1]})", "link.delays_s[1]"},
        Wrong{R"({"delays_s": [0.1], "delay_s": 0.1})", "link.delay_s"},
        Wrong{R"({"delay_s": 0.1, "loss": 0.6})", "link.loss"},
        Wrong{R"({"delay_s": 0.1, "bytes_a_second": 1})", "link.bytes_a_second"}}) {
    check_refused(linked_job(one.text), one.key);
  }
}
