#include "services/router/core/sent_requests.hpp"

namespace trb::router {

void SentRequests::note(std::uint64_t id, bool wants_answer, Party whom) {
  if (wants_answer) {
    requests_.note({id, whom});
  } else {
    informations_.note({id, whom});
  }
}

bool SentRequests::may_answer(std::uint64_t id, bool nack, Party from) const {
  if (from == Party::nobody || id == 0) return false;
  if (const auto* request = requests_.find(id)) return request->whom == from;
  const auto* information = nack ? informations_.find(id) : nullptr;
  return information != nullptr && information->whom == from;
}

}  // namespace trb::router
