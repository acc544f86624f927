#include "services/router/core/trust_updates.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {

Result<std::string> TrustUpdates::on_update(const TrustUpdate& update, LinkId from, Now now, Effects& out) {
  // Whatever comes may be older than what was stored, and would take its place.
  if (const auto& lost = node_.config().updates_lost)
    return fail(Errc::io_error, "what was signed before is not known: " + lost->what, lost->hint);
  const Link* link = table_.link(from);
  Peer* teller = link == nullptr ? nullptr : table_.find(link->peer);
  TakenUpdate taken = trust_.take(update, teller == nullptr ? nullptr : &teller->update_checks, now, out);
  if (taken.own_renewed) {
    membership_.on_renewed();
    unstored_.add(Kept::certificate);
  }
  if (taken.is_empty()) {
    if (taken.refusal && (taken.must_be_told || !taken.known)) return *taken.refusal;
    return std::string("nothing new");
  }
  store(out);
  const std::size_t others = pass_on(taken.fresh, from, out);
  const bool list = !taken.fresh.revocations.kind.empty();
  if (list) {
    membership_.apply_revocations(now, out);
    bus_.notify(trust_.revoked_nodes(), out);
  }
  membership_.check_own(now, out);
  for (const std::string& id : taken.relay_changed) membership_.on_relay_right(id, now, out);
  if (taken.must_be_told) return *taken.refusal;
  return (list ? "list " + std::to_string(trust_.list_number()) + ", " : std::string()) +
         std::to_string(taken.fresh.certificates.size()) + " renewed certificates, told to " + std::to_string(others) +
         " nodes";
}

void TrustUpdates::on_file(const TrustUpdate& update, Now now, Effects& out) {
  auto taken = on_update(update, 0, now, out);
  // An old file that was left there is no attack.
  if (!taken && taken.error().code != Errc::downgraded) refuse("a file", taken.error(), out);
}

void TrustUpdates::on_brought(const std::string& path, const Result<TrustUpdate>& read, Now now, Effects& out) {
  refused_files_.erase(path);
  if (node_.config().updates_lost) return;  // the next start reads it
  const auto taken = read ? on_update(*read, 0, now, out) : Result<std::string>(read.error());
  if (taken || taken.error().code == Errc::downgraded) return;
  refuse(path, taken.error(), out);
  // Of a file that was left there the certificates end, and nobody need do anything.
  if (taken.error().code == Errc::cert_expired || taken.error().code == Errc::cert_revoked) return;
  // Whoever reads a file names it in the error; whoever checks what is in it does not.
  const Error why =
      read ? fail(taken.error().code, path + ": " + taken.error().what, taken.error().hint) : read.error();
  refused_files_.insert_or_assign(path, why);
}

void TrustUpdates::refuse(const std::string& path, const Error& why, Effects& out) {
  out.count("refused." + std::string(errc_name(why.code)));
  out.log(LogLevel::warning, "news_refused", "of " + path + ": " + why.text());
}

std::string TrustUpdates::note() const {
  std::string out = unstored_.note();
  for (const auto& [path, why] : refused_files_) {
    out += (out.empty() ? "not in force: " : "; not in force: ") + why.what + (why.hint.empty() ? "" : ": " + why.hint);
  }
  return out;
}

void TrustUpdates::on_bus_request(ConnectionId from, const Message& message, const TrustUpdate& update, Now now,
                                  Effects& out) {
  auto taken = on_update(update, 0, now, out);
  if (!taken) return bus_.deny(from, message, taken.error(), out);
  // It may be known already, and not be on disk.
  if (!unstored_.waits() && unstored_.update_failure()) store(out);
  if (!unstored_.waits()) return bus_.answer(from, message, Ack{"accepted", *taken}, out);
  if (waiting_.size() >= kMaxWaiting)
    return bus_.deny(from, message,
                     fail(Errc::queue_full, "in force, but whether it is on disk is not known yet", "try again"), out);
  waiting_.push_back({from, message, std::move(*taken)});
  waiting_.back().request.data.clear();
}

void TrustUpdates::on_stored(Kept what, const Status& done, Now now, Effects& out) {
  if (!done) {
    out.count("not_stored");
    out.log(LogLevel::error, "not_stored", done.error().text());
  }
  unstored_.answered(what, done, now.mono);
  if (unstored_.waits()) return;
  const auto failure = unstored_.update_failure();
  for (const Waiting& one : std::exchange(waiting_, {})) {
    if (failure) {
      bus_.deny(one.from, one.request, *failure, out);
    } else {
      bus_.answer(one.from, one.request, Ack{"accepted", one.text}, out);
    }
  }
}

void TrustUpdates::tick(Now now, Effects& out) {
  for (const Kept what : unstored_.take_due(now.mono)) {
    if (what == Kept::update) {
      store(out);
      continue;
    }
    unstored_.add(what);
    out.add(what == Kept::boot ? Effect(StoreBoot{node_.config().boot})
                               : Effect(StoreCertificate{node_.config().certificate}));
  }
}

std::size_t TrustUpdates::pass_on(const TrustUpdate& fresh, LinkId from, Effects& out) {
  std::size_t told = 0;
  for (const LinkId id : table_.up_links()) {
    if (id == from) continue;
    send(*table_.link(id), fresh, out);
    ++told;
  }
  return told;
}

void TrustUpdates::send_known(const Link& link, std::uint64_t known_list, Now now, Effects& out) {
  const TrustUpdate update = trust_.for_peer(known_list, now);
  if (!update.revocations.kind.empty() || !update.certificates.empty()) send(link, update, out);
}

/// Splits it into messages that the receiver accepts: the list first, certificates apart from it if necessary.
void TrustUpdates::send(const Link& link, const TrustUpdate& update, Effects& out) {
  if (encode(update).size() <= kMaxUpdate) return messages_.send(link, update, out);
  if (!update.revocations.kind.empty()) messages_.send(link, TrustUpdate{update.revocations, {}}, out);
  TrustUpdate part;
  std::size_t size = 0;
  for (const SignedRecord& record : update.certificates) {
    const std::size_t more = encode(record).size();
    if (size + more > kMaxUpdate / 2 && !part.certificates.empty()) {
      messages_.send(link, std::exchange(part, {}), out);
      size = 0;
    }
    part.certificates.push_back(record);
    size += more;
  }
  if (!part.certificates.empty()) messages_.send(link, part, out);
}

/// Who has not said Hello has no budget: of its certificates one is checked, this node's.
void TrustUpdates::keep_own(TrustUpdate& update) const {
  const auto is_own = [&](const SignedRecord& record) {
    const auto shown = decode<Certificate>(record.payload.bytes);
    return shown && shown->id == node_.id();
  };
  const auto own = std::find_if(update.certificates.begin(), update.certificates.end(), is_own);
  update.certificates = own == update.certificates.end() ? std::vector<SignedRecord>{} : std::vector{*own};
}

void TrustUpdates::on_link_message(const Link& link, const Message& message, Now now, Effects& out) {
  auto update = message.data.size() > kMaxUpdate ? Result<TrustUpdate>(fail(Errc::too_large, "TrustUpdate over 512 kB"))
                                                 : decode<TrustUpdate>(message.data);
  if (update && link.peer.empty()) keep_own(*update);
  if (Peer* peer = table_.find(link.peer); peer != nullptr && !peer->updates.take(now.mono))
    return out.count("refused.too_much_news");
  // The link may be gone before the refusal is noted: the list itself may end it.
  const std::string who = link.peer.empty() ? "the node that was dialled" : link.peer;
  auto taken = update ? on_update(*update, link.id, now, out) : Result<std::string>(update.error());
  if (taken) return;
  out.count("refused." + std::string(errc_name(taken.error().code)));
  out.log(LogLevel::warning, "news_refused", "of " + who + ": " + taken.error().text());
}

void TrustUpdates::store(Effects& out) {
  unstored_.add(Kept::update);
  out.add(trust_.to_store(out));
}

}  // namespace trb::router
