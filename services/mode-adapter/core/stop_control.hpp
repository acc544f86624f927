// Stop, release and the fence between them.
#pragma once

#include <vector>

#include "services/mode-adapter/core/robot_side.hpp"

namespace trb::adapter {

/// A stop goes to the robot first, then to the disk, then it is answered; a release goes to the disk first.
class StopControl {
 public:
  StopControl(RobotSide& robot, PersistFence persist);

  [[nodiscard]] bool fenced() const { return fenced_; }
  void on_stop(const Inbound& message, Now now, Outbox& out);
  void on_release(const Inbound& message, Now now, Outbox& out);

  void on_stopped(const Driver* mode, const Stopped& stopped, Outbox& out);
  /// Who waits for that stop is told at once, not when its time is over.
  void on_not_stopped(const Driver* mode, const NotStopped& refused, Outbox& out);
  void on_released(const Driver* mode, const Released& released, Outbox& out);
  /// A robot that reconnects gets again what it may have missed.
  void on_link_up(Driver& mode, Now now, Outbox& out);

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Told {
    const Driver* mode = nullptr;
    Token ticket = 0;
    bool confirmed = false;
  };
  struct Pending {
    Inbound message;
    bool release = false;
    MonotonicTime deadline;
    std::vector<Told> told;
    std::optional<Error> refused;  ///< the robot cannot be reached, or refuses
    bool by_robot = true;
    bool stood = false;  ///< Stopped::stood
  };

  void send_stop(Pending& pending, Driver& mode, Now now, Outbox& out);
  /// What waits for its confirmation, and never gets it now.
  void refuse_pending(bool release, const std::string& why, Outbox& out);
  void confirm(const Driver* mode, bool release, const Stopped& how, Outbox& out);
  void save_fence(Now now, Outbox& out);
  void answer_ready(Outbox& out);
  [[nodiscard]] bool try_answer(const Pending& pending, Outbox& out) const;
  [[nodiscard]] static std::string remark(const Pending& pending);
  void answer_late(Now now, Outbox& out);
  [[nodiscard]] Error late(const Pending& pending) const;

  RobotSide& robot_;
  PersistFence persist_;
  bool fenced_;
  std::optional<MonotonicTime> save_at_;  ///< set while the fence is not on disk
  std::optional<Error> save_error_;
  std::vector<Pending> pending_;
};

}  // namespace trb::adapter
