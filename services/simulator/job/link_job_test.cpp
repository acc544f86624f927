#include <doctest/doctest.h>

#include "services/simulator/job/job.hpp"

using namespace trb;
using namespace trb::simulator;

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

TEST_CASE("on a link so narrow that an acknowledgement comes late, what is sent again is no defect") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "robots": 3, "tasks": 4,
      "link": {"delay_s": 0.01, "bytes_a_second": 5000}})",
                           faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  const world::Played played = world.play();
  CHECK_FALSE(world.repeats().first().empty());
  CHECK(played.broken.empty());
  CHECK(played.state == RunState::finished);
}
