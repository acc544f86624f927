// A KUKA's faults: the controller's stop of the program, and the program's own text.
#pragma once

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// The same text may be a fault of its own as "error", and the reason of a stop; it is reported once.
class C3Faults {
 public:
  explicit C3Faults(std::vector<std::string> capabilities) : capabilities_(std::move(capabilities)) {}

  [[nodiscard]] bool program_stopped() const { return stopped_; }
  /// Why the program is stopped, and what a person does then.
  [[nodiscard]] Error why_stopped() const;

  /// The error text was read; empty: there is none.
  void on_text(const std::string& text, Now now, const DriverOut& out);
  /// The controller's stop message was read. True: it is new, and report_stop() has to follow.
  bool on_stop_message(bool raised, const std::string& variable, const DriverOut& out);
  /// `text`: the error text, read after the stop; empty: the robot has no such variable.
  void report_stop(const std::optional<std::string>& text, Now now, const DriverOut& out);

  /// The connection is lost: after a new one every fault is reported again.
  void restart();

 private:
  void report(const std::string& text, const char* cause, bool is_new, Now now, const DriverOut& out);

  std::vector<std::string> capabilities_;
  bool stopped_ = false;
  std::string stop_text_;  ///< why the controller has stopped its program
  std::string text_;       ///< as last read
  MonotonicTime told_;
};

}  // namespace trb::drivers
