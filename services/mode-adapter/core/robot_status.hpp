// What the node and the fleet are told of the robot: at the welcome and at each change.
#pragma once

#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

class RobotStatus {
 public:
  explicit RobotStatus(const Settings& settings);

  void on_up();
  void on_down(const std::string& reason);
  /// Why a first contact does not come about.
  void on_no_contact(const std::string& reason);

  [[nodiscard]] AdapterState state(bool fenced, bool busy) const;
  /// Everything, as to somebody who knows nothing yet.
  void welcome(bool fenced, bool busy, Outbox& out);
  /// What has changed since it was last told.
  void publish(bool fenced, bool busy, Outbox& out);

 private:
  enum class Connection : std::uint8_t { offline, online, broken };
  struct Told {
    Connection connection = Connection::offline;
    bool fenced = false;
    bool busy = false;
    bool operator==(const Told&) const = default;
  };

  void tell_profile(bool fenced, Outbox& out);
  [[nodiscard]] std::string connection_name() const;

  const Settings& settings_;
  NodeProfile profile_;  ///< what does not change
  Connection connection_ = Connection::offline;
  std::string detail_ = "no contact yet";
  bool detail_changed_ = false;
  bool had_contact_ = false;
  bool welcomed_ = false;
  Told told_;
};

}  // namespace trb::adapter
