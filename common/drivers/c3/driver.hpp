// The interpreter mode over C3: a message is written field by field into a KUKA's variables, or as the words of
// commands.json; flags tell when the robot's program has taken it and when it is over.
#pragma once

#include <deque>
#include <set>

#include "common/drivers/c3/flag.hpp"
#include "common/drivers/c3/job.hpp"
#include "common/drivers/driver_settings.hpp"

namespace trb::drivers {

class C3Driver : public Driver {
 public:
  explicit C3Driver(const DriverSettings& settings);

  [[nodiscard]] bool online() const override { return up_ && heard_; }
  [[nodiscard]] bool knows(MessageType type, std::string_view subtype) const override;
  [[nodiscard]] bool tells_end(std::string_view) const override { return !names_.done.empty(); }
  [[nodiscard]] const RobotValue* value(std::string_view name) const override;

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override;
  void forget(Token token, Now now, const DriverOut& out) override;
  void halt(Token token, Now now, const DriverOut& out) override;
  Result<Token> stop(Now now, const DriverOut& out) override;
  Result<Token> release(Now now, const DriverOut& out) override;
  [[nodiscard]] bool told_to_stop() const override { return told_to_stop_; }

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  enum class Probe : std::uint64_t { chunk, command, done, out, stopped, stop_message, error, error_of_stop };
  /// A stop or release until the robot has confirmed it; `own`: a motion is ended without a fence.
  struct Turn {
    bool stop = false;
    bool own = false;
    Token ticket = 0;
    std::size_t unanswered = 0;  ///< its writes
  };
  struct Question {
    std::string name;
    C3Question words;
  };
  struct Asked {
    Token token = 0;
    std::string subtype;
    std::string source;
    C3Question words;
  };

  // to the robot
  [[nodiscard]] Status may_take(const Handover& message) const;
  Result<C3Job> make_job(const Handover& message);
  Result<Progress> ask_value(const Handover& message, const std::string& name, Now now, const DriverOut& out);
  void begin_next(Now now, const DriverOut& out);
  void do_step(Now now, const DriverOut& out);
  void withdraw(Now now, const DriverOut& out);
  void end_motion(Now now, const DriverOut& out);
  Token begin_turn(bool stop, bool own, Now now, const DriverOut& out);
  void drop_all(const Error& why, const DriverOut& out);
  void poll(Now now, const DriverOut& out);
  void probe(Probe what, const std::string& variable, Now now, const DriverOut& out);
  void refuse_job(const Error& why, Now now, const DriverOut& out);
  void check_patience(Now now, const DriverOut& out);
  void drop_connection(const std::string& counted, const std::string& reason, Now now, const DriverOut& out);

  // from the robot: inbound.cpp
  void on_answer(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_step(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_probe(Probe what, const C3Reply& reply, Now now, const DriverOut& out);
  void on_taken(Now now, const DriverOut& out);
  void on_started(const DriverOut& out);
  void on_done(const std::vector<std::string>& parts, Now now, const DriverOut& out);
  void end_job(bool well, const std::string& text, Now now, const DriverOut& out);
  void on_out(const std::vector<std::string>& parts, const DriverOut& out);
  void on_stopped(bool stopped, Now now, const DriverOut& out);
  void confirm_turn(bool by_robot, Now now, const DriverOut& out);
  void on_stop_message(bool raised, Now now, const DriverOut& out);
  void on_program_stopped(Now now, const DriverOut& out);
  void on_error_text(const std::string& text, Now now, const DriverOut& out);
  void report_fault(const std::string& text, const char* cause, bool is_news, Now now, const DriverOut& out);
  void on_value(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_request(const C3Link::Answer& answer, const DriverOut& out);
  void warn_unknown(const C3Link::Answer& answer, const DriverOut& out);

  std::string own_id_;
  std::vector<std::string> capabilities_;
  C3Names names_;
  bool fields_;  ///< the robot's program takes messages field by field
  std::size_t chunk_bytes_;
  Duration patience_;
  std::map<std::string, C3Words, std::less<>> commands_;
  std::map<std::string, std::string, std::less<>> requests_;
  std::vector<Question> questions_;

  C3Reader reader_;
  C3Link link_;
  C3Flag done_;
  C3Flag out_;
  bool up_ = false;
  bool heard_ = false;
  bool told_to_stop_ = false;
  bool stop_message_ = false;
  std::string stop_text_;   ///< why the controller has stopped its program
  std::string error_text_;  ///< as last read
  MonotonicTime error_told_;
  Bytes out_data_;  ///< the chunks of a message of the robot's so far
  Token last_ticket_ = 0;
  std::int64_t last_number_;
  std::optional<Turn> turn_;
  std::optional<C3Job> current_;
  std::deque<C3Job> jobs_;
  std::map<Token, Asked> asked_;
  std::map<std::string, RobotValue, std::less<>> values_;
  std::set<std::string, std::less<>> unknown_;  ///< variables that the robot has refused since it was connected
  MonotonicTime next_poll_;
  MonotonicTime next_values_;
};

}  // namespace trb::drivers
