// The direct mode in text: a command is one or more lines, each with its answer; values are polled. Only one line is
// unanswered at a time, so that a stop waits for one answer at most.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/drivers/polled_driver.hpp"
#include "common/drivers/tcp-dialogue/commands.hpp"
#include "common/drivers/tcp-dialogue/poll.hpp"
#include "common/drivers/tcp-dialogue/reader.hpp"

namespace trb::drivers {

struct DialogueStep {
  std::string line;  ///< with its placeholders filled
  std::optional<Pattern> end;
  std::optional<Pattern> failure;
};

/// The phases of a connection: README.md has the table of what each does with an answer.
enum class DialoguePhase : std::uint8_t { down = 0, greeting, begin, talk };

class DialogueDriver : public PolledDriver<std::vector<DialogueLine>, DialogueStep, DialoguePoll> {
 public:
  DialogueDriver(const DriverSettings& settings, DialogueCommands commands);

  /// A connection alone is not enough: a hung controller still accepts it.
  [[nodiscard]] bool online() const override { return heard_; }
  /// An answer to each line of a halt, and to the one that is under way, or the connection is closed; then the halt is
  /// held.
  [[nodiscard]] Duration silence_bound() const override { return (stop_lines_ + 1) * timeout_ + halt_time(); }

  Result<Progress> hand_over(const Handover& message, Now now, const DriverOut& out) override;
  [[nodiscard]] bool runs(Token token) const override;
  void halt(Token token, Now now, const DriverOut& out) override;
  Result<Token> stop(Now now, const DriverOut& out) override;

  void on_up(Channel channel, Now now, const DriverOut& out) override;
  void on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) override;
  void on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) override;
  void tick(Now now, const DriverOut& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  static constexpr std::size_t kMostUnderWay = 16;
  /// A command that was answered and is over at a later line.
  struct UnderWay {
    Token token = 0;
    bool skill = false;
    Pattern end;
    std::optional<Pattern> failure;
  };

  Result<std::vector<DialogueStep>> fill(std::string_view subtype, BytesView data) const override;
  void pump(Now now, const DriverOut& out) override;
  [[nodiscard]] bool takes_orders() const override { return phase_ == DialoguePhase::talk; }
  [[nodiscard]] Error offline_error() const override;

  void go_on(Now now, const DriverOut& out);
  void send(const std::string& line, Now now, const DriverOut& out);
  [[nodiscard]] std::optional<MonotonicTime> keep_alive_due() const;
  [[nodiscard]] bool waits() const { return opens_ || queue_.awaits() != Awaits::nothing; }
  bool on_line(const std::string& line, Now now, const DriverOut& out);
  bool on_opening(const std::string& line, Now now, const DriverOut& out);
  void on_answer(Awaits whose, const std::string& line, Now now, const DriverOut& out);
  void on_step(const std::string& line, Now now, const DriverOut& out);
  void on_done(const Job& job, Now now, const DriverOut& out) override;
  bool ends_command(const std::string& line, const DriverOut& out);
  [[nodiscard]] bool is_late_end(const std::string& line);
  void become_online(const DriverOut& out);
  bool lose(const std::string& reason, Now now, const DriverOut& out);
  [[nodiscard]] static Error lost(const Job& job, bool under_way, const std::string& reason);

  DialogueManner manner_;
  Duration timeout_;
  int stop_lines_ = 0;
  std::vector<Pattern> ends_;  ///< of all commands
  AnswerReader reader_;

  DialoguePhase phase_ = DialoguePhase::down;
  std::size_t begun_ = 0;   ///< lines of "begin" that were sent
  bool opens_ = false;      ///< the greeting or the answer to a line of "begin" is awaited
  bool asks_life_ = false;  ///< what is awaited is the answer to "keep_alive"
  MonotonicTime sent_at_{};
  std::string sent_;         ///< the last line
  std::string refused_why_;  ///< the robot does not let the node begin; empty: it does
  std::vector<UnderWay> under_way_;
};

}  // namespace trb::drivers
