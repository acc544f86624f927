// The control lease: of all who send commands to a robot, one at a time is listened to.
#pragma once

#include <optional>
#include <string>

#include "common/actor/inbound.hpp"
#include "common/base/time.hpp"

namespace trb::adapter {

/// Who commands: the runs of the robot's own scheduler, or the persons and services (and the robot) of one node.
struct Holder {
  enum class Kind : std::uint8_t { person = 0, run } kind{};
  std::string name;  ///< person: the node's id, proven by the link; run: the run's id, for the reader alone

  /// Two runs of one scheduler are one holder: which goes first is the scheduler's business.
  [[nodiscard]] bool same(const Holder& other) const {
    return kind == other.kind && (kind == Kind::run || name == other.name);
  }
  /// "cloud", or "run ID": 64 bytes at most.
  [[nodiscard]] std::string text() const;
};

/// event                | free        | held by the same      | held by another
/// ---------------------|-------------|-----------------------|---------------------------------------------
/// command              | held        | held, 10 s from now   | refused: control_held
/// command with `take`  | held        | held, 10 s from now   | held by the new one; what runs runs on
/// 10 s without command | -           | free, unless what it has begun still runs
/// stop, release, requests, information: no matter who holds it, and it changes nothing
class ControlLease {
 public:
  static constexpr Duration kHold = std::chrono::seconds(10);

  /// Why a command of `by` is not taken now, if it is not. Error: control_held, naming the holder, since when, and the
  /// hint.
  [[nodiscard]] std::optional<Error> refusal(const Holder& by, const std::string& robot, Now now) const;
  /// A command of `by` is taken. Returns the one that it was taken over from, if there was one.
  std::optional<Holder> take(Holder by, Now now);
  /// Whether what the holder has begun still runs; frees the lease when it is over.
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
