// What the gateway knows of the fleet. Messages become rows; a table in README.md shows what late, repeated and
// foreign messages do.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/actor/inbound.hpp"
#include "common/actor/route_pages.hpp"
#include "services/cloud-gateway/core/live/alert_rows.hpp"
#include "services/cloud-gateway/core/live/fleet_questions.hpp"
#include "services/cloud-gateway/core/live/node_rows.hpp"
#include "services/cloud-gateway/core/live/reading_rows.hpp"
#include "services/cloud-gateway/core/live/robot_questions.hpp"
#include "services/cloud-gateway/core/live/run_rows.hpp"
#include "services/cloud-gateway/core/live/sensor_streams.hpp"

namespace trb::gateway {

class FleetView {
 public:
  static constexpr Duration kRoutesSilence = std::chrono::seconds(10);
  static constexpr Duration kRunsSilence = std::chrono::seconds(15);
  static constexpr Duration kAlertsSilence = std::chrono::seconds(10);

  /// Both must outlive it.
  FleetView(RowBook& book, AlarmDesk& alarms);

  /// The messages that the service subscribes to.
  static std::vector<std::string> subscriptions();

  void on_welcome(const std::string& node, Now now);
  void on(const Inbound& message, Now now, Outbox& out);
  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

  /// Whose first table has not come, or who has been silent since: what it has now may have no row, and its rows may
  /// be old.
  [[nodiscard]] RowSources silent() const;
  /// The router's table is here, whole: a node or robot without a row is one that the fleet does not have.
  [[nodiscard]] bool knows_fleet() const { return routes_heard_.heard.has_value(); }

  /// Clients watch these runs in full: each is requested now and at each of its changes.
  void watch_runs(std::set<std::string> runs, Now now);
  /// Clients watch these sensors: their values are requested, and those of others are not taken.
  void watch_sensors(const std::set<SensorId>& sensors, Now now);
  /// Clients look at the fleet, or at nobody: robots are asked for their place and charge.
  void watch_robots(bool wanted, Now now) { robots_.want(wanted, now); }
  /// Shows what the desk of alarms says now.
  void show_alarms(Now now) { alerts_.refresh(now); }

 private:
  /// A service of this node, and when its last message came.
  struct Source {
    RowSource name{};
    Duration limit{};
    std::optional<MonotonicTime> heard;  ///< nullopt: its rows are not shown as live
    bool is_over(Now now) const { return heard && now.mono - *heard >= limit; }
  };
  bool on_robot(const Inbound& message, Now now, Outbox& out);
  void on_reading(const std::string& node, const SensorReading& reading, Now now, Outbox& out);
  void on_answer(const std::string& robot, const Opaque& answer, Now now, Outbox& out);
  bool on_own_node(const Inbound& message, Now now, Outbox& out);
  void on_page(const RouteTable& page, Now now, Outbox& out);
  void on_runs(const RunTable& table, Now now, Outbox& out);
  void on_run(const RunChanged& changed, Now now, Outbox& out);
  [[nodiscard]] std::uint64_t version_of(const std::string& run) const;
  void look_for_lost(Now now);
  void watch_silence(Now now);

  RowBook& book_;
  std::string node_;
  NodeRows nodes_{book_};
  RunRows runs_{book_};
  AlertRows alerts_;
  ReadingRows readings_{book_};
  SensorStreams streams_{book_};
  FleetQuestions questions_;
  RobotQuestions robots_{book_};
  RoutePages pages_;
  std::set<std::string> watched_runs_;
  Source routes_heard_{RowSource::router, kRoutesSilence, {}};
  Source runs_heard_{RowSource::scheduler, kRunsSilence, {}};
  Source alerts_heard_{RowSource::resilience, kAlertsSilence, {}};
};

}  // namespace trb::gateway
