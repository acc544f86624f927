#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "services/virtual-robots/ur/controller.hpp"

namespace trb::virtual_robots::ur {

constexpr std::string_view kDashboardGreeting = "Connected: Universal Robots Dashboard Server";

/** The version of the software that is imitated; the Version message has the same. */
constexpr std::string_view kSoftwareVersion = "5.12.0.0";

/** What the dashboard answers, as the maker's "Dashboard Server e-Series" says it. One for all its clients. */
class DashboardAnswers {
 public:
  /** The text of a program in the folder of programs; nothing: no such file. */
  using Programs = std::function<std::optional<std::string>(std::string_view name)>;

  explicit DashboardAnswers(Programs programs = {}) : programs_(std::move(programs)) {}

  /** The answer to one line; applies it to the controller. */
  std::string answer(std::string_view line, Controller& controller, double now);

 private:
  std::string load(std::string_view path);
  std::string play(Controller& controller, double now);
  std::string program_state(const RobotState& state, const Controller& controller) const;

  Programs programs_;
  std::string loaded_;  ///< the file's name; empty: none
  std::string text_;
  std::uint64_t played_ = ~std::uint64_t{0};  ///< which of the controller's programs was started by `play`
};

}  // namespace trb::virtual_robots::ur
