// A person with `trb` at a node: has a run's start signed, and submits it; the next one's when that one is answered.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>

#include "common/actor/core.hpp"

namespace trb::world {

class Person final : public Core {
 public:
  void submit(RunStart start, Outbox& out) {
    waiting_.push_back(std::move(start));
    if (waiting_.size() == 1) sign(out);
  }
  [[nodiscard]] bool accepted(const std::string& run) const { return accepted_.contains(run); }
  /// Why the run was refused; empty: it was not.
  [[nodiscard]] std::string refusal(const std::string& run) const {
    const auto at = refusals_.find(run);
    return at == refusals_.end() ? "" : at->second;
  }

  void on_welcome(const NodeIdentity& node, Now, Outbox&) override { node_ = node.id; }
  void on(const Inbound& message, Now, Outbox& out) override {
    if (const auto* record = get_if<SignedRecord>(&message.body)) {
      out.command(node_, RunSubmit{*record}, 0);
    } else if (holds_alternative<RunAccepted>(message.body)) {
      if (!waiting_.empty()) accepted_.insert(waiting_.front().run);
      next(out);
    } else if (const auto* nack = get_if<Nack>(&message.body)) {
      if (!waiting_.empty()) refusals_[waiting_.front().run] = nack->code + ": " + nack->what;
      next(out);
    }
  }
  void tick(Now, Outbox&) override {}
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return std::nullopt; }

 private:
  void sign(Outbox& out) { out.request(node_, SignRequest{std::string(kSignedRunStart), {encode(waiting_.front())}}); }
  void next(Outbox& out) {
    if (!waiting_.empty()) waiting_.pop_front();
    if (!waiting_.empty()) sign(out);
  }

  std::string node_;
  std::deque<RunStart> waiting_;  ///< the first one is at the scheduler, or being signed
  std::set<std::string> accepted_;
  std::map<std::string, std::string> refusals_;
};

}  // namespace trb::world
