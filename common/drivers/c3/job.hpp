// One message on its way into a KUKA's variables, and how its end is detected.
#pragma once

#include "common/drivers/c3/syntax.hpp"
#include "common/drivers/driver.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {

struct C3Step {
  std::string variable;
  std::string value;
  bool awaits_clear = false;  ///< the next step waits until the robot's program has cleared it
};

/// phase    | the robot's program
/// ---------|----------------------------------------------
/// writing  | does not know of it, or takes its chunks
/// offered  | has not taken it yet
/// running  | carries it out
struct C3Job {
  enum class Phase : std::uint8_t { writing, offered, running };

  Token token = 0;
  MessageType type{};
  std::string subtype;
  std::string source;
  std::size_t bytes = 0;   ///< of its data
  bool tracked = false;    ///< a service waits for its end
  bool forgotten = false;  ///< no service waits for its answer any more
  bool halted = false;     ///< it is to end; what the program says of its end may have come before
  std::vector<C3Step> steps;
  std::size_t next = 0;  ///< the first step that is not done yet
  bool offers = false;   ///< the last step sets the command flag, which the program clears when it takes the message
  bool ends = false;     ///< the program reports its end
  std::int64_t number = 0;
  Phase phase = Phase::writing;
  bool told_started = false;
  std::optional<MonotonicTime> waits_since;  ///< since when it waits for the program to take it, or a chunk of it
  std::optional<MonotonicTime> until;        ///< of information, which no sender waits for: later it is dropped
};

/// The vendor's assignments for a subtype.
class C3Command {
 public:
  explicit C3Command(const std::vector<C3Assignment>& assignments);
  /// Errors: bad_value, not_escapable. A list must have exactly the items that the assignments use.
  [[nodiscard]] Result<std::vector<C3Step>> fill(BytesView data) const;
  /// The steps of assignments that take no data.
  [[nodiscard]] std::vector<C3Step> steps() const;

 private:
  struct Assignment {
    std::string variable;
    VendorTemplate value;
  };
  std::vector<Assignment> assignments_;
  std::size_t items_ = 0;
};

/// The steps that send a message field by field.
std::vector<C3Step> c3_field_steps(const C3Names& names, const Handover& message, std::int64_t number,
                                   std::size_t chunk_bytes);

}  // namespace trb::drivers
