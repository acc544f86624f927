// The middleware, played step by step against one robot. Once something is wrong, the further steps of a case do
// nothing.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "services/cli/conform/collector.hpp"
#include "services/cli/conform/robot_end.hpp"
#include "services/cli/conform/wire.hpp"

namespace trb::cli::conform {

struct Settings {
  FieldChannel channel;
  std::string own_id;  ///< of the robot's own node
  std::string from;    ///< the robot's address; empty: any
  std::string echo = "echo";
  std::size_t large = 1'000'000;  ///< bytes of the largest message; 0: none is tried
  Duration first_dial = std::chrono::seconds(60);
  Duration patience = std::chrono::seconds(5);  ///< for an answer, and for the robot to dial again
  std::string skill;                            ///< a skill that the robot may be made to do; empty: none
  std::string skill_data;
  Duration skill_timeout = std::chrono::seconds(60);
};

struct CaseResult {
  enum class Kind : std::uint8_t { good, wrong, not_tried };
  Kind kind = Kind::good;
  std::string expected;
  std::string came;  ///< of not_tried: why
};

class Play {
 public:
  Play(RobotEnd& end, const Settings& settings);

  // ---- a case
  /// Takes the robot in, if it is not connected.
  void begin();
  CaseResult end();
  [[nodiscard]] bool going() const { return !result_; }
  void wrong(std::string expected, std::string came);
  void not_tried(std::string why);

  // ---- what the middleware does
  /// A whole message, each field acknowledged.
  void send(const std::string& type, const std::string& subtype, const std::string& data);
  /// Its first fields only.
  void send_part(const std::string& type, const std::string& subtype, const std::string& data, std::size_t fields);
  /// Whole messages in one write, without a look at what is answered; only for a robot that acknowledges nothing.
  void send_at_once(const std::vector<std::vector<std::string>>& messages);
  /// Bytes as they are.
  void raw(const std::string& bytes);
  void order(const std::string& word) { raw(framed(word, settings_.channel)); }
  /// Breaks the connection and waits for the robot to dial again.
  void break_off();

  // ---- what the robot should do
  void expect_ok(const std::string& after);
  void expect_stopped();
  void expect_released();
  void expect_answer(const std::string& subtype, const std::string& data);
  /// That requests are answered at all.
  void expect_answers();
  void expect_quiet(Duration duration, const std::string& why);
  /// A `done` or `failed` of the skill, as its text; empty if none came in that time.
  std::string report(Duration patience);

  // ---- both
  /// A request that comes back with its data. Not tried with a robot that does not do that.
  void echo(const std::string& data);
  /// That the robot understands the next message: whatever came before has left nothing behind.
  void still_understands();

  [[nodiscard]] const Settings& settings() const { return settings_; }
  [[nodiscard]] const Words& words() const { return words_; }
  [[nodiscard]] bool delayed() const { return settings_.channel.framing == Framing::delay; }
  [[nodiscard]] bool acknowledged() const { return settings_.channel.acknowledge && !delayed(); }
  /// The fields of a message, framed: four, then its chunks. Empty (and not tried) without a number for a word.
  std::vector<std::string> fields(const std::string& type, const std::string& subtype, const std::string& data);
  Duration skill_took{};

 private:
  enum class Answers : std::uint8_t { not_asked, echo, other, none };

  enum class Came : std::uint8_t { nothing, something, end };

  /// Reads once, into fields_.
  Came pump(Duration patience);
  Received receive(Duration patience);
  /// The same, but first what has come already.
  Received next(Duration patience);
  void learn_how_it_answers();
  void expect_order(Received::Kind wanted, const std::string& word);
  void write(const std::string& bytes);
  [[nodiscard]] Duration ack_patience() const { return seconds(settings_.channel.ack_timeout_s); }

  RobotEnd& end_;
  Settings settings_;
  Words words_;
  std::string requester_;  ///< whose messages they are
  Cutter cutter_;
  std::deque<Field> fields_;  ///< cut and not looked at yet
  Collector collector_;
  std::deque<Said> inbox_;  ///< messages of the robot's own that came while something else was waited for
  Answers answers_ = Answers::not_asked;
  std::string no_answer_ = "nothing";  ///< what came instead of an answer
  std::optional<CaseResult> result_;
  bool was_there_ = false;
  int pings_ = 0;
};

}  // namespace trb::cli::conform
