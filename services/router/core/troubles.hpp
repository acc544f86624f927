// What has gone wrong with links and is not yet well again: for people, through `trb doctor`.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"

namespace trb::router {

constexpr std::size_t kMaxTroubles = 256;  ///< the oldest gives way

class Troubles {
 public:
  /// `peer` or `address` may be empty; `code` is an errc_name() or the name of a link's end. The same again raises the
  /// count.
  void note(std::string_view peer, std::string_view address, std::string_view code, std::string_view text,
            MonotonicTime now);
  /// A link with this peer came up by this address: what kept it away is over.
  void recovered(std::string_view peer, std::string_view address);
  /// The newest first.
  [[nodiscard]] LinkTroubles table(const std::string& node, MonotonicTime now) const;

 private:
  struct Trouble {
    std::string text;
    std::uint64_t count = 0;
    MonotonicTime last;
  };
  void forget_oldest();
  std::map<std::tuple<std::string, std::string, std::string>, Trouble> rows_;  ///< by peer, address, code
};

}  // namespace trb::router
