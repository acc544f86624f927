// The direct mode over tcp-text: the node dials the robot and sends it the vendor's own text (commands.json); a monitor
// connection, if there is one, reports what becomes of it.
#pragma once

#include <map>

#include "common/config/node_config.hpp"
#include "common/drivers/commands_driver.hpp"
#include "common/drivers/tcp-text/program_track.hpp"
#include "common/drivers/tcp-text/ur_monitor.hpp"
#include "common/drivers/tcp-text/ur_rtde.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {

struct TcpCommand {
  VendorTemplate words;
  bool wrapped = false;
  std::string text;
};

class TcpTextDriver : public CommandsDriver<TcpCommand> {
 public:
  /// `instance`: this process's; its programs' names begin with it.
  TcpTextDriver(const VendorCommands& words, std::string own_id, std::uint64_t instance);

  [[nodiscard]] bool online() const override { return command_up_ && (!has_monitor_ || heard_); }
  [[nodiscard]] bool tells_end(std::string_view subtype) const override;
  /// Nothing shows when the controller has words that are no program; of a program the start is told.
  [[nodiscard]] bool values_lag(std::string_view subtype) const override { return !tells_end(subtype); }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override {
    return find_value(values_, name_of_value(name));
  }
  [[nodiscard]] bool answers_from_values() const override { return true; }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override { return track_.holds(token); }
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  struct Halting {
    Token token = 0;
    MonotonicTime at;  ///< when it was written
  };

  Status submit_program(const Handover& message, std::string_view lines, const DriverOut& out);
  void write_line(std::string_view text, Now now, const DriverOut& out);
  void look_at_halt(Now now, const DriverOut& out);
  void on_event(const UrEvent& event, Now now, const DriverOut& out);
  void on_exception(const UrException& raised, const DriverOut& out);
  void on_state(const UrState& state, Now now, const DriverOut& out);
  void remember_state(const UrState& state, Now now);
  void on_data(BytesView bytes, Now now, const DriverOut& out);
  void drop_data(const std::string& reason, const DriverOut& out);
  void report_safety(int safety, Now now, const DriverOut& out);
  void on_error(const UrError& error, Now now, const DriverOut& out);
  void warn(const std::string& text, Now now, const DriverOut& out);
  /// Why the arm carries nothing out, if so.
  [[nodiscard]] std::optional<Error> disabled(Now now) const;
  /// "trb send ID command SUBTYPE" for each of these subtypes that commands.json has.
  [[nodiscard]] std::string how_to(std::initializer_list<std::string_view> words) const;
  [[nodiscard]] std::string with_own_words(std::string text, Now now) const;
  void remember_six(const std::string& name, const std::array<double, 6>& numbers, Now now);
  void remember(const std::string& name, std::vector<double> numbers, std::string json, Now now);
  [[nodiscard]] bool surely_idle() const;
  void confirm_stop(bool stood, const DriverOut& out);
  [[nodiscard]] bool is_about_stop(std::string_view exception);
  void drop_monitor(std::string_view counted, const std::string& reason, Now now, const DriverOut& out);

  std::string stop_text_;
  std::string release_text_;
  bool urscript_;
  bool wraps_;
  bool has_monitor_;
  std::string name_;  ///< what the names of its programs begin with

  bool command_up_ = false;
  bool monitor_up_ = false;
  bool heard_ = false;  ///< a state was received on this monitor connection
  bool program_running_ = false;
  int safety_ = kUrSafetyNormal;
  int robot_mode_ = kUrModeRunning;
  std::string last_error_;  ///< the controller's last error text
  MonotonicTime last_error_at_;
  std::string last_warning_;
  std::optional<MonotonicTime> warned_at_;
  MonotonicTime last_heard_;  ///< when the last state was received or the connection began
  MonotonicTime last_state_;
  MonotonicTime last_write_;
  std::uint64_t programs_ = 0;
  std::optional<Token> stop_waits_;
  bool program_ran_ = false;         ///< when the stop was given
  bool program_unanswered_ = false;  ///< before the stop: the controller has neither started nor refused it yet
  std::optional<Halting> halting_;
  RobotValues values_;
  ProgramTrack track_;
  UrMonitor monitor_;
  std::vector<UrEvent> events_;
  UrRtde rtde_;
  bool data_up_ = false;
  MonotonicTime last_data_;
  std::optional<MonotonicTime> sampled_at_;  ///< by RTDE, on this connection
  std::optional<UrReach> reach_;
};

}  // namespace trb::drivers
