#include "services/cloud-gateway/core/simulations/simulation_desk.hpp"

#include <algorithm>

#include "common/base/hex.hpp"
#include "services/cloud-gateway/core/simulations/scenario_job.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kIdBytes = 8;

bool is_over(const Simulation& one) {
  return one.state >= SimulationState::done;
}

}  // namespace

Result<const Simulation*> SimulationDesk::add(SimulationJob job, std::string by, Now now) {
  const bool must_wait = has_program_ || waiting() > 0;
  if (must_wait && waiting() >= kMaxWaitingSimulations) {
    return fail(Errc::queue_full, std::to_string(kMaxWaitingSimulations) + " simulations wait already",
                "wait until one is over, or cancel one");
  }
  Simulation one;
  one.id = to_hex(random_(kIdBytes));
  one.job = std::move(job);
  one.by = std::move(by);
  one.asked = now.utc;
  simulations_.push_front(std::move(one));
  return &simulations_.front();
}

Result<const Simulation*> SimulationDesk::remove(const std::string& id, Now now) {
  const auto at = std::ranges::find(simulations_, id, &Simulation::id);
  if (at == simulations_.end()) return fail(Errc::missing, "there is no such simulation", "GET /api/v1/simulations");
  if (is_over(*at)) {
    simulations_.erase(at);
    return nullptr;
  }
  if (at->state == SimulationState::running) must_end_program_ = true;
  end(*at, SimulationState::cancelled, now);
  return find(id);
}

void SimulationDesk::on_progress(const SimulationProgress& progress) {
  if (Simulation* one = running()) one->progress = progress;
}

void SimulationDesk::on_too_large(Now now) {
  Simulation* one = running();
  if (one == nullptr) return;
  stop(*one,
       fail(Errc::too_large, "its answer has more than " + std::to_string(kMaxSimulationAnswer) + " bytes",
            "use fewer tasks"),
       now);
}

void SimulationDesk::on_gone(Result<Bytes> answer, Now now) {
  has_program_ = false;
  must_end_program_ = false;
  Simulation* one = running();
  if (one == nullptr) return;  // it was cancelled, or has failed already
  if (answer) {
    one->answer = one->job.scenarios.empty() ? std::move(*answer) : with_waits(std::move(*answer), one->job.scenarios);
  } else {
    one->failure = answer.error();
  }
  end(*one, answer ? SimulationState::done : SimulationState::failed, now);
}

void SimulationDesk::tick(Now now) {
  Simulation* one = running();
  if (one == nullptr || !deadline_ || now.mono < *deadline_) return;
  const auto most = std::chrono::duration_cast<std::chrono::minutes>(kLongestSimulation).count();
  stop(*one,
       fail(Errc::timeout, "it was not over after " + std::to_string(most) + " min: the cloud's computer is too busy",
            "try again later, or on another computer: trb simulate takes as long as it needs"),
       now);
}

std::optional<SimulationOrder> SimulationDesk::take_order(Now now) {
  if (std::exchange(must_end_program_, false)) return SimulationOrder{SimulationOrder::Kind::end, ""};
  if (has_program_) return std::nullopt;
  const auto next = std::find_if(simulations_.rbegin(), simulations_.rend(),
                                 [](const Simulation& one) { return one.state == SimulationState::queued; });
  if (next == simulations_.rend()) return std::nullopt;
  next->state = SimulationState::running;
  next->began = now.utc;
  deadline_ = now.mono + kLongestSimulation;
  has_program_ = true;
  return SimulationOrder{SimulationOrder::Kind::start, next->job.input};
}

const Simulation* SimulationDesk::find(const std::string& id) const {
  const auto at = std::ranges::find(simulations_, id, &Simulation::id);
  return at == simulations_.end() ? nullptr : &*at;
}

Simulation* SimulationDesk::running() {
  const auto at = std::ranges::find(simulations_, SimulationState::running, &Simulation::state);
  return at == simulations_.end() ? nullptr : &*at;
}

/// The newest 20 that are over are kept.
void SimulationDesk::end(Simulation& one, SimulationState state, Now now) {
  if (one.state == SimulationState::running) deadline_.reset();
  one.state = state;
  one.ended = now.utc;
  forget_old();
}

void SimulationDesk::stop(Simulation& one, Error why, Now now) {
  must_end_program_ = true;
  one.failure = std::move(why);
  end(one, SimulationState::failed, now);
}

void SimulationDesk::forget_old() {
  const auto ended = static_cast<std::size_t>(std::ranges::count_if(simulations_, is_over));
  if (ended <= kMaxEndedSimulations) return;
  const auto oldest = std::find_if(simulations_.rbegin(), simulations_.rend(), is_over);
  simulations_.erase(std::next(oldest).base());
}

std::size_t SimulationDesk::waiting() const {
  return static_cast<std::size_t>(std::ranges::count(simulations_, SimulationState::queued, &Simulation::state));
}

}  // namespace trb::gateway
