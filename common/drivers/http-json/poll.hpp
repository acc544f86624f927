// The values that are polled from a robot, one path at a time, and the last result of each.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/http-json/wire.hpp"
#include "common/drivers/polled_values.hpp"

namespace trb::drivers {

class HttpPoll : public PolledValues {
 public:
  /// Without questions `probe` is requested, so that a lost robot is noticed; any answer to it is good.
  HttpPoll(const std::map<std::string, HttpQuestion>& questions, HttpPath probe, Duration period);

  /// All are requested at once.
  void restart(Now now) { due_ = now.mono; }
  [[nodiscard]] MonotonicTime due() const { return due_; }
  /// How many requests a whole round has.
  [[nodiscard]] std::size_t paths() const { return groups_.size(); }
  /// The robot does not accept the node's user, or not for this. A probe's path may be one that this user only may not
  /// read.
  [[nodiscard]] bool refuses_sign_in(const HttpAnswer& answer) const {
    return answer.status == 401 || (answer.status == 403 && !groups_.front().values.empty());
  }
  /// The next path of the round; empty: nothing more of the round can be requested yet, and it is over.
  std::optional<std::string> next(const Remembered& remembered, Now now);
  /// The answer to next().
  Changes on_answer(const HttpAnswer& answer, Now now);
  /// Values that depend on that name become unknown: it refers to something else from now on.
  void forget(std::string_view name);

 private:
  struct Group {
    HttpPath path;
    std::map<std::string, std::vector<HttpQuestion::Part>> values;  ///< by name
  };
  void take(const std::string& name, const std::vector<HttpQuestion::Part>& parts, const Result<Value>& json, Now now,
            Changes& changes);
  void advance(Now now);

  Duration period_;
  std::vector<Group> groups_;
  std::size_t at_ = 0;
  MonotonicTime due_;  ///< when the current or next round begins
};

/// The reason why an answer is an error, as text.
Error http_refusal(const std::string& what, const HttpAnswer& answer);

}  // namespace trb::drivers
