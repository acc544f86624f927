// When a node moves to a link-local address.
#pragma once

#include <string>

#include "common/base/time.hpp"

namespace trb::router {

/// While a lease is renewed, an interface has only its link-local address (fe80::/10): no node moves there for so short
/// a time.
///
/// the node is | only a link-local address is found                  | another address is found
/// ------------|------------------------------------------------------|-----------------------
/// somewhere   | it leaves, and takes that address after 3 s           | it goes there
/// nowhere     | it takes it, unless the 3 s are still running         | it goes there
class LinkLocalWait {
 public:
  static constexpr Duration kWait = std::chrono::seconds(3);

  /// Does a node at `current` (empty: nowhere) take `found` now? False: it is nowhere, and asks again at until().
  /// `wanted`: HOST_INT, which may itself name such an address.
  bool takes(const std::string& found, const std::string& current, const std::string& wanted, MonotonicTime now);
  [[nodiscard]] MonotonicTime until() const { return until_; }

 private:
  MonotonicTime until_{};
};

}  // namespace trb::router
