// log/proof: what came by the links and the seals over it, for `trb proof`. It is gathered here, link by link; a thread
// of its own writes it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "services/router/core/link_seals.hpp"
#include "services/router/io/proof_writer.hpp"

namespace trb::router {

class ProofLog {
 public:
  /// A bound of 0 keeps nothing.
  ProofLog(const std::string& dir, std::uint64_t max_bytes);

  [[nodiscard]] bool on() const { return writer_ != nullptr; }
  /// A frame came by a link; it stays here until its seal comes.
  void add(const LinkSeals& link, UtcTime now, BytesView frame);
  /// The latest seal was accepted.
  void sealed(const LinkSeals& link);
  /// The link has ended; what is unsealed is written too.
  void ended(LinkId link, UtcTime now, std::string_view why);
  /// Frames not kept in the log since the last call: the disk is slower than the links, or they exceed the peer's
  /// share.
  std::uint64_t take_dropped() { return std::exchange(dropped_, 0) + (on() ? writer_->take_dropped() : 0); }
  /// Why something could not be written since the last call; empty: nothing failed.
  std::string take_problem() { return on() ? writer_->take_problem() : std::string(); }

 private:
  struct Open {
    std::string peer;
    std::shared_ptr<const ProofLink> link;
    std::uint64_t first = 1;
    Bytes previous = first_previous();
    Bytes records;
    std::uint64_t frames = 0;  ///< in `records`
    bool overflow = false;     ///< the frames before the next seal are too many to keep
    bool retell = false;       ///< the certificates must be written again: something was dropped
  };
  void hand_over(Open& open, bool last);

  std::unique_ptr<ProofWriter> writer_;
  std::size_t max_pending_ = 0;
  std::map<LinkId, Open> open_;
  std::uint64_t dropped_ = 0;
};

}  // namespace trb::router
