#include "services/router/io/sent_counter.hpp"

namespace trb::router {
namespace {

constexpr std::size_t kMaxCounted = 500;

}  // namespace

void SentCounter::count(std::string_view subtype) {
  auto at = names_.find(subtype);
  if (at == names_.end()) {
    if (names_.size() >= kMaxCounted) return;
    at = names_.emplace(subtype, "sent." + std::string(subtype)).first;
  }
  counters_.count(at->second);
}

}  // namespace trb::router
