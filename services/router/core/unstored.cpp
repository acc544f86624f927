#include "services/router/core/unstored.hpp"

namespace trb::router {

void Unstored::answered(Kept what, const Status& done, MonotonicTime now) {
  waiting_.erase(what);
  if (done) {
    failed_.erase(what);
    if (failed_.empty()) again_.reset();
    return;
  }
  failed_.insert_or_assign(what, done.error());
  if (!again_) again_ = now + kStoreAgain;
}

std::optional<Error> Unstored::update_failure() const {
  for (const Kept what : {Kept::update, Kept::certificate}) {
    const auto at = failed_.find(what);
    if (at == failed_.end()) continue;
    return fail(Errc::io_error, "in force until this router ends, but not on disk: " + at->second.what,
                (at->second.hint.empty() ? "" : at->second.hint + "; ") +
                    "it is tried again every 10 s, and trb service list shows until when it is not");
  }
  return std::nullopt;
}

std::string Unstored::note() const {
  if (failed_.empty()) return "";
  const Error& first = failed_.begin()->second;
  return "not on disk, and lost in a restart: " + first.what +
         (failed_.size() > 1 ? " (and " + std::to_string(failed_.size() - 1) + " more)" : "") +
         (first.hint.empty() ? "" : ": " + first.hint);
}

std::vector<Kept> Unstored::take_due(MonotonicTime now) {
  std::vector<Kept> due;
  if (!again_ || now < *again_) return due;
  again_ = now + kStoreAgain;
  for (const auto& [what, why] : failed_) due.push_back(what);
  return due;
}

}  // namespace trb::router
