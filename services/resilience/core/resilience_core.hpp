// trb-resilience: watches the fleet and the own scheduler's runs, raises alerts, ranks robots that could take over, and
// turns a verdict into a signed decision. This class hands each message to its part, and ends each step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/actor/takes.hpp"
#include "services/resilience/core/core_parts.hpp"
#include "services/resilience/core/history_reader.hpp"

namespace trb::resilience {

// Its records: Alert (new, or replacing the one of that id), RunDecision (signed, not yet sent), DecisionOver.
class ResilienceCore final : public Core {
 public:
  /// `history`: outlives the core; nullptr: there is none.
  explicit ResilienceCore(CoreSettings settings, HistoryReader* history = nullptr)
      : parts_(std::move(settings)), history_(history) {}

  using Taken = Takes<AlertListRequest, AlertDecide, AlertRankRequest, HistoryListRequest>;
  /// Information of which the service wants a copy.
  static std::vector<std::string> subscriptions();

  void restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  /// Whoever runs the core writes its changes.
  Fleet& fleet() { return parts_.situation.fleet(); }

 private:
  void on_request(const Inbound& message, Now now, Outbox& out);
  void handle(const AlertListRequest& body, const Inbound& from, Now now, Outbox& out);
  void handle(const AlertDecide& body, const Inbound& from, Now now, Outbox& out);
  void handle(const AlertRankRequest& body, const Inbound& from, Now now, Outbox& out);
  void handle(const HistoryListRequest& body, const Inbound& from, Now now, Outbox& out) const;

  void on_information(const Inbound& message, Now now, Outbox& out);
  bool on_fleet(const Inbound& message, Now now, Outbox& out);
  bool on_own_node(const Inbound& message, Now now, Outbox& out);
  void on_answer(const Inbound& message, Now now, Outbox& out);
  void receive(const RouteTable& page, Now now, Outbox& out);
  void receive(const Ack& ack, const std::string& from, Now now);
  void receive(const Nack& nack, const std::string& from, Now now, Outbox& out);

  AlertTable make_table(bool all, Now now);
  void look(Now now, Outbox& out);
  void look_at_alerts(Now now, Outbox& out);
  void settle(Now now, Outbox& out);
  void schedule_look(Now now);
  void want_routes(Now now);

  /// The last answer to who asked for the alerts; gone once anything else has come, or was looked at.
  struct Told {
    AlertTable table;
    bool all = false;
    MonotonicTime at;
  };

  CoreParts parts_;
  std::optional<Told> told_;
  HistoryReader* history_;
  bool welcomed_ = false;
  std::optional<MonotonicTime> looked_at_;
  std::optional<MonotonicTime> look_at_;
};

}  // namespace trb::resilience
