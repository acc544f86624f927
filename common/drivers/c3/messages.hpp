// The messages that a KUKA's program sends: a flag over five variables, chunk by chunk.
#pragma once

#include "common/drivers/c3/flag.hpp"
#include "common/drivers/c3/syntax.hpp"

namespace trb::drivers {

class C3Messages {
 public:
  static constexpr std::uint64_t kMark = 1;  ///< C3Ask::about of its requests

  /// `own_id`: the target of a message without one.
  C3Messages(const C3Names& names, std::string own_id)
      : flag_(names.out, {names.out_type, names.out_subtype, names.out_target, names.out_size, names.out_data}, kMark),
        own_id_(std::move(own_id)) {}

  [[nodiscard]] const std::string& flag() const { return flag_.name(); }
  void on_raised(C3Link& link, Now now, const DriverOut& out) { flag_.on_raised(link, now, out); }
  void on_part(const C3Reply& reply) { flag_.on_part(reply); }
  /// A chunk was read, and its flag cleared. The last one completes the message; an invalid one is refused and counted.
  void on_cleared(const DriverOut& out);
  void restart();

 private:
  void send(const std::vector<std::string>& parts, bool whole, Bytes data, const DriverOut& out);

  C3Flag flag_;
  std::string own_id_;
  Bytes data_;  ///< the chunks so far
};

}  // namespace trb::drivers
