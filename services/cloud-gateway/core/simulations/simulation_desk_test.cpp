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
struct Fixture {
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
  Fixture fixture;
  const std::string id = fixture.add("{1}");
  CHECK(fixture.started == std::vector<std::string>{"{1}"});
  CHECK(fixture.of(id).state == SimulationState::running);
  CHECK(fixture.of(id).by == "olga");
  CHECK(fixture.of(id).began == fixture.now.utc);
  fixture.desk.on_progress({12.5, 3});
  CHECK(fixture.of(id).progress == SimulationProgress{12.5, 3});
  fixture.pass(std::chrono::seconds(2));
  fixture.gone(Bytes("{answer}"));
  CHECK(fixture.of(id).state == SimulationState::done);
  CHECK(fixture.of(id).answer == "{answer}");
  CHECK(fixture.of(id).ended->ns - fixture.of(id).began->ns == 2'000'000'000);
  CHECK_FALSE(fixture.desk.next_deadline());
}

TEST_CASE("the next one begins when the program before it is gone, in the order in which they were asked for") {
  Fixture fixture;
  const std::string first = fixture.add("{1}");
  const std::string second = fixture.add("{2}");
  const std::string third = fixture.add("{3}");
  CHECK(fixture.started.size() == 1);
  CHECK(fixture.of(second).state == SimulationState::queued);
  CHECK_FALSE(fixture.of(second).began);
  fixture.gone(Bytes("{}"));
  CHECK(fixture.started == std::vector<std::string>{"{1}", "{2}"});
  CHECK(fixture.of(first).state == SimulationState::done);
  CHECK(fixture.of(second).state == SimulationState::running);
  CHECK(fixture.of(third).state == SimulationState::queued);
  std::vector<std::string> ids;
  for (const Simulation& one : fixture.desk.all()) ids.push_back(one.id);
  CHECK(ids == std::vector<std::string>{third, second, first});
}

TEST_CASE("four wait, a fifth is refused with a cure, until one is over") {
  Fixture fixture;
  for (int i = 0; i < 5; ++i) fixture.add("{}");
  const auto refused = fixture.desk.add(job_of("{}"), "olga", fixture.now);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::queue_full);
  CHECK(refused.error().what == "4 simulations wait already");
  CHECK_FALSE(refused.error().hint.empty());
  CHECK(fixture.desk.all().size() == 5);
  fixture.gone(Bytes("{}"));
  fixture.add("{}");
}

TEST_CASE("four wait while the program of a cancelled one is not gone yet") {
  Fixture fixture;
  const std::string first = fixture.add("{}");
  REQUIRE(fixture.remove(first).ok());
  for (int i = 0; i < 4; ++i) fixture.add("{}");
  CHECK_FALSE(fixture.desk.add(job_of("{}"), "olga", fixture.now).ok());
  CHECK(fixture.started.size() == 1);
}

TEST_CASE("a cancelled one that waits never begins") {
  Fixture fixture;
  fixture.add("{1}");
  const std::string second = fixture.add("{2}");
  const auto removed = fixture.remove(second);
  REQUIRE(removed.ok());
  REQUIRE(*removed != nullptr);
  CHECK((*removed)->state == SimulationState::cancelled);
  CHECK(fixture.ended == 0);
  fixture.gone(Bytes("{}"));
  CHECK(fixture.started.size() == 1);
}

TEST_CASE("the program of a cancelled one is ended, and what it still says counts for nobody") {
  Fixture fixture;
  const std::string first = fixture.add("{1}");
  const std::string second = fixture.add("{2}");
  REQUIRE(fixture.remove(first).ok());
  CHECK(fixture.ended == 1);
  CHECK(fixture.started.size() == 1);
  fixture.desk.on_progress({5, 1});
  fixture.gone(Bytes("{late}"));
  CHECK(fixture.of(first).state == SimulationState::cancelled);
  CHECK(fixture.of(first).answer.empty());
  CHECK(fixture.of(first).progress == SimulationProgress{});
  CHECK(fixture.of(second).state == SimulationState::running);
  CHECK(fixture.of(second).progress == SimulationProgress{});
}

TEST_CASE("without an answer it has failed, with what its program said") {
  Fixture fixture;
  const std::string id = fixture.add("{}");
  fixture.gone(kKilled);
  CHECK(fixture.of(id).state == SimulationState::failed);
  CHECK(fixture.of(id).failure->what == "it was killed");
  CHECK(fixture.of(id).answer.empty());
}

TEST_CASE("after ten minutes its program is ended") {
  Fixture fixture;
  const std::string id = fixture.add("{}");
  CHECK(fixture.desk.next_deadline() == fixture.now.mono + kLongestSimulation);
  fixture.pass(kLongestSimulation - std::chrono::milliseconds(1));
  CHECK(fixture.of(id).state == SimulationState::running);
  fixture.pass(std::chrono::milliseconds(1));
  CHECK(fixture.of(id).state == SimulationState::failed);
  CHECK(fixture.of(id).failure->code == Errc::timeout);
  CHECK_FALSE(fixture.of(id).failure->hint.empty());
  CHECK(fixture.ended == 1);
  CHECK_FALSE(fixture.desk.next_deadline());
  fixture.gone(kKilled);
  CHECK(fixture.of(id).failure->code == Errc::timeout);
  CHECK(fixture.ended == 1);
}

TEST_CASE("an answer that is too large is none") {
  Fixture fixture;
  const std::string id = fixture.add("{}");
  fixture.desk.on_too_large(fixture.now);
  fixture.obey();
  CHECK(fixture.ended == 1);
  CHECK(fixture.of(id).failure->code == Errc::too_large);
  fixture.desk.on_too_large(fixture.now);
  fixture.gone(Bytes("{}"));
  CHECK(fixture.ended == 1);
  CHECK(fixture.of(id).state == SimulationState::failed);
}

TEST_CASE("one that is over is forgotten when it is removed, and so is none that is not there") {
  Fixture fixture;
  const std::string id = fixture.add("{}");
  fixture.gone(Bytes("{}"));
  const auto removed = fixture.remove(id);
  REQUIRE(removed.ok());
  CHECK(*removed == nullptr);
  CHECK(fixture.desk.find(id) == nullptr);
  CHECK(fixture.ended == 0);
  const auto again = fixture.remove(id);
  REQUIRE_FALSE(again.ok());
  CHECK(again.error().code == Errc::missing);
}

TEST_CASE("of those that are over the newest twenty are kept; who waits is none of them") {
  Fixture fixture;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < kMaxEndedSimulations + 3; ++i) {
    ids.push_back(fixture.add("{}"));
    fixture.gone(Bytes("{}"));
  }
  fixture.add("{run}");
  fixture.add("{wait}");
  CHECK(fixture.desk.all().size() == kMaxEndedSimulations + 2);
  for (int i = 0; i < 3; ++i) CHECK(fixture.desk.find(ids[static_cast<std::size_t>(i)]) == nullptr);
  CHECK(fixture.desk.find(ids[3]) != nullptr);
}

TEST_CASE("an old one that is cancelled when twenty newer ones are over is gone at once") {
  Fixture fixture;
  fixture.add("{run}");
  const std::string oldest = fixture.add("{wait}");
  for (std::size_t i = 0; i < kMaxEndedSimulations; ++i) REQUIRE(fixture.remove(fixture.add("{}")).ok());
  const auto removed = fixture.remove(oldest);
  REQUIRE(removed.ok());
  CHECK(*removed == nullptr);
  CHECK(fixture.desk.all().size() == kMaxEndedSimulations + 1);
}
