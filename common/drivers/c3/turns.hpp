// The stop or release that was sent to a KUKA, until it has confirmed it.
#pragma once

#include "common/drivers/c3/job.hpp"
#include "common/drivers/c3/link.hpp"
#include "common/drivers/c3/poll_times.hpp"

namespace trb::drivers {

/// begin      | the robot has taken every write and says so | then
/// -----------|---------------------------------------------|----------------------------------
/// stop       | its stopped variable is TRUE                | Stopped; nothing goes on
/// release    | it is FALSE                                 | Released; commands go on
/// end_motion | TRUE, then FALSE after a release of its own | Halted at TRUE; commands go on at FALSE
///
/// A refused write is a fault until a stop, or a release, is confirmed; the release of a robot that was in no stop is
/// none. That one and end_motion are over then, and commands go on; the others stay open.
///
/// Without a stopped variable the answers to the writes count, without words for it nothing is awaited at all; Stopped
/// says then that the robot was merely told.
class C3Turns {
 public:
  struct Words {
    std::vector<C3Step> stop, release;
    bool told_by_robot = false;  ///< there is a stopped variable
  };
  C3Turns(C3Link& link, C3PollTimes& polls, Words words) : link_(link), polls_(polls), words_(std::move(words)) {}

  /// Returns the ticket of the stop or release. An open turn gives way to it; a release joins one that the robot has
  /// not come to.
  Token stop(Now now, const DriverOut& out);
  Token release(Now now, const DriverOut& out);
  /// Ends the motion of that command, without a fence. Halted{.., false}: the robot refuses it, or another turn has
  /// taken its place.
  void end_motion(Token token, Now now, const DriverOut& out);
  /// A person's release is under way: end_motion waits for it.
  [[nodiscard]] bool releases() const { return open_ && !open_->own && !open_->stop && !open_->refused; }
  /// The robot has not confirmed yet that the motion has ended; or it is to end behind a release.
  [[nodiscard]] bool ends_motion() const { return open_ && (halts() || open_->then_halts); }

  [[nodiscard]] bool open() const { return open_.has_value(); }
  [[nodiscard]] bool may_be_stopped() const { return may_be_stopped_; }
  /// In the stop of an end_motion: no release behind it is confirmed yet.
  [[nodiscard]] bool may_stand() const { return may_stand_; }
  /// The connection is lost: there will be no confirmation.
  void drop() { open_.reset(); }

  // Both return true if commands go on now. The answer to a write of a stop or release.
  bool on_written(const C3Link::Answer& answer, Now now, const DriverOut& out);
  /// The stopped variable was read.
  bool on_stopped(bool stopped, Now now, const DriverOut& out);

 private:
  struct Turn {
    bool stop = false;
    bool own = false;  ///< only to end a motion
    Token ticket = 0;
    std::size_t unanswered = 0;         ///< of its writes
    bool refused = false;               ///< it will not be confirmed any more
    Token halts = 0;                    ///< own: the command that is to end
    std::optional<Token> then_halts{};  ///< of a release: the command that is to end behind it
    std::optional<Token> joined{};      ///< of a release: the ticket of the last one that joined it
  };
  [[nodiscard]] bool halts() const { return open_ && open_->own && open_->stop; }
  void give_up_halt(const std::string& why, const DriverOut& out);
  Token begin(bool stop, bool own, Token halts, Now now, const DriverOut& out);
  bool on_refused(const Error& why, const DriverOut& out);
  bool confirm(bool by_robot, Now now, const DriverOut& out);

  C3Link& link_;
  C3PollTimes& polls_;
  Words words_;
  bool may_be_stopped_ = false;
  bool may_stand_ = false;
  Token last_ticket_ = 0;
  std::optional<Turn> open_;
};

}  // namespace trb::drivers
