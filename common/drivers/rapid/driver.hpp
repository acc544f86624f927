// The direct mode for an ABB with a RAPID socket server. A move blocks the robot's program until it has ended: its
// answer is the command's end, and whatever cannot wait goes to a service task on another port.
#pragma once

#include <deque>
#include <map>

#include "common/drivers/commands_driver.hpp"
#include "common/drivers/driver_settings.hpp"
#include "common/drivers/rapid/commands.hpp"
#include "common/drivers/rapid/port.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {

struct RapidCommand {
  struct Request {
    int code = 0;
    VendorTemplate text;
  };
  std::vector<Request> requests;
  std::size_t items = 0;  ///< of the data that the requests need
};

class RapidDriver : public CommandsDriver<RapidCommand> {
 public:
  RapidDriver(const DriverSettings& settings, const RapidCommands& commands);

  [[nodiscard]] bool online() const override { return program_up_ && service_up_ && heard_; }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override { return find_value(values_, name); }
  [[nodiscard]] bool may_be_stopped() const override { return may_be_stopped_ || may_stand_; }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override;
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  [[nodiscard]] Duration silence_bound() const override { return kServiceTime; }
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  /// A service task that answers nothing for so long is given up.
  static constexpr Duration kServiceTime = std::chrono::seconds(2);

  struct Question {
    std::string name;
    RapidQuestion words;
  };
  struct Step {
    int code = 0;
    std::string text;
  };
  /// A command; its steps follow each other.
  struct Job {
    Token token = 0;
    std::string subtype;
    bool tracked = false;
    bool told_started = false;
    bool forgotten = false;
    bool halted = false;  ///< it is to end; its answer may tell that it came to its own end before
    std::vector<Step> steps;
    std::size_t next = 0;
    std::uint64_t number = 0;
    MonotonicTime began;
  };
  /// A stop or release until the service task has confirmed it; `own`: only a motion is ended, without a fence.
  struct Turn {
    bool stop = false;
    bool own = false;
    Token ticket = 0;
    std::size_t unanswered = 0;
    bool refused = false;               ///< it will not be confirmed any more
    Token halts = 0;                    ///< own: the command that is to end
    std::optional<Token> then_halts{};  ///< of a release: the command that is to end behind it
    std::optional<Token> joined{};      ///< of a release: the ticket of the last one that joined it
  };
  struct Asked {
    std::string subtype;
    std::string source;
    RapidQuestion words;
  };

  [[nodiscard]] Result<std::vector<Step>> fill(std::string_view subtype, BytesView data) const;
  [[nodiscard]] Status may_take() const;
  Result<Progress> request_value(const Handover& message, const std::string& name, Now now, const DriverOut& out);
  void begin_next(Now now, const DriverOut& out);
  void go_on(Now now, const DriverOut& out);
  void send_step(Now now, const DriverOut& out);
  void end_motion(Token token, Now now, const DriverOut& out);
  Token begin_turn(bool stop, bool own, Now now, const DriverOut& out, Token halts = 0);
  std::optional<Token> join_release();
  void give_up_halt(const std::string& why, const DriverOut& out);
  void on_halted(Token token, const DriverOut& out);
  void drop_all(const Error& why, const DriverOut& out);
  void poll(Now now, const DriverOut& out);
  void check_times(Now now, const DriverOut& out);
  void drop_connection(Channel channel, const std::string& counted, const std::string& reason, Now now,
                       const DriverOut& out);

  // from the robot: inbound.cpp
  void read_all(Channel channel, Now now, const DriverOut& out);
  void on_answer(const RapidPort::Answer& answer, Now now, const DriverOut& out);
  void on_step(const RapidPort::Answer& answer, Now now, const DriverOut& out);
  void end_job(bool well, const std::string& text, Now now, const DriverOut& out);
  void on_started(const DriverOut& out);
  void on_turn(const RapidPort::Answer& answer, Now now, const DriverOut& out);
  void on_turn_refused(const std::string& why, Now now, const DriverOut& out);
  void confirm_turn(bool by_robot, Now now, const DriverOut& out);
  void on_state(const RapidAnswer& answer, Now now, const DriverOut& out);
  void on_value(const RapidPort::Answer& answer, Now now, const DriverOut& out);
  void on_request(const RapidPort::Answer& answer, const DriverOut& out);
  void remember(const std::string& name, std::vector<double> numbers, Now now);

  std::vector<std::string> capabilities_;
  std::vector<Question> questions_;

  RapidPort program_{Channel::command};
  RapidPort service_{Channel::monitor};
  bool program_up_ = false;
  bool service_up_ = false;
  bool heard_ = false;
  bool motors_ = true;
  bool may_stand_ = false;  ///< in the stop that only ended a motion, until a release is confirmed
  std::string error_;       ///< the number and text of the robot's last error; empty: none
  std::uint64_t last_number_ = 0;
  std::optional<Turn> turn_;
  std::optional<Job> current_;
  std::deque<Job> jobs_;
  std::map<Token, Asked> asked_;
  RobotValues values_;
  MonotonicTime next_poll_;
  MonotonicTime next_values_;
  std::optional<MonotonicTime> answer_by_;  ///< until then a motion that was ended must be answered
  std::optional<MonotonicTime> lost_by_;    ///< until then, with the motors off, the running command must be answered
};

}  // namespace trb::drivers
