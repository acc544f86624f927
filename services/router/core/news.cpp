// News of the fleet's authority: who is out, whose certificate was renewed. Any road may bring it, for it is signed;
// what is new is stored, done, and told to every other link.
#include <algorithm>

#include "common/security/revocations.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

Result<std::string> RouterCore::on_news(const FleetNews& news, LinkId from, Now now, Effects& out) {
  FleetNews fresh;
  std::optional<Error> refusal;
  const Link* link = find_link(from);
  const auto teller = link == nullptr ? peers_.end() : peers_.find(link->peer);
  // A signature costs 50 us to check: what one member tells costs this node no more than so many in a second.
  const auto may_check = [&] { return teller == peers_.end() || teller->second.news_checks.take(now.mono); };
  const auto sort_out = [&](const Status& taken) {
    if (!taken && !refusal) refusal = taken.error();
    return taken.ok();
  };
  const bool lists = !news.revocations.kind.empty() && news.revocations != news_.record;
  bool known = !news.revocations.kind.empty() && !lists;
  if (lists && may_check() && sort_out(take_list(news.revocations, now, out))) fresh.revocations = news.revocations;
  const bool no_list = refusal.has_value();  // what else is known or new must not hide that
  for (const SignedRecord& record : news.certificates) {
    if (is_known_certificate(record)) {
      known = true;
      continue;
    }
    if (!may_check()) {
      refusal = fail(Errc::queue_full, "over " + std::to_string(kNewsChecked) + " signatures in a second");
      break;
    }
    if (sort_out(take_certificate(record, now, out))) fresh.certificates.push_back(record);
    // Who brings one that is forged brings more: a message of 256 would cost as many checks.
    if (refusal && refusal->code == Errc::bad_signature) break;
  }
  if (fresh.revocations.kind.empty() && fresh.certificates.empty()) {
    if (refusal && (no_list || !known)) return *refusal;
    return std::string("nothing new");
  }
  store_news(out);
  const std::size_t others = flood_news(fresh, from, out);
  if (!fresh.revocations.kind.empty()) apply_revocations(now, out);
  check_own(now, out);
  if (no_list) return *refusal;
  std::string text = fresh.revocations.kind.empty() ? "" : "list " + std::to_string(news_.list.number) + ", ";
  return text + std::to_string(fresh.certificates.size()) + " renewed certificates, told to " + std::to_string(others) +
         " nodes";
}

void RouterCore::on_news_of_file(const FleetNews& news, Now now, Effects& out) {
  auto taken = on_news(news, 0, now, out);
  // An old file that was left there is no attack.
  if (taken || taken.error().code == Errc::downgraded) return;
  out.count("refused." + std::string(errc_name(taken.error().code)));
  out.log(LogLevel::warning, "news_refused", "of a file: " + taken.error().text());
}

/// The very record that is held already; its signature was checked.
bool RouterCore::is_known_certificate(const SignedRecord& record) const {
  if (record == config_.certificate) return true;
  const auto shown = decode<Certificate>(record.payload.bytes);
  if (!shown) return false;
  const auto peer = peers_.find(shown->id);
  if (peer != peers_.end() && record == peer->second.certificate_record) return true;
  const auto renewed = news_.renewed.find(shown->id);
  return renewed != news_.renewed.end() && record == renewed->second;
}

Status RouterCore::take_list(const SignedRecord& record, Now now, Effects& out) {
  auto list = open_revocations(record, config_.authority);
  if (!list) return list.error();
  if (list->number < std::max<std::uint64_t>(news_.list.number, 1)) {
    return fail(Errc::downgraded,
                "revocation list " + std::to_string(list->number) + "; list " + std::to_string(news_.list.number) +
                    " is in force",
                "bring news.json as it is now in the authority's folder");
  }
  if (list->number == news_.list.number) {
    return fail(Errc::conflict, "another revocation list with number " + std::to_string(list->number),
                "the authority's folder was put back to an older copy: revoke once more, so that the number rises");
  }
  // A list is taken whatever the clock says: to believe it is to do less.
  if (checked_utc(now.utc) != now.utc) raise_utc_bound({list->issued}, out);
  out.log(LogLevel::warning, "revocations",
          "list " + std::to_string(list->number) + " of " + to_iso8601({list->issued}) + ": " +
              std::to_string(list->revoked.size()) + " revoked, beacon key " + std::to_string(list->beacon_number));
  out.count("news.lists");
  news_.record = record;
  news_.list = std::move(*list);
  return Done{};
}

Status RouterCore::take_certificate(const SignedRecord& record, Now now, Effects& out) {
  auto certificate = open_member(record, now, out);
  if (!certificate) return certificate.error();
  const bool own = certificate->id == config_.id;
  const auto peer = peers_.find(certificate->id);
  if (Status newest = check_newest(*certificate); !newest) return newest.error();
  if (own && (certificate->identity_key != config_.own.identity_key || certificate->link_key != config_.own.link_key)) {
    return fail(Errc::wrong_key, "a certificate of '" + config_.id + "' for other keys than this node's",
                "have this node's own request signed: trb fleet request, trb fleet sign");
  }
  if (own && certificate->role != config_.role) {
    // The services were started for the other role, and the next start would compare it with node.json.
    return fail(Errc::bad_value,
                "a certificate of '" + config_.id + "' with the role " + std::string(name_of(certificate->role)) +
                    "; it runs as " + std::string(name_of(config_.role)),
                "set role in node.json, put that certificate.json into keys/ and run trb reload");
  }
  out.count("news.certificates");
  if (own) {
    take_own_certificate(record, *certificate, out);
    return Done{};
  }
  if (news_.renewed.size() >= kMaxPeers && news_.renewed.count(certificate->id) == 0)
    return fail(Errc::queue_full, "no room for another node's renewed certificate", std::string(kFullCure));
  news_.renewed[certificate->id] = record;
  // A link stays up through it: the keys are the same, the end is later.
  const bool same = peer != peers_.end() && peer->second.certificate.identity_key == certificate->identity_key &&
                    peer->second.certificate.link_key == certificate->link_key;
  if (same) {
    peer->second.certificate = *certificate;
    peer->second.certificate_record = record;
  }
  return Done{};
}

void RouterCore::take_own_certificate(const SignedRecord& record, const Certificate& certificate, Effects& out) {
  config_.certificate = record;
  config_.own = certificate;
  news_.warned.reset();
  out.log(LogLevel::info, "certificate_renewed",
          "serial " + std::to_string(certificate.serial) + ", to " + to_iso8601({certificate.not_after}));
  unstored_.asked(Kept::certificate);
  out.add(StoreCertificate{record});
}

FleetNews RouterCore::known_news() const {
  FleetNews news{news_.record, {}};
  for (const auto& [id, record] : news_.renewed) {
    constexpr std::size_t kMost = 256;
    if (news.certificates.size() < kMost) news.certificates.push_back(record);
  }
  return news;
}

void RouterCore::store_news(Effects& out) {
  StoreNews store{known_news(), news_.list.beacon_number, {}};
  for (const SealedKey& sealed : news_.list.beacon_keys) {
    if (sealed.id == config_.id) store.beacon_box = sealed.box.bytes;
  }
  const bool staying = !news_.record.kind.empty() && find_revocation(news_.list, config_.own) == nullptr;
  if (staying && store.beacon_box.empty()) {
    out.log(LogLevel::warning, "no_beacon_key",
            "list " + std::to_string(news_.list.number) + " has no beacon key for this node: trb fleet sign it again");
  }
  unstored_.asked(Kept::news);
  out.add(std::move(store));
}

void RouterCore::answer_news(ConnectionId from, const Message& message, const FleetNews& news, Now now, Effects& out) {
  auto taken = on_news(news, 0, now, out);
  if (!taken) return deny(from, message, taken.error(), out);
  // It may be known already, and not on disk.
  if (!unstored_.waits() && unstored_.news_failure()) store_news(out);
  if (!unstored_.waits()) return answer(from, message, Ack{"accepted", *taken}, out);
  if (askers_.size() >= kMaxAskers)
    return deny(from, message,
                fail(Errc::queue_full, "in force, but whether it is on disk is not known yet", "try again"), out);
  askers_.push_back({from, message, std::move(*taken)});
  askers_.back().message.data.clear();
}

void RouterCore::on_stored(Kept what, const Status& done, Now now, Effects& out) {
  if (!done) {
    out.count("not_stored");
    out.log(LogLevel::error, "not_stored", done.error().text());
  }
  unstored_.answered(what, done, now.mono);
  if (unstored_.waits()) return;
  const auto failure = unstored_.news_failure();
  for (const Asker& asker : std::exchange(askers_, {})) {
    if (failure) {
      deny(asker.from, asker.message, *failure, out);
    } else {
      answer(asker.from, asker.message, Ack{"accepted", asker.text}, out);
    }
  }
}

void RouterCore::tick_unstored(Now now, Effects& out) {
  for (const Kept what : unstored_.take_due(now.mono)) {
    if (what == Kept::news) {
      store_news(out);
      continue;
    }
    unstored_.asked(what);
    out.add(what == Kept::boot ? Effect(StoreBoot{config_.boot}) : Effect(StoreCertificate{config_.certificate}));
  }
}

std::size_t RouterCore::flood_news(const FleetNews& fresh, LinkId from, Effects& out) {
  std::size_t told = 0;
  for (const LinkId id : up_links()) {
    if (id == from) continue;
    send_news(links_.at(id), fresh, out);
    ++told;
  }
  return told;
}

void RouterCore::tell_news(Link& link, std::uint64_t known_list, Now now, Effects& out) {
  FleetNews news = known_news();
  std::erase_if(news.certificates, [&](const SignedRecord& record) { return has_ended(record, now); });
  if (news_.list.number <= known_list) news.revocations = {};
  if (!news.revocations.kind.empty() || !news.certificates.empty()) send_news(link, news, out);
}

/// In messages that their hearer takes: the list first, certificates apart from it if need be.
void RouterCore::send_news(Link& link, const FleetNews& news, Effects& out) {
  if (encode(news).size() <= kMaxNews) return link_send(link, news, out);
  if (!news.revocations.kind.empty()) link_send(link, FleetNews{news.revocations, {}}, out);
  FleetNews part;
  std::size_t size = 0;
  for (const SignedRecord& record : news.certificates) {
    const std::size_t more = encode(record).size();
    if (size + more > kMaxNews / 2 && !part.certificates.empty()) {
      link_send(link, std::exchange(part, {}), out);
      size = 0;
    }
    part.certificates.push_back(record);
    size += more;
  }
  if (!part.certificates.empty()) link_send(link, part, out);
}

void RouterCore::on_news_message(const Link& link, const Message& message, Now now, Effects& out) {
  auto news = message.data.size() > kMaxNews ? Result<FleetNews>(fail(Errc::too_large, "FleetNews over 512 kB"))
                                             : decode<FleetNews>(message.data);
  if (const auto peer = peers_.find(link.peer); peer != peers_.end() && !peer->second.news.take(now.mono))
    return out.count("refused.too_much_news");
  // It may be gone before the refusal is written down: the list may say so.
  const std::string who = link.peer.empty() ? "the node that was dialled" : link.peer;
  auto taken = news ? on_news(*news, link.id, now, out) : Result<std::string>(news.error());
  if (taken) return;
  out.count("refused." + std::string(errc_name(taken.error().code)));
  out.log(LogLevel::warning, "news_refused", "of " + who + ": " + taken.error().text());
}

std::optional<FleetNews> RouterCore::news_for(const Error& refusal, const Hello& hello) const {
  if (refusal.code == Errc::cert_revoked) {
    // It may not know yet. One that says it does is not told again.
    return hello.revocations < news_.list.number ? std::optional(FleetNews{news_.record, {}}) : std::nullopt;
  }
  if (refusal.code != Errc::downgraded && refusal.code != Errc::cert_expired) return std::nullopt;
  const auto shown = decode<Certificate>(hello.certificate.payload.bytes);
  if (!shown) return std::nullopt;
  const auto peer = peers_.find(shown->id);
  const auto renewed = news_.renewed.find(shown->id);
  if (renewed != news_.renewed.end()) return FleetNews{{}, {renewed->second}};
  if (peer != peers_.end() && peer->second.certificate.serial > shown->serial)
    return FleetNews{{}, {peer->second.certificate_record}};
  return std::nullopt;
}

bool RouterCore::has_ended(const SignedRecord& renewal, Now now) const {
  const auto renewed = decode<Certificate>(renewal.payload.bytes);
  return !renewed || renewed->not_after <= checked_utc(now.utc).ns;
}

void RouterCore::forget_ended_renewals(Now now) {
  // By a clock that is far ahead for a moment all have ended.
  if (clock_.is_steady(now)) std::erase_if(news_.renewed, [&](const auto& row) { return has_ended(row.second, now); });
}

void RouterCore::forget_told_renewal(const Certificate& certificate) {
  const auto at = news_.renewed.find(certificate.id);
  if (at == news_.renewed.end()) return;
  const auto renewed = decode<Certificate>(at->second.payload.bytes);
  if (!renewed || renewed->serial <= certificate.serial) news_.renewed.erase(at);
}

}  // namespace trb::router
