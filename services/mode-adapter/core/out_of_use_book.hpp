// What keeps the robot, or a capability of it, out of use: standing faults, and a person's order.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::adapter {

/// One line of the book.
struct Kept {
  std::string cause;  ///< of the robot, a service or a person: one line per cause
  OutOfUse what;
  bool said_now = false;  ///< the robot has reported it to this process, and would report its end; not on disk
};

/// Keeps the lines over a restart. A port, like the fence's: a fault holds whether or not the disk works.
using PersistOutOfUse = std::function<Status(const std::vector<Kept>&)>;

/// event                          | no line of that cause | a line
/// -------------------------------|-----------------------|-------------------------------------------------------
/// the robot or a service reports | written               | written if worse or milder; newer words: within 1 s
/// the robot reports the end      | -                     | gone
/// a person reports the repair    | refused: conflict     | gone once that is on disk; refused while the robot
///                                |                       | still reports it
/// a person retires the robot     | written               | the newer reason
/// a person returns it            | refused: conflict     | gone once that is on disk
///
/// A failed write is tried again every second; the line counts meanwhile. Others get shown(): one entry per capability,
/// the worst, with the newest words.
class OutOfUseBook {
 public:
  OutOfUseBook(std::vector<Kept> lines, PersistOutOfUse persist);

  /// Errors: io_error, of the disk; the line still holds.
  Status add(Kept line, Now now, Outbox& out);
  /// What has ended; nothing if nothing stood.
  std::optional<OutOfUse> end(const std::string& cause, Now now, Outbox& out);
  /// A person's report; an empty capability means every fault. Returns what has ended. Errors: conflict, io_error:
  /// nothing has.
  Result<std::vector<OutOfUse>> repaired(const std::string& capability, bool robot_online);
  /// Errors: conflict, io_error.
  Status returned();

  /// Why a skill that needs the capability cannot begin, if so.
  [[nodiscard]] const OutOfUse* keeps_out(std::string_view capability) const;
  /// Is there a standing fault that takes the capability away?
  [[nodiscard]] bool faulty(std::string_view capability) const;
  [[nodiscard]] const std::vector<OutOfUse>& shown() const { return shown_; }

  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return save_at_; }

 private:
  using Lines = std::map<std::string, Kept>;

  Status save(Now now, Outbox& out);
  Status save_without(Lines left);
  void show();

  Lines lines_;
  PersistOutOfUse persist_;
  std::vector<OutOfUse> shown_;
  std::optional<MonotonicTime> save_at_;  ///< set while the newest lines are not on disk
  bool has_failed_ = false;               ///< the last write has: whoever adds a line is not told that it is kept
};

/// The cause of a retirement.
constexpr const char* kRetired = "retired";

}  // namespace trb::adapter
