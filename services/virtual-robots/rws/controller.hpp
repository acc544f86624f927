#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/arm/six_axis.hpp"
#include "services/virtual-robots/rws/access.hpp"

namespace trb::virtual_robots::rws {

/**
 * A controller with RobotWare 6 by its web services 1.0, and a RAPID program that waits for `trb_go`, moves to
 * `trb_target`, and sets `trb_go` FALSE. Writing a symbol and moving the program pointer need the mastership. `now` is
 * robot time in seconds.
 */
class Controller {
 public:
  explicit Controller(AccessSettings settings);

  HttpReply answer(const HttpRequest& request, double now);
  void advance(double now);
  std::optional<double> next_deadline() const { return arm_.next_deadline(); }
  arm::Joints joints(double now) const { return arm_.joints(now); }
  std::size_t sessions() const { return access_.sessions(); }
  std::vector<std::string> take_events();

 private:
  HttpReply serve(const HttpRequest& request, std::uint64_t session, double now);
  HttpReply get(const std::string& path, double now);
  HttpReply post(const HttpRequest& request, std::uint64_t session, double now);
  HttpReply mastership(const std::string& action, std::uint64_t session);
  HttpReply execution(const std::string& action, std::uint64_t session, double now);
  HttpReply set_symbol(const std::string& name, const std::string& value, double now);
  void follow_program(double now);

  Access access_;
  arm::SixAxis arm_;
  std::map<std::string, std::string> symbols_{{"trb_go", "FALSE"}, {"trb_target", "[0,0,0,0,30,0]"}};
  std::uint64_t master_ = 0;  ///< the session that has the mastership; 0: nobody
  bool running_ = true;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::rws
