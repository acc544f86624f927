// The fleet's nodes, their robots and their sensors, as rows. A node's rows are shown as live as long as this node's
// router reports that its lease runs.
#pragma once

#include <map>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/robot_words.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

class NodeRows {
 public:
  static constexpr std::size_t kMaxNodes = 2000;
  static constexpr std::size_t kMaxSensors = 255;  ///< for one node
  static constexpr Duration kForget = std::chrono::seconds(30);

  explicit NodeRows(RowBook& book) : book_(book) {}

  /// The whole table of this node's router.
  void take(RouteTable table, Now now, Outbox& out);
  void take(const PeerJoined& joined, Now now, Outbox& out);
  void take(const PeerExpired& expired, Now now);
  void take(const std::string& node, const std::vector<SensorInfo>& sensors, Now now, Outbox& out);
  /// RobotState, RobotConnection or RobotFault of the robot of `node`.
  template <class Word>
  void take_report(const std::string& node, const Word& word, Now now, Outbox& out) {
    const Known* known = know(node, now, out);
    if (known == nullptr) return;
    RobotRow row = robot_of(node);
    apply(row, word, now.utc);
    if (!book_.put({RowKind::robot, node, {}}, std::move(row), known->live, now)) out.count("refused.node_budget");
  }
  /// This node's router sends nothing any more.
  void on_silence(Now now);

  [[nodiscard]] Live live_of(const std::string& node) const;

 private:
  struct Known {
    Live live = Live::live;
    std::uint64_t boot = 0;
    MonotonicTime heard;
  };
  Known* know(const std::string& node, Now now, Outbox& out);
  void take_route(Route route, Now now, Outbox& out);
  void take_profile(const std::string& node, NodeProfile profile, Now now, Outbox& out);
  void forget_lesser_faults(const std::string& node, Now now, Outbox& out);
  void remove_missing(const RouteTable& table, Now now);
  void set_live(const std::string& node, Live live, Now now);
  [[nodiscard]] RobotRow robot_of(const std::string& node) const;

  RowBook& book_;
  std::map<std::string, Known> nodes_;
};

}  // namespace trb::gateway
