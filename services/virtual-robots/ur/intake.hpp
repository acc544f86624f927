#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::ur {

/** Splits the bytes of one client into the controller's input: whole programs and single lines. */
class Intake {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{64} * 1024;
  static constexpr std::size_t kLongestProgram = std::size_t{1024} * 1024;

  /** The scripts that have become complete, in order. */
  std::vector<std::string> take(std::string_view bytes);

  /** Why the client must be dropped: `line_too_long` or `program_too_long`; empty: no fault. */
  const std::string& fault() const { return fault_; }

 private:
  void take_line(std::vector<std::string>& scripts);

  std::string line_;
  std::string program_;
  std::string fault_;
};

}  // namespace trb::virtual_robots::ur
