// What keeps the robot, or a capability of it, out of use: faults that stand, and a person's word.
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
  std::string cause;  ///< of the robot's, a service's or a person's: there is one line a cause
  OutOfUse what;
  bool said_now = false;  ///< the robot has said so since this process began, and would say the end; not on disk
};

/// Keeps the lines over a restart. A port, as the fence's: a fault holds whether the disk takes it or not.
using PersistOutOfUse = std::function<Status(const std::vector<Kept>&)>;

/// event                             | no line of that cause | a line
/// ----------------------------------|-----------------------|-----------------------------------------------------
/// the robot or a service says it    | written               | written, if worse or milder; newer words: within 1 s
/// the robot says that it is over    | -                     | gone
/// a person says: repaired           | refused: conflict     | gone once that is on disk; refused while the robot says
/// it a person retires the robot        | written               | the newer reason a person returns it               |
/// refused: conflict     | gone once that is on disk
///
/// A disk that takes nothing is tried again every second; the line counts meanwhile. Told to others is shown(): one
/// entry a capability, the worst, with the newest words.
class OutOfUseBook {
 public:
  OutOfUseBook(std::vector<Kept> lines, PersistOutOfUse persist);

  /// Errors: io_error, of the disk; the line holds all the same.
  Status add(Kept line, Now now, Outbox& out);
  /// What has ended; nothing, if nothing stood.
  std::optional<OutOfUse> end(const std::string& cause, Now now, Outbox& out);
  /// A person's word; an empty capability means every fault. What has ended. Errors: conflict, io_error: nothing has.
  Result<std::vector<OutOfUse>> repaired(const std::string& capability, bool robot_online);
  /// Errors: conflict, io_error.
  Status returned();

  /// Why a skill that needs the capability is not begun, if so.
  [[nodiscard]] const OutOfUse* keeps_out(std::string_view capability) const;
  /// A fault that takes the capability stands.
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
  std::optional<MonotonicTime> save_at_;  ///< set while the disk has not the newest
};

/// The cause of a retirement.
constexpr const char* kRetired = "retired";

}  // namespace trb::adapter
