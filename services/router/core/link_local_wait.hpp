// When a node moves to an address of the link alone.
#pragma once

#include <string>

#include "common/base/time.hpp"

namespace trb::router {

/// While a lease is renewed, an interface has its link-local address (fe80::/10) alone: nobody moves there for so short
/// a time.
///
/// the node is | an address of the link alone is found                | anything else is found
/// ------------|------------------------------------------------------|-----------------------
/// somewhere   | it leaves, and takes that address after 3 s           | it goes there
/// nowhere     | it takes it, unless the 3 s are still running         | it goes there
class LinkLocalWait {
 public:
  static constexpr Duration kWait = std::chrono::seconds(3);

  /// Whether a node at `current` (empty: nowhere) takes `found` now; false: it is nowhere, and asks again at until().
  /// `wanted`: HOST_INT, which may name such an address itself.
  bool takes(const std::string& found, const std::string& current, const std::string& wanted, MonotonicTime now);
  [[nodiscard]] MonotonicTime until() const { return until_; }

 private:
  MonotonicTime until_{};
};

}  // namespace trb::router
