#include "services/simulator/world/core_process.hpp"

namespace trb::world {

CoreProcess::CoreProcess(ProcessSettings settings, Core& core, Events& events, const Clock& clock)
    : settings_(std::move(settings)),
      core_(core),
      events_(events),
      clock_(clock),
      timer_(events,
             [this] {
               if (!writes_) step([this](Now now, Outbox& out) { core_.tick(now, out); });
             }),
      commit_timer_(events, [this] {
        if (journal_.due()) commit({});
      }) {}

void CoreProcess::welcome(const NodeIdentity& node) {
  step([&](Now now, Outbox& out) { core_.on_welcome(node, now, out); });
}

void CoreProcess::take(const Inbound& message) {
  step([&](Now now, Outbox& out) { core_.on(message, now, out); });
}

void CoreProcess::step(const std::function<void(Now now, Outbox& out)>& call) {
  const Now now = clock_.now();
  Outbox out;
  call(now, out);
  if (settings_.inspect) settings_.inspect(out);
  if (out.journal.empty()) return send(out);
  if (journal_.add(std::move(out.journal), now.mono)) return commit(std::move(out));
  commit_timer_.set(journal_.due());
  end_step(out);
}

void CoreProcess::commit(Outbox out) {
  out.journal = journal_.take();
  if (settings_.commit == nullptr) return write(out);
  writes_ = true;
  events_.after(*settings_.commit, life_, [this, out = std::move(out)] { write(out); });
}

void CoreProcess::write(const Outbox& out) {
  if (settings_.store) settings_.store(out.journal);
  end_step(out);
}

/// Nothing of this object is used behind on_crash.
void CoreProcess::end_step(const Outbox& out) {
  CrashPoint* const crash = settings_.crash;
  const bool crashes = crash != nullptr && ++crash->commits == crash->at;
  if (!crashes || crash->after_sends) send(out);
  if (crashes) {
    const auto end = settings_.on_crash;
    return end();
  }
  writes_ = false;
  take_waiting();
}

void CoreProcess::send(const Outbox& out) {
  for (const Send& one : out.sends) settings_.send(one);
  if (settings_.after_sends) settings_.after_sends();
  timer_.set(core_.next_deadline());
}

void CoreProcess::take_waiting() {
  const std::weak_ptr<char> here = life_;
  while (!here.expired() && !writes_ && !waiting_.empty()) {
    Events::What what = std::move(waiting_.front());
    waiting_.pop_front();
    what();
  }
}

}  // namespace trb::world
