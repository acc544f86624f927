#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/abb/text.hpp"
#include "services/virtual-robots/arm/six_axis.hpp"

namespace trb::virtual_robots::abb {

/** A request that fails: the Nth of that code, or every one. */
struct Failure {
  int code = 0;
  std::optional<int> call;
};

/**
 * The two RAPID tasks of config/robots/abb: the program, which a move blocks, and the service task, which answers at
 * once. `now` is robot time in seconds.
 */
class Controller {
 public:
  explicit Controller(std::vector<Failure> failures = {})
      : arm_({0, 0, 0, 0, 30, 0}), failures_(std::move(failures)), calls_(failures_.size(), 0) {}

  /** True while a move blocks the program: it reads nothing. */
  bool blocked() const { return moving_.has_value(); }
  /** The program's answer; nothing: it comes with advance, when the move has ended. */
  std::optional<std::string> program(const std::string& text, double now);
  std::string service(const std::string& text, double now);
  /** The answer of a move that has ended. */
  std::optional<std::string> advance(double now);
  std::optional<double> next_deadline() const { return arm_.next_deadline(); }

  /** A motion error: the move ends with its text, and the motors go off; a WARNING is only reported. */
  std::optional<std::string> raise_fault(const std::string& capability, const std::string& severity,
                                         const std::string& text, double now);
  void clear();

  std::vector<std::string> take_events();

 private:
  std::optional<std::string> move(const Request& request, std::vector<arm::Step> steps, double now);
  std::string end_move(bool ok, const std::string& text);
  bool fails(int code);
  std::string joints_text(double now) const;
  std::string pose_text(double now) const;
  std::string state_text() const;

  arm::SixAxis arm_;
  std::vector<Failure> failures_;
  std::vector<int> calls_;
  std::optional<int> moving_;  ///< the request's code
  bool stopped_ = false;
  bool motors_ = true;
  int error_ = 0;
  std::string error_text_;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::abb
