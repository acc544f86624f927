// Where robots are and how much charge they have: requested from them while a client looks at the fleet, so that nobody
// has to send it all the time.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

/// Robots that drive or fly and can be reached: the place five times a second while a client here drives it, each
/// second while somebody commands it and until 3 s later, when it has come to stand, else each 15 s; the charge each
/// minute. At most kMostAtOnce requests in kStep: of a large fleet each robot is asked less often.
class RobotQuestions {
 public:
  static constexpr Duration kStep = std::chrono::milliseconds(100);
  static constexpr Duration kDriven = std::chrono::milliseconds(200);
  static constexpr Duration kCommanded = std::chrono::seconds(1);
  static constexpr Duration kComesToStand = std::chrono::seconds(3);
  static constexpr Duration kStanding = std::chrono::seconds(15);
  static constexpr Duration kCharge = std::chrono::minutes(1);
  static constexpr std::size_t kMostAtOnce = 20;

  /// The book must outlive it.
  explicit RobotQuestions(const RowBook& book) : book_(book) {}

  /// Does a client look at the fleet?
  void want(bool wanted, Now now);
  void tick(Now now, Outbox& out);
  /// True if this value was requested from the robot.
  [[nodiscard]] bool has_asked(const std::string& robot, const std::string& value) const;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return at_; }

 private:
  struct Asked {
    std::optional<MonotonicTime> position;
    std::optional<MonotonicTime> commanded;  ///< when somebody commanded it last
    std::optional<MonotonicTime> charge;
    std::string charge_name;
  };
  [[nodiscard]] Duration pause_of(const Row& robot, Asked& asked, Now now) const;
  /// Due requests to one robot; returns their number.
  std::size_t ask(const Row& robot, const NodeProfile& profile, Now now, Outbox& out);
  void forget_missing();

  const RowBook& book_;
  std::map<std::string, Asked> asked_;
  std::optional<MonotonicTime> at_;  ///< of the next step; nothing: nobody looks
  std::string last_;                 ///< the next step begins behind this robot: all have their turn
};

}  // namespace trb::gateway
