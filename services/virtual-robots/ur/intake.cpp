#include "services/virtual-robots/ur/intake.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

bool is_end(std::string_view line) {
  return line.starts_with("end") && trim(line.substr(0, line.find('#'))) == "end";
}

bool opens_program(std::string_view line) {
  return line.starts_with("def ") || line.starts_with("sec ");
}

}  // namespace

std::vector<std::string> Intake::take(std::string_view bytes) {
  std::vector<std::string> scripts;
  while (!bytes.empty() && fault_.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view piece = bytes.substr(0, end);
    if (line_.size() + piece.size() > kLongestLine) {
      fault_ = "line_too_long";
      break;
    }
    line_ += piece;
    if (end == std::string_view::npos) break;
    bytes.remove_prefix(end + 1);
    take_line(scripts);
  }
  return scripts;
}

void Intake::take_line(std::vector<std::string>& scripts) {
  if (line_.ends_with('\r')) line_.pop_back();
  if (program_.empty() && !opens_program(line_)) {
    const std::string_view statement = trim(std::string_view(line_));
    if (!statement.empty() && statement.front() != '#') scripts.push_back(line_);
  } else if (program_.size() + line_.size() + 1 > kLongestProgram) {
    fault_ = "program_too_long";
  } else {
    program_ += program_.empty() ? line_ : "\n" + line_;
    if (is_end(line_)) {
      scripts.push_back(std::move(program_));
      program_.clear();
    }
  }
  line_.clear();
}

}  // namespace trb::virtual_robots::ur
