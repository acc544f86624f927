// A person with `trb` at a node: has a run's start signed, and submits it.
#pragma once

#include <string>

#include "common/actor/core.hpp"

namespace trb::world {

class Person final : public Core {
 public:
  void submit(const RunStart& start, Outbox& out) {
    out.request(node_, SignRequest{std::string(kSignedRunStart), {encode(start)}});
  }
  [[nodiscard]] bool accepted() const { return accepted_; }
  /// Why the run was refused; empty: it was not.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

  void on_welcome(const NodeIdentity& node, Now, Outbox&) override { node_ = node.id; }
  void on(const Inbound& message, Now, Outbox& out) override {
    if (const auto* record = get_if<SignedRecord>(&message.body)) {
      out.command(node_, RunSubmit{*record}, 0);
    } else if (holds_alternative<RunAccepted>(message.body)) {
      accepted_ = true;
    } else if (const auto* nack = get_if<Nack>(&message.body)) {
      refusal_ = nack->code + ": " + nack->what;
    }
  }
  void tick(Now, Outbox&) override {}
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return std::nullopt; }

 private:
  std::string node_;
  bool accepted_ = false;
  std::string refusal_;
};

}  // namespace trb::world
