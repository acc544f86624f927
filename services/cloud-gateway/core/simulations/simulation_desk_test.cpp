// Simulations as jobs: the table of simulation_desk.hpp, line by line, and its bounds.
#include "services/cloud-gateway/core/simulations/simulation_desk.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace trb;
using namespace trb::gateway;

namespace {

using Kind = SimulationOrder::Kind;

SimulationJob job_of(const std::string& input) {
  return {input, input, input, 1, 1};
}

/// A desk, its time, and the program as it sees it.
struct Bench {
  SimulationDesk desk{[n = std::uint8_t{0}](std::size_t size) mutable { return Bytes(size, static_cast<char>(++n)); }};
  Now now{MonotonicTime{} + std::chrono::hours(1), UtcTime{1'800'000'000'000'000'000}};
  std::vector<std::string> started;
  int ended = 0;

  void pass(Duration time) {
    now.mono = now.mono + time;
    now.utc = UtcTime{now.utc.ns + time.count()};
    desk.tick(now);
    obey();
  }
  void obey() {
    while (const auto order = desk.take_order(now)) {
      if (order->kind == Kind::start) started.push_back(order->job);
      if (order->kind == Kind::end) ++ended;
    }
  }
  std::string add(const std::string& job) {
    const auto added = desk.add(job_of(job), "olga", now);
    REQUIRE(added.ok());
    std::string id = (*added)->id;
    obey();
    return id;
  }
  Result<const Simulation*> remove(const std::string& id) {
    auto out = desk.remove(id, now);
    obey();
    return out;
  }
  void gone(Result<Bytes> answer) {
    desk.on_gone(std::move(answer), now);
    obey();
  }
  const Simulation& of(const std::string& id) {
    const Simulation* one = desk.find(id);
    REQUIRE(one != nullptr);
    return *one;
  }
};

const Error kKilled = fail(Errc::io_error, "it was killed", "start it again");

}  // namespace

TEST_CASE("one runs, and its program's answer makes it done") {
  Bench bench;
  const std::string id = bench.add("{1}");
  CHECK(bench.started == std::vector<std::string>{"{1}"});
  CHECK(bench.of(id).state == SimulationState::running);
  CHECK(bench.of(id).by == "olga");
  CHECK(bench.of(id).began == bench.now.utc);
  bench.desk.on_progress({12.5, 3});
  CHECK(bench.of(id).progress == SimulationProgress{12.5, 3});
  bench.pass(std::chrono::seconds(2));
  bench.gone(Bytes("{answer}"));
  CHECK(bench.of(id).state == SimulationState::done);
  CHECK(bench.of(id).answer == "{answer}");
  CHECK(bench.of(id).ended->ns - bench.of(id).began->ns == 2'000'000'000);
  CHECK_FALSE(bench.desk.next_deadline());
}

TEST_CASE("the next one begins when the program before it is gone, in the order in which they were asked for") {
  Bench bench;
  const std::string first = bench.add("{1}");
  const std::string second = bench.add("{2}");
  const std::string third = bench.add("{3}");
  CHECK(bench.started.size() == 1);
  CHECK(bench.of(second).state == SimulationState::queued);
  CHECK_FALSE(bench.of(second).began);
  bench.gone(Bytes("{}"));
  CHECK(bench.started == std::vector<std::string>{"{1}", "{2}"});
  CHECK(bench.of(first).state == SimulationState::done);
  CHECK(bench.of(second).state == SimulationState::running);
  CHECK(bench.of(third).state == SimulationState::queued);
  std::vector<std::string> ids;
  for (const Simulation& one : bench.desk.all()) ids.push_back(one.id);
  CHECK(ids == std::vector<std::string>{third, second, first});
}

TEST_CASE("four wait, a fifth is refused with a cure, until one is over") {
  Bench bench;
  for (int i = 0; i < 5; ++i) bench.add("{}");
  const auto refused = bench.desk.add(job_of("{}"), "olga", bench.now);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::queue_full);
  CHECK(refused.error().what == "4 simulations wait already");
  CHECK_FALSE(refused.error().hint.empty());
  CHECK(bench.desk.all().size() == 5);
  bench.gone(Bytes("{}"));
  bench.add("{}");
}

TEST_CASE("four wait while the program of a cancelled one is not gone yet") {
  Bench bench;
  const std::string first = bench.add("{}");
  REQUIRE(bench.remove(first).ok());
  for (int i = 0; i < 4; ++i) bench.add("{}");
  CHECK_FALSE(bench.desk.add(job_of("{}"), "olga", bench.now).ok());
  CHECK(bench.started.size() == 1);
}

TEST_CASE("a cancelled one that waits never begins") {
  Bench bench;
  bench.add("{1}");
  const std::string second = bench.add("{2}");
  const auto removed = bench.remove(second);
  REQUIRE(removed.ok());
  REQUIRE(*removed != nullptr);
  CHECK((*removed)->state == SimulationState::cancelled);
  CHECK(bench.ended == 0);
  bench.gone(Bytes("{}"));
  CHECK(bench.started.size() == 1);
}

TEST_CASE("the program of a cancelled one is ended, and what it still says counts for nobody") {
  Bench bench;
  const std::string first = bench.add("{1}");
  const std::string second = bench.add("{2}");
  REQUIRE(bench.remove(first).ok());
  CHECK(bench.ended == 1);
  CHECK(bench.started.size() == 1);
  bench.desk.on_progress({5, 1});
  bench.gone(Bytes("{late}"));
  CHECK(bench.of(first).state == SimulationState::cancelled);
  CHECK(bench.of(first).answer.empty());
  CHECK(bench.of(first).progress == SimulationProgress{});
  CHECK(bench.of(second).state == SimulationState::running);
  CHECK(bench.of(second).progress == SimulationProgress{});
}

TEST_CASE("without an answer it has failed, with what its program said") {
  Bench bench;
  const std::string id = bench.add("{}");
  bench.gone(kKilled);
  CHECK(bench.of(id).state == SimulationState::failed);
  CHECK(bench.of(id).failure->what == "it was killed");
  CHECK(bench.of(id).answer.empty());
}

TEST_CASE("after a minute its program is ended") {
  Bench bench;
  const std::string id = bench.add("{}");
  CHECK(bench.desk.next_deadline() == bench.now.mono + kLongestSimulation);
  bench.pass(kLongestSimulation - std::chrono::milliseconds(1));
  CHECK(bench.of(id).state == SimulationState::running);
  bench.pass(std::chrono::milliseconds(1));
  CHECK(bench.of(id).state == SimulationState::failed);
  CHECK(bench.of(id).failure->code == Errc::timeout);
  CHECK_FALSE(bench.of(id).failure->hint.empty());
  CHECK(bench.ended == 1);
  CHECK_FALSE(bench.desk.next_deadline());
  bench.gone(kKilled);
  CHECK(bench.of(id).failure->code == Errc::timeout);
  CHECK(bench.ended == 1);
}

TEST_CASE("an answer that is too large is none") {
  Bench bench;
  const std::string id = bench.add("{}");
  bench.desk.on_too_large(bench.now);
  bench.obey();
  CHECK(bench.ended == 1);
  CHECK(bench.of(id).failure->code == Errc::too_large);
  bench.desk.on_too_large(bench.now);
  bench.gone(Bytes("{}"));
  CHECK(bench.ended == 1);
  CHECK(bench.of(id).state == SimulationState::failed);
}

TEST_CASE("one that is over is forgotten when it is removed, and so is none that is not there") {
  Bench bench;
  const std::string id = bench.add("{}");
  bench.gone(Bytes("{}"));
  const auto removed = bench.remove(id);
  REQUIRE(removed.ok());
  CHECK(*removed == nullptr);
  CHECK(bench.desk.find(id) == nullptr);
  CHECK(bench.ended == 0);
  const auto again = bench.remove(id);
  REQUIRE_FALSE(again.ok());
  CHECK(again.error().code == Errc::missing);
}

TEST_CASE("of those that are over the newest twenty are kept; who waits is none of them") {
  Bench bench;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < kMaxEndedSimulations + 3; ++i) {
    ids.push_back(bench.add("{}"));
    bench.gone(Bytes("{}"));
  }
  bench.add("{run}");
  bench.add("{wait}");
  CHECK(bench.desk.all().size() == kMaxEndedSimulations + 2);
  for (int i = 0; i < 3; ++i) CHECK(bench.desk.find(ids[static_cast<std::size_t>(i)]) == nullptr);
  CHECK(bench.desk.find(ids[3]) != nullptr);
}

TEST_CASE("an old one that is cancelled when twenty newer ones are over is gone at once") {
  Bench bench;
  bench.add("{run}");
  const std::string oldest = bench.add("{wait}");
  for (std::size_t i = 0; i < kMaxEndedSimulations; ++i) REQUIRE(bench.remove(bench.add("{}")).ok());
  const auto removed = bench.remove(oldest);
  REQUIRE(removed.ok());
  CHECK(*removed == nullptr);
  CHECK(bench.desk.all().size() == kMaxEndedSimulations + 1);
}
