#include "common/drivers/c3/flag.hpp"

namespace trb::drivers {

void C3Flag::on_raised(C3Link& link, Now now, const DriverOut& out) {
  if (busy_) return;
  busy_ = true;
  values_.clear();
  for (const std::string& part : parts_) {
    if (!part.empty()) link.ask({C3Purpose::part, part, std::nullopt, mark_}, now, out);
  }
  link.ask({C3Purpose::clear, flag_, "FALSE", mark_}, now, out);
}

std::vector<std::string> C3Flag::on_cleared() {
  busy_ = false;
  std::vector<std::string> values;
  std::size_t read = 0;
  for (const std::string& part : parts_) {
    const bool there = !part.empty() && read < values_.size();
    values.push_back(there ? std::move(values_[read++]) : std::string());
  }
  return values;
}

}  // namespace trb::drivers
