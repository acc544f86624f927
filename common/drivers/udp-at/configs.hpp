// CONFIG of an AR.Drone: one at a time, each acknowledged by a bit of navdata, which CTRL then clears.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// One AT command that is sent once.
struct AtCall {
  std::string name;
  std::string arguments;
};

/// waiting -> sent -> (bit up) taken, CTRL -> (bit down) the next one. After 1 s without the bit: Refused, not
/// repeated.
class AtConfigs {
 public:
  /// May so many more wait? Errors: queue_full.
  [[nodiscard]] Status check_room(std::size_t more) const;
  /// `token` 0: no service waits for it.
  void add(Token token, std::string arguments) { waiting_.push_back({token, std::move(arguments)}); }
  /// No service waits for it any more; if it was sent, it stays sent.
  void forget(Token token);
  void drop_all(const Error& why, const DriverOut& out);

  void on_navdata(bool taken, const DriverOut& out);
  /// Adds what has to be sent now.
  void run(Now now, const DriverOut& out, std::vector<AtCall>& calls);
  [[nodiscard]] bool empty() const { return waiting_.empty() && !sent_; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Config {
    Token token = 0;
    std::string arguments;
  };

  [[nodiscard]] bool waits(Token token) const;

  std::deque<Config> waiting_;
  std::optional<Config> sent_;
  MonotonicTime sent_at_;
  bool bit_up_ = false;
  bool bit_due_ = false;  ///< the bit has to be cleared
};

}  // namespace trb::drivers
