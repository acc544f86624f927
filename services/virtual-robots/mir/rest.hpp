#pragma once

#include <string>

#include "services/virtual-robots/mir/robot.hpp"

namespace trb::virtual_robots::mir {

struct Answer {
  unsigned status = 200;
  std::string body;  ///< JSON; empty: none
};

/** The robot's REST interface 2.0, as far as a client that starts missions needs it. */
class Rest {
 public:
  /** `authorization`: what a client must send; empty: any client is allowed. */
  Rest(Robot& robot, std::string authorization) : robot_(robot), authorization_(std::move(authorization)) {}

  Answer answer(const std::string& method, const std::string& target, const std::string& authorization,
                const std::string& body);

 private:
  Answer status() const;
  Answer set_status(const std::string& body);
  Answer missions() const;
  Answer queue() const;
  Answer entry(std::int64_t id) const;
  Answer append(const std::string& body);

  Robot& robot_;
  std::string authorization_;
};

/** "Basic BASE64(USER:SHA-256 of PASSWORD in hexadecimal)", as on the maker's robot. */
std::string authorization_of(const std::string& user, const std::string& password);

}  // namespace trb::virtual_robots::mir
