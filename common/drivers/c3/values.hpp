// The content of a KUKA's variables: those that are polled, and those that a request asks for.
#pragma once

#include <map>
#include <set>

#include "common/drivers/c3/link.hpp"
#include "common/drivers/c3/syntax.hpp"

namespace trb::drivers {

class C3Values {
 public:
  struct Question {
    std::string name;
    C3Question words;
  };
  using Requests = std::map<std::string, std::string, std::less<>>;  ///< subtype -> a value's name

  C3Values(C3Link& link, std::vector<Question> questions, Requests requests)
      : link_(link), questions_(std::move(questions)), requests_(std::move(requests)) {}

  [[nodiscard]] bool answers(std::string_view subtype) const { return requests_.contains(subtype); }
  [[nodiscard]] const RobotValue* find(std::string_view name) const { return find_value(values_, name); }

  /// A request that commands.json maps to a value: it is read from the robot. Errors: unknown_subtype, queue_full.
  Status ask(const Handover& request, Now now, const DriverOut& out);
  void forget(Token token) {
    if (asked_.erase(token) > 0) link_.drop_request(token);
  }
  /// Requests every value.
  void poll(Now now, const DriverOut& out);

  void on_value(const C3Link::Answer& answer, Now now, const DriverOut& out);
  void on_request(const C3Link::Answer& answer, const DriverOut& out);
  /// A new connection: errors of values are reported again.
  void restart() { told_bad_.clear(); }
  /// The connection is lost. LinkDown notifies the requesters.
  void drop_asked() { asked_.clear(); }

 private:
  struct Asked {
    std::string subtype;
    std::string source;
    C3Question words;
  };

  C3Link& link_;
  std::vector<Question> questions_;
  Requests requests_;
  std::map<Token, Asked> asked_;
  RobotValues values_;
  std::set<std::string, std::less<>> told_bad_;  ///< values that could not be read since the robot was connected
};

}  // namespace trb::drivers
