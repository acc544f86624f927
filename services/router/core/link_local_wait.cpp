#include "services/router/core/link_local_wait.hpp"

namespace trb::router {
namespace {

bool is_link_local(const std::string& address) {
  return address.starts_with("fe80:");
}

}  // namespace

bool LinkLocalWait::takes(const std::string& found, const std::string& current, const std::string& wanted,
                          MonotonicTime now) {
  const bool fallen_back = is_link_local(found) && !is_link_local(current) && found != wanted;
  if (!fallen_back || (current.empty() && now >= until_)) return true;
  if (!current.empty()) until_ = now + kWait;
  return false;
}

}  // namespace trb::router
