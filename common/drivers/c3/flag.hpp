// A flag that the robot's program sets when some variables are ready: they are read, then the flag is cleared.
#pragma once

#include "common/drivers/c3/link.hpp"

namespace trb::drivers {

class C3Flag {
 public:
  /// Parts without a name do not exist, and read as empty. `mark`: C3Ask::about of its requests.
  C3Flag(std::string flag, std::vector<std::string> parts, std::uint64_t mark)
      : flag_(std::move(flag)), parts_(std::move(parts)), mark_(mark) {}

  [[nodiscard]] const std::string& name() const { return flag_; }
  [[nodiscard]] bool busy() const { return busy_; }
  void restart() { busy_ = false; }

  /// The flag was read as set.
  void on_raised(C3Link& link, Now now, const DriverOut& out);
  void on_part(const C3Reply& reply) { values_.push_back(reply.ok ? reply.value : std::string()); }
  /// The flag was cleared: returns the value of every part, in order.
  std::vector<std::string> on_cleared();

 private:
  std::string flag_;
  std::vector<std::string> parts_;
  std::uint64_t mark_;
  bool busy_ = false;
  std::vector<std::string> values_;
};

}  // namespace trb::drivers
