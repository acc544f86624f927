#include "services/router/core/tell_again.hpp"

#include <algorithm>
#include <vector>

namespace trb::router {
namespace {

/// A list of the revoked has half a megabyte: a thousand copies at once would take what the whole node has.
constexpr std::size_t kMostAtOnce = 32;

}  // namespace

std::optional<TellAgain::What> TellAgain::what_is(std::string_view subtype) {
  if (subtype == NodeProfile::kSubtype) return What::profile;
  if (subtype == TrustUpdate::kSubtype) return What::updates;
  if (subtype == ReachablePeerList::kSubtype) return What::neighbours;
  return std::nullopt;
}

void TellAgain::on_unsent(const Message& message, Now now) {
  const auto what = what_is(message.subtype);
  const Peer* peer = what ? std::as_const(table_).find(message.target) : nullptr;
  if (peer == nullptr || peer->link == 0) return;
  const Untold untold{peer->link, *what};
  auto& slot = slots_[untold];
  if (!slot) due_.set(untold, slot, now.mono + kTellAgain);
}

/// Who was not told for the longest time comes first: those whose links stay full keep nobody waiting.
void TellAgain::tick(Now now, Effects& out) {
  std::vector<Untold> due = due_.due(now.mono);
  due.resize(std::min(due.size(), kMostAtOnce));
  for (const Untold& untold : due) {
    due_.set(untold, slots_.at(untold), std::nullopt);
    slots_.erase(untold);
    if (Link* link = table_.link(untold.first)) tell(*link, untold.second, now, out);
  }
}

void TellAgain::tell(Link& link, What what, Now now, Effects& out) {
  out.count("told_again");
  switch (what) {
    case What::profile:
      link.profile = 0;
      return profile_.send(link, out);
    case What::updates:
      return updates_.send_known(link, 0, now, out);
    case What::neighbours:
      return reachable_.notify_anew(link, out);
  }
}

}  // namespace trb::router
