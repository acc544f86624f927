#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/arm/six_axis.hpp"
#include "services/virtual-robots/kuka/variables.hpp"

namespace trb::virtual_robots::kuka {

/** A skill that fails: the Nth call that could begin, or every one. */
struct Failure {
  std::string skill;
  std::optional<int> call;
};

/**
 * The controller and the program trb.src on it (config/robots/kuka): takes messages from the variables, moves the arm,
 * and reports the end. `now` is robot time in seconds.
 */
class Program {
 public:
  explicit Program(std::vector<Failure> failures = {});

  Variables& variables() { return variables_; }

  /** Does everything that is due; also after every write. */
  void advance(double now);
  std::optional<double> next_deadline() const;

  /** The controller stops the program with a message; `capability` and `severity` as trb.src reports them. */
  void raise_fault(const std::string& capability, const std::string& severity, const std::string& text, double now);
  /** A person clears the message and starts the program again: it goes on where it was. */
  void clear(double now);
  /** A person selects the program, or cancels it. */
  void select(bool running, double now);
  /** Sends a message of the robot's own. */
  void say(std::string type, std::string subtype, std::string target, std::string data);

  /** Its events, each a line for stdout. */
  std::vector<std::string> take_events();

 private:
  struct Saying {
    std::string type, subtype, target, data;  ///< the data escaped, the part that is not yet sent
    std::size_t size = 0;                     ///< of all the data, before escaping
  };
  void declare_variables();
  void follow_stop(double now);
  void take_chunk();
  void take_message(double now);
  void begin(const std::string& subtype, double now);
  void answer(const std::string& subtype);
  void finish(int result, const std::string& text);
  void tell_next();
  bool fails(const std::string& skill);
  std::string axis_text() const;
  std::string pose_text() const;
  void emit(std::string line) { events_.push_back(std::move(line)); }

  Variables variables_;
  arm::SixAxis arm_;
  std::vector<Failure> failures_;
  std::vector<int> calls_;  ///< number of calls, for each failure's skill
  double now_ = 0;
  bool running_ = true;
  std::string held_;  ///< the chunks so far, as received
  std::optional<std::string> skill_;
  bool closed_ = false;
  long long number_ = 0;  ///< of the message under way
  std::deque<Saying> sayings_;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::kuka
