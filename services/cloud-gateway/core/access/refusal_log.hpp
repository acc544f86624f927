// Which refusals are on record each, and which are counted: a stranger must not fill the disk with them.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/audit/audit_chain.hpp"

namespace trb::gateway {

/// idle    | a refusal                                             | counting for kWindow: it is on record
/// counting| another one: of somebody else, for something else     | on record, within the bounds
/// counting| a repeated one, or one beyond the bounds              | counted for its address
/// counting| the window is over                                    | idle: a record for each address with some more
class RefusalLog {
 public:
  static constexpr Duration kWindow = std::chrono::minutes(1);
  static constexpr std::size_t kOfSource = 8;
  static constexpr std::size_t kInAll = 32;
  /// Addresses with a number of their own; all others have one together.
  static constexpr std::size_t kSources = 16;

  /// False: it was counted instead.
  bool is_recorded(const AuditRecord& refusal, Now now);
  /// How many more there were, once the window is over.
  std::vector<AuditRecord> take_ended(Now now);
  /// The same, at once: the process ends.
  std::vector<AuditRecord> take_all(Now now);

 private:
  struct Source {
    std::set<std::string> recorded;
    std::uint64_t more = 0;
  };
  Source& source_of(const std::string& address);

  std::map<std::string, Source> sources_;  ///< by address; "": all others
  std::size_t recorded_ = 0;
  MonotonicTime began_;
};

}  // namespace trb::gateway
