// Faults of links that have not recovered yet: for people, through `trb doctor`.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

constexpr std::size_t kMaxLinkErrors = 256;  ///< the oldest of the peer that has most is removed

class LinkErrors {
 public:
  explicit LinkErrors(const PeerTable& table) : table_(table) {}

  /// `peer` or `address` may be empty; `code` is an errc_name() or the name of a link's end. Noting the same again
  /// raises the count.
  void note(std::string_view peer, std::string_view address, std::string_view code, std::string_view text, Now now);
  /// An error of a link: listed by its peer while it is up, before that by the address that is dialled.
  void note_link(LinkId link, std::string_view code, std::string_view text, Now now);
  /// A link with this peer came up by this address: its errors are over, but not kSharedKeys.
  void recovered(std::string_view peer, std::string_view address);
  void forget(std::string_view peer, std::string_view code);
  void note_up(const Link& link, const Hello& hello, Now now);
  /// A linked peer has just told its clock's UTC. Clocks that are a minute apart make certificates and schedules fail
  /// before anybody sees why.
  void note_clock(std::string_view peer, std::int64_t utc, Now now);
  /// The newest first.
  [[nodiscard]] LinkErrorTable table(const std::string& node, MonotonicTime now) const;

 private:
  struct Row {
    std::string text;
    std::uint64_t count = 0;
    MonotonicTime last;
  };
  void make_room(std::string_view peer);

  const PeerTable& table_;
  std::map<std::tuple<std::string, std::string, std::string>, Row> rows_;  ///< by peer, address, code
};

}  // namespace trb::router
