// Signs that two computers use the keys of one node: a copied folder, or a thief.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"

namespace trb::router {

/// The code of a link error.
constexpr std::string_view kSharedKeys = "shared_keys";

/// One start of a node, as its Hello tells it.
struct NodeStart {
  std::uint64_t boot = 0;
  std::string address;  ///< where it says that it can be dialled
};

/// Of one node                                                                        | told
/// -----------------------------------------------------------------------------------|-----
/// it was started again, or moved                                                     | no
/// an older start says Hello, once                                                    | no: it may have been read late
/// again, but the newer one was not heard in between: state/ was put back from a copy | no
/// again, 2 s after the first, and the newer one was heard in between: both live      | yes
/// one start came back four times in 10 s to an address that it had left              | yes
/// the same, but one of the addresses is link-local: a network that comes and goes    | no
///
/// What was seen of a node is forgotten after a minute without a sign, and once it has other keys.
class SharedKeys {
 public:
  /// An older start than the linked one said Hello; `heard`: the last word of the linked one. True: two computers.
  bool on_older(const std::string& id, BytesView key, std::uint64_t boot, MonotonicTime heard, MonotonicTime now);
  /// A start is at another address than before. True: two computers.
  bool on_moved(const std::string& id, BytesView key, const NodeStart& from, const NodeStart& to, MonotonicTime now);
  /// True: it has other keys than those of which this said that two computers use them.
  bool is_over(const std::string& id, BytesView key);

 private:
  struct Move {
    NodeStart from;
    MonotonicTime at;
    bool back = false;  ///< to an address that it had left
  };
  struct Seen {
    Bytes key;
    std::uint64_t boot = 0;  ///< of the older start; 0: none
    MonotonicTime first, last;
    std::vector<Move> moves;  ///< of the last 10 s
    bool told = false;
  };
  Seen& seen(const std::string& id, BytesView key, MonotonicTime now);

  std::map<std::string, Seen> nodes_;
};

}  // namespace trb::router
