// The messages for a KUKA's program, one at a time: written, offered, taken, carried out, over.
#pragma once

#include <deque>
#include <map>

#include "common/drivers/c3/flag.hpp"
#include "common/drivers/c3/job.hpp"
#include "common/drivers/c3/turns.hpp"

namespace trb::drivers {

/// phase (job.hpp) | event                    | then
/// ----------------|--------------------------|-----------------------------------------------------
/// writing         | a write is answered      | the next one; the last: offered, or running at once
/// writing         | the robot refuses one    | Refused, the next message
/// writing         | the chunk flag is FALSE  | the next write
/// offered         | the command flag is FALSE| running; HandedOver and the next if its end is not told
/// both            | the patience ends        | Refused, the offer withdrawn
/// both            | of information: 10 s     | dropped, the offer withdrawn; also while it waits
/// writing         | a skill is added         | Refused, unless it is a command
/// running         | the done flag is FALSE   | Started, once
/// running         | the done flag, ours      | Ended, an answer, or Refused; the next message
/// any             | the done flag, another's | counted as late
/// halted          | its end, before the stop | as of one that runs
/// halted          | the halt is refused      | running; if it may not have been taken, the patience long
/// any             | the connection is lost   | Refused, unless it has been answered
class C3Jobs {
 public:
  static constexpr std::uint64_t kMark = 0;  ///< C3Ask::about of the done flag's requests

  using Commands = std::map<std::string, C3Command, std::less<>>;
  struct Program {
    bool fields = false;  ///< it accepts messages field by field
    std::size_t chunk_bytes = 0;
    Duration patience{};
    std::uint64_t instance = 0;
  };
  /// Other parts of the driver that it uses, which outlive it. While a turn is open no message begins.
  struct Parts {
    const C3Names& names;
    C3Link& link;
    C3PollTimes& polls;
    const C3Turns& turns;
  };
  C3Jobs(const Parts& parts, const Program& program, Commands commands);

  [[nodiscard]] bool has_words(std::string_view subtype) const { return commands_.contains(subtype); }
  /// A skill is begun before all that waits. Errors: busy (a skill runs), queue_full, bad_value, not_escapable.
  Status add(const Handover& message, Now now, const DriverOut& out);
  [[nodiscard]] bool runs(Token token) const;
  void forget(Token token, Now now, const DriverOut& out);
  /// True: the program may carry it out, or one that is not known any more, and the motion has to be ended. Until
  /// drop_halted() its end is still told.
  bool halt(Token token, Now now, const DriverOut& out);
  void drop_halted() {
    if (current_ && current_->halted) current_.reset();
  }
  /// The program goes on with it: the next message must not be written over it before its end.
  void on_halt_refused(Now now, const DriverOut& out);
  /// Begins the first waiting message, unless one is in progress.
  void begin_next(Now now, const DriverOut& out);

  /// Drops all messages. One that is being carried out was answered already: a service that waits for its end is
  /// notified of the stop or the loss itself. True: the program may still take one, so clear_offer() has to follow.
  bool drop(const Error& why, const DriverOut& out);
  struct Broken {
    bool moved = false;    ///< one was being carried out
    bool offered = false;  ///< as returned by drop()
  };
  /// Like drop(), and the running skill has failed: the robot has stopped it.
  Broken fail_all(const Error& why, const DriverOut& out);
  void clear_offer(Now now, const DriverOut& out);
  void restart() { done_.restart(); }

  // What has to be read from the robot now.
  [[nodiscard]] bool under_way() const { return current_.has_value(); }
  [[nodiscard]] bool waits_for_chunk() const { return waits_in(C3Job::Phase::writing); }
  [[nodiscard]] bool waits_to_be_taken() const { return waits_in(C3Job::Phase::offered); }
  void check_patience(Now now, const DriverOut& out);

  void on_written(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_chunk_flag(bool raised, Now now, const DriverOut& out);
  void on_command_flag(bool raised, Now now, const DriverOut& out);
  void on_done_flag(bool raised, Now now, const DriverOut& out);
  void on_part(const C3Reply& reply) { done_.on_part(reply); }
  /// The end of a message was read, and its flag cleared.
  void on_cleared(Now now, const DriverOut& out);

 private:
  [[nodiscard]] bool waits_in(C3Job::Phase phase) const {
    return current_ && current_->phase == phase && current_->waits_since;
  }
  [[nodiscard]] Status may_take(const Handover& message) const;
  [[nodiscard]] bool may_be_taken() const;
  Result<C3Job> make_job(const Handover& message, Now now);
  void make_way(Now now, const DriverOut& out);
  void drop_late(Now now, const DriverOut& out);
  Status add_words(const Handover& message, C3Job& job) const;
  void do_step(Now now, const DriverOut& out);
  void withdraw(Now now, const DriverOut& out);
  void refuse(const Error& why, Now now, const DriverOut& out);
  void on_taken(Now now, const DriverOut& out);
  void on_started(const DriverOut& out);
  void end(bool well, const std::string& text, Now now, const DriverOut& out);

  const C3Names& names_;
  C3Link& link_;
  C3PollTimes& polls_;
  const C3Turns& turns_;
  Program program_;
  Commands commands_;
  C3Flag done_;
  std::int64_t last_number_;
  std::optional<C3Job> current_;
  std::deque<C3Job> waiting_;
};

}  // namespace trb::drivers
