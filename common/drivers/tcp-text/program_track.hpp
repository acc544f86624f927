// The programs of a controller that reports their start and end by name: which waits, which was sent, which runs.
#pragma once

#include <deque>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

struct Program {
  Token token = 0;
  std::string name;
  std::string text;
  std::string end_text;  ///< the text that it prints at its end
  bool tracked = false;  ///< a service waits for its end
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
  /// Errors: queue_full; busy: a program whose end is awaited would be replaced.
  Status submit(Program program, const DriverOut& out);

  void on_started(std::string_view name, const DriverOut& out);
  void on_stopped(std::string_view name, Now now, const DriverOut& out);
  void on_text(std::string_view text, const DriverOut& out);
  /// The controller's error, while a program runs: why it may be cut short.
  void on_error(std::string_view text);
  void on_exception(std::string_view text, const std::string& shown, const DriverOut& out);

  /// The robot carries nothing out any more: the running program has ended, sent or waiting ones are refused.
  void on_disabled(const Error& why, const DriverOut& out);

  /// True if it had not been sent yet: then there is nothing to stop.
  bool drop(Token token, const DriverOut& out);
  /// True if it had not been sent yet. Else its end is still reported, because it may come before the halt.
  bool halt(Token token);
  /// Waiting programs and the one that was sent are Refused; the running one is forgotten.
  void drop_all(const Error& why, const DriverOut& out);

  /// It waits, was sent or runs.
  [[nodiscard]] bool holds(Token token) const;
  [[nodiscard]] bool idle() const { return !sent_ && !running_; }
  [[nodiscard]] bool has_sent() const { return sent_.has_value(); }
  [[nodiscard]] bool runs_any() const { return running_.has_value(); }
  void tick(Now now, const DriverOut& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Running {
    Program program;
    bool reached_end = false;
    std::string error;                          ///< the controller's last one
    std::optional<MonotonicTime> cut_short_at;  ///< stopped without its end text: when it counts as cut short
  };

  void send_next(const DriverOut& out);
  void end_running(bool well, const std::string& text, const DriverOut& out);

  std::deque<Program> waiting_;
  std::optional<Program> sent_;
  std::optional<Running> running_;
};

}  // namespace trb::drivers
