// The programs sent to a controller that tells their start and end by name: which waits, which was sent, which runs.
#pragma once

#include <deque>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

struct Program {
  Token token = 0;
  std::string name;
  std::string text;
  std::string end_text;  ///< what it says when it comes to its end
  bool tracked = false;  ///< somebody waits for its end
};

/// One program at a time is sent and not yet started, because a refusal of the robot's does not name its program.
///
/// event     | sent                     | running
/// ----------|--------------------------|-------------------------------------------------------------
/// started   | becomes running: Started | (another name: ignored)
/// text      | -                        | its end text: it came to its end
/// stopped   | ignored                  | Ended well; without its end text, after a moment, Ended badly
/// exception | Refused                  | Ended badly
/// disabled  | Refused                  | Ended badly; with its end text, well
/// dropped   | forgotten                | forgotten
class ProgramTrack {
 public:
  /// Errors: queue_full; busy: a program whose end is waited for would be replaced.
  Status submit(Program program, const DriverOut& out);

  void on_started(std::string_view name, const DriverOut& out);
  void on_stopped(std::string_view name, Now now, const DriverOut& out);
  void on_text(std::string_view text, const DriverOut& out);
  void on_exception(std::string_view text, const std::string& shown, const DriverOut& out);

  /// The robot carries nothing out any more: what runs has ended, what was sent or waits is refused.
  void on_disabled(const Error& why, const DriverOut& out);

  /// True if it has not been sent yet: then there is nothing to stop.
  bool drop(Token token, const DriverOut& out);
  /// Nobody waits for it any more; one that was sent no longer keeps the next one from being sent.
  void drop_all(const Error& why, const DriverOut& out);

  /// It waits, was sent or runs.
  [[nodiscard]] bool holds(Token token) const;
  [[nodiscard]] bool idle() const { return !sent_ && !running_; }
  void tick(Now now, const DriverOut& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Running {
    Program program;
    bool reached_end = false;
    std::optional<MonotonicTime> cut_short_at;  ///< stopped without its end text: when that is believed
  };

  void send_next(const DriverOut& out);
  void end_running(bool well, const std::string& text, const DriverOut& out);

  std::deque<Program> waiting_;
  std::optional<Program> sent_;
  std::optional<Running> running_;
};

}  // namespace trb::drivers
