// The values that a robot is asked for again and again, one path at a time, and what it last told of each.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/drivers/driver.hpp"
#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/http-json/wire.hpp"

namespace trb::drivers {

class HttpPoll {
 public:
  struct Known {
    std::optional<RobotValue> value;
    std::optional<Error> problem;  ///< why it is not told
  };
  struct Changes {
    bool values = false;
    std::vector<Error> problems;  ///< each is told once, until the value is heard again
  };

  /// Without questions `probe` is asked for, so that a robot that has gone is noticed; any answer to it is good.
  HttpPoll(std::map<std::string, HttpQuestion> questions, HttpPath probe, Duration period);

  /// All are asked for at once.
  void restart(Now now) { due_ = now.mono; }
  [[nodiscard]] MonotonicTime due() const { return due_; }
  /// The next path of the round; none: nothing of the round can be asked for yet, and it is over.
  std::optional<std::string> next(const Remembered& remembered, Now now);
  /// The answer to next().
  Changes on_answer(const HttpAnswer& answer, Now now);
  /// What depends on that name is not known any more: it is another one's from now on.
  void forget(std::string_view name);
  /// None: it is not asked for, or not told yet.
  [[nodiscard]] const Known* find(std::string_view name) const;

 private:
  struct Group {
    HttpPath path;
    std::map<std::string, std::vector<HttpQuestion::Part>> values;  ///< by name
  };
  void take(const std::string& name, const std::vector<HttpQuestion::Part>& parts, const Result<Value>& json, Now now,
            Changes& changes);
  void lose(const std::string& name, const Error& problem, Changes& changes);
  void advance(Now now);

  Duration period_;
  std::vector<Group> groups_;
  std::size_t at_ = 0;
  MonotonicTime due_;  ///< when a round is, or was, to begin
  std::map<std::string, Known, std::less<>> known_;
};

/// Why an answer is none, in words. Errors: never none.
Error http_refusal(const std::string& what, const HttpAnswer& answer);

}  // namespace trb::drivers
