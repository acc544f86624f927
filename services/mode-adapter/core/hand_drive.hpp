// Driving by hand: a person's speeds go to the robot as long as they come, and the robot stands when they cease.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "services/mode-adapter/core/robot_control.hpp"
#include "services/mode-adapter/core/robot_faults.hpp"
#include "services/mode-adapter/core/robot_side.hpp"

namespace trb::adapter {

/// One drive at a time, of one part. "Stands": the robot is told so once, by the description's words.
///
/// event                        | nobody drives             | a drive is under way
/// -----------------------------|---------------------------|---------------------------------------------------------
/// Velocity                     | it begins: "driving"      | newer: its speeds, "driving"; else refused: conflict
/// ... of another drive         | it begins                 | control_held; with `take` this one stands and is over
/// ... of a drive that is over  | refused: conflict         | refused: conflict
/// ... `over`                   | that drive is over, too   | stands, over
/// 250 ms without a Velocity    | -                         | stands, if it was to move; the next one moves it again
/// 500 ms without a Velocity    | -                         | stands, over
/// the robot takes no speeds    | -                         | stands, over (500 ms after they were handed over)
/// a take-over; a fault of the  | -                         | stands, over
///   capability; the process ends
/// a stop                       | -                         | over: the stop has the robot stand, once it is confirmed;
///                              |                           | if the link is lost before, as there
/// the robot's link is lost     | -                         | over; it stands once the link is back
/// the robot refuses            | its words, and no drive   | stands, over
///
/// The end of a drive frees the lease. Speeds that have not left for the robot yet are replaced by newer ones.
class HandDrive {
 public:
  /// For so long speeds count: the robot, which then has to brake, is to stand 500 ms after the last ones.
  static constexpr Duration kCounts = std::chrono::milliseconds(250);
  /// For so long a drive lasts without a word.
  static constexpr Duration kLasts = std::chrono::milliseconds(500);

  /// All of them outlive it.
  HandDrive(RobotSide& robot, RobotControl& control, const RobotFaults& faults, const SkillDesk& desk)
      : robot_(robot), control_(control), faults_(faults), desk_(desk) {}

  void on_velocity(const Inbound& message, const Velocity& velocity, Now now, Outbox& out);
  /// A user's command, before it is carried out. With `take` it ends the drive; else this is why its sender, who
  /// drives, may not send it.
  std::optional<Error> on_command(const Inbound& message, Now now, Outbox& out);
  /// The robot is being stopped.
  void on_stop(const std::string& reason, Outbox& out);
  /// Stands, over.
  void give_way(const std::string& reason, Now now, Outbox& out);
  /// A fault may have taken the capability away.
  void look_at_faults(Now now, Outbox& out);

  [[nodiscard]] bool driving() const { return current_.has_value(); }
  /// The robot was ordered to stand, or has to be, and has not taken that order yet.
  [[nodiscard]] bool has_to_stand() const { return standing_.has_value(); }
  [[nodiscard]] bool owns(Token token) const;

  // events of the modes
  void on_under_way(Token token, Now now, Outbox& out);
  void on_refused(const Refused& refused, Now now, Outbox& out);
  /// The robot has confirmed a stop, or a release, before which it had the stop.
  void on_stopped(const Driver& mode);
  void on_link_up(Driver& mode, Now now, Outbox& out);
  void on_link_down(const Driver& mode, const std::string& reason, Outbox& out);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Current {
    std::string source;
    std::uint64_t number = 0;
    std::string by;
    const Drive* drive = nullptr;
    Driver* mode = nullptr;
    std::uint64_t sequence = 0;
    MonotonicTime last;         ///< when the last Velocity was accepted
    bool moves = false;         ///< its speeds are not all 0, and still count
    Token leaving = 0;          ///< handed over, and not known to have left; 0: none
    MonotonicTime leaving_at;   ///< when it was handed over
    std::optional<Bytes> next;  ///< the newest speeds, if they wait for that
  };
  struct Standing {  ///< the order to stand
    const Drive* drive = nullptr;
    Driver* mode = nullptr;
    Token token = 0;  ///< 0: it could not be given, and is owed to the robot
  };
  struct Over {
    std::string source;
    std::uint64_t number = 0;
    std::string reason;
  };

  [[nodiscard]] bool is_current(const Inbound& message, const Velocity& velocity) const;
  [[nodiscard]] const Over* find_over(const std::string& source, std::uint64_t number) const;
  void let_go(const Inbound& message, const Velocity& velocity, Now now, Outbox& out);
  Status drive(const Inbound& message, const Velocity& velocity, Now now, Outbox& out);
  [[nodiscard]] Status check_speeds(const Velocity& velocity) const;
  [[nodiscard]] Status check_control(const Inbound& message, const Velocity& velocity, Now now) const;
  [[nodiscard]] Status check_robot(const Drive& drive);
  Status hand_over(Current& current, const Bytes& data, Now now, Outbox& out);
  void stand(const Drive& drive, Driver& mode, Now now, Outbox& out);
  /// What has not left must not leave after the order to stand.
  void stand_of(const Current& drive, Now now, Outbox& out);
  void end(const std::string& reason, Outbox& out);
  void remember_over(std::string source, std::uint64_t number, std::string reason);

  RobotSide& robot_;
  RobotControl& control_;
  const RobotFaults& faults_;
  const SkillDesk& desk_;
  std::optional<Current> current_;
  std::optional<Standing> standing_;
  std::deque<Over> over_;
};

}  // namespace trb::adapter
