// The control lease: of all that send commands to a robot, only one at a time may.
#pragma once

#include <optional>
#include <string>

#include "common/actor/inbound.hpp"
#include "common/base/time.hpp"

namespace trb::adapter {

/// The commanding party: the runs of the robot's own scheduler, or the persons and services (and the robot) of one
/// node.
struct Holder {
  enum class Kind : std::uint8_t { person = 0, run } kind{};
  std::string name;  ///< person: the node's id, proven by the link; run: the run's id, for display only

  /// Two runs of one scheduler are one holder: their order is the scheduler's business.
  [[nodiscard]] bool same(const Holder& other) const {
    return kind == other.kind && (kind == Kind::run || name == other.name);
  }
  /// "cloud", or "run ID": 64 bytes at most.
  [[nodiscard]] std::string text() const;
};

/// event                | free        | held by the same      | held by another
/// ---------------------|-------------|-----------------------|---------------------------------------------
/// command              | held        | held, 10 s from now   | refused: control_held
/// command with `take`  | held        | held, 10 s from now   | held by the new one; what runs goes on
/// 10 s without command | -           | free, unless a command of it still runs, or a drive
/// the end of a drive   | -           | free                  | -
/// stop, release, requests, information: allowed whoever holds the lease; they do not change it
class ControlLease {
 public:
  static constexpr Duration kHold = std::chrono::seconds(10);

  /// Why a command of `by` is refused now, if it is. Error: control_held, naming the holder, since when, and a hint.
  [[nodiscard]] std::optional<Error> refusal(const Holder& by, const std::string& robot, Now now) const;
  /// A command of `by` is accepted. Returns the previous holder if the lease was taken over.
  std::optional<Holder> take(Holder by, Now now);
  /// Its holder needs it no more.
  void free(const Holder& by) {
    if (holder_ && holder_->same(by)) holder_.reset();
  }
  /// `running`: does a command of the holder still run? Frees the lease when its time is over.
  void refresh(bool running, Now now);

  [[nodiscard]] const std::optional<Holder>& holder() const { return holder_; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  std::optional<Holder> holder_;
  MonotonicTime since_;
  MonotonicTime last_;  ///< the last command, or the end of what it began
  bool running_ = false;
};

}  // namespace trb::adapter
