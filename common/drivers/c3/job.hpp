// One message on its way into a KUKA's variables, and what its end is known by.
#pragma once

#include "common/drivers/c3/syntax.hpp"
#include "common/drivers/driver.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {

struct C3Step {
  std::string variable;
  std::string value;
  bool awaits_clear = false;  ///< the next step waits until the robot's program has set it FALSE
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
  bool tracked = false;    ///< somebody waits for its end
  bool forgotten = false;  ///< nobody waits for its answer any more
  std::vector<C3Step> steps;
  std::size_t next = 0;  ///< the step that is not yet done
  bool offers = false;   ///< the last step raises the command flag, which the program clears when it takes it
  bool ends = false;     ///< the program tells its end
  std::int64_t number = 0;
  Phase phase = Phase::writing;
  bool told_started = false;
  std::optional<MonotonicTime> waits_since;  ///< for the program to take it, or a chunk of it
};

/// The vendor's words for a subtype.
class C3Words {
 public:
  explicit C3Words(const std::vector<C3Assignment>& assignments);
  /// Errors: bad_value, not_escapable. With data, a list must have just the items that the words take.
  [[nodiscard]] Result<std::vector<C3Step>> fill(BytesView data) const;
  /// Every value with its placeholders empty; for words that take no data.
  [[nodiscard]] std::vector<C3Step> steps() const;

 private:
  struct Assignment {
    std::string variable;
    VendorTemplate value;
  };
  std::vector<Assignment> assignments_;
  std::size_t items_ = 0;
};

/// The steps that hand a message over field by field.
std::vector<C3Step> c3_field_steps(const C3Names& names, const Handover& message, std::int64_t number,
                                   std::size_t chunk_bytes);

}  // namespace trb::drivers
