#include "services/router/core/pending_requests.hpp"

namespace trb::router {

void PendingRequests::note(std::uint64_t id, bool question, Party whom) {
  if (question) {
    questions_.note({id, whom});
  } else {
    words_.note({id, whom});
  }
}

bool PendingRequests::may_answer(std::uint64_t id, bool nack, Party from) const {
  if (from == Party::nobody || id == 0) return false;
  if (const auto* question = questions_.find(id)) return question->whom == from;
  const auto* word = nack ? words_.find(id) : nullptr;
  return word != nullptr && word->whom == from;
}

}  // namespace trb::router
