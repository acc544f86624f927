// Hello: proven by certificate and key; of two links of one pair of nodes one stays.
#include <algorithm>

#include "common/base/address.hpp"
#include "common/base/saturate.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

void RouterCore::send_hello(Link& link, Now now, Effects& out) {
  if (link.hello_sent) return;
  link.hello_sent = true;
  link.own_address = config_.address;
  open_seals(link);
  const UtcTime utc = checked_utc(now.utc);
  const std::string_view seal = config_.seal_before_delivery ? kSealBeforeDelivery : kSealBehind;
  Hello hello{config_.certificate, config_.boot, config_.address,   config_.version,   utc.ns,
              utc == now.utc,      profile_,     news_.list.number, std::string(seal), relays(),
              config_.lane};
  link.profile = profile_number_;
  if (encode(hello).size() > kMaxHelloSize) {
    // A stranger's Hello is bounded; the profile follows when the link is up.
    hello.profile = {};
    link.profile = 0;
  }
  link_send(link, hello, out);
}

void RouterCore::tell_profile(Link& link, Effects& out) {
  if (link.profile == profile_number_) return;
  link.profile = profile_number_;
  link_send(link, profile_, out);
}

Result<Certificate> RouterCore::check_hello(const Link& link, const Message& message, const Hello& hello, Now now,
                                            Effects& out) {
  auto certificate = open_member(hello.certificate, now, out);
  if (!certificate) return certificate;
  if (certificate->link_key.bytes != link.key) {
    return fail(Errc::wrong_key,
                "certificate of '" + certificate->id + "' names another link key than the connection's",
                "its certificate.json belongs to other keys: trb fleet request and trb fleet sign there");
  }
  if (message.source != certificate->id) {
    return fail(Errc::source_mismatch,
                "Hello of '" + message.source + "' with the certificate of '" + certificate->id + "'",
                "a member that speaks under another's name: look at that computer");
  }
  if (hello.seal != kSealBehind && hello.seal != kSealBeforeDelivery) {
    return fail(
        Errc::downgraded,
        "Hello of '" + certificate->id + "' wants messages sealed '" + hello.seal + "', which is no way known here",
        "run the same version on both nodes: every link of a fleet is sealed");
  }
  if (certificate->id == config_.id) {
    return fail(Errc::duplicate, "another node is called '" + config_.id + "' too", "give each node its own id");
  }
  const auto known = peers_.find(certificate->id);
  if (known == peers_.end() && peers_.size() >= kMaxPeers)
    return fail(Errc::queue_full, "the routing table is full", std::string(kFullCure));
  if (Status newest = check_newest(*certificate); !newest) return newest.error();
  // Only a link that is up keeps an older boot out: who has the keys and says a boot that nothing can follow is rid of
  // with its link.
  const Link* up = known == peers_.end() ? nullptr : find_link(known->second.link);
  if (up != nullptr && up->key == link.key && up->boot > hello.boot) {
    return fail(Errc::conflict,
                "boot " + std::to_string(hello.boot) + " of '" + certificate->id + "' while its boot " +
                    std::to_string(up->boot) + " is linked",
                "two computers, or two copies of one node's folder, use the same keys: stop one; if its keys were "
                "stolen: trb fleet revoke");
  }
  for (const auto& [field, address] : {std::pair("address", hello.address), std::pair("lane", hello.lane)}) {
    if (Status numbers = check_address(field, address, certificate->id); !numbers) return numbers.error();
  }
  return certificate;
}

bool RouterCore::proves_name(const Link& link, const Message& message, const Hello& hello) const {
  const auto certificate = open_certificate_any_time(hello.certificate, config_.authority);
  return certificate && certificate->link_key.bytes == link.key && certificate->id == message.source;
}

Result<Hello> RouterCore::read_hello(LinkId id, const Message& message) {
  if (id == 0) return fail(Errc::malformed, "Hello without a link id");
  // A member's, too: nobody says more, for a profile that does not fit follows.
  if (message.data.size() > kMaxHelloSize) return fail(Errc::too_large, "Hello over 4 kB");
  return decode<Hello>(message.data);
}

/// A member makes a link now and then. One that says Hello without end has each signature checked, holds descriptors
/// and is told all the news each time: it stays out for a while, and has three links at most.
bool RouterCore::may_say_hello(LinkId id, BytesView key, Now now, Effects& out) {
  const auto name = peers_by_key_.find(key);
  if (name == peers_by_key_.end()) return true;
  Peer& peer = peers_.at(name->second);
  if (!peer.hellos.take(now.mono)) {
    out.count("refused.too_many_hellos");
    out.log(LogLevel::warning, "too_many_hellos",
            peer.id + " says Hello over " + std::to_string(kHellosOfOne) +
                " times in a second; its key stays out for a while");
    noisy_[Bytes(key)] = now.mono + config_.timing.denied;
    tell_candidate(id, Goodbye{"too many Hellos"}, out);
    return false;
  }
  std::vector<const Link*> waiting;
  for (const auto& [other, link] : links_) {
    if (!link.dialled && link.key == key && other != peer.link) waiting.push_back(&link);
  }
  if (waiting.size() < kSpareLinks) return true;
  const auto oldest = std::ranges::min_element(waiting, {}, &Link::opened);
  drop_link((*oldest)->id, "more links than one node makes", true, now, out);
  return true;
}

void RouterCore::on_other_version(LinkId id, BytesView key, std::uint8_t version, const HeaderView& header, Now now,
                                  Effects& out) {
  const auto known = peers_by_key_.find(key);
  std::string name = known == peers_by_key_.end() ? "" : known->second;
  if (name.empty() && header.subtype == Hello::kSubtype) {
    // A body only grows at its tail: what an older or newer Hello says of its certificate is read all the same.
    const auto hello = decode<Hello>(header.data);
    const auto certificate =
        hello ? open_certificate_any_time(hello->certificate, config_.authority) : Result<Certificate>(hello.error());
    if (certificate && certificate->link_key.bytes == key) name = certificate->id;
  }
  const std::string apart = "version " + std::to_string(kWireVersion) + " of the wire here, " + std::to_string(version);
  const std::string text = (name.empty() ? "a node that proves no name" : "'" + name + "'") +
                           " speaks another: " + apart +
                           " there; install the same version of talkrobots on both, then trb fleet renew";
  out.count("refused.version_mismatch");
  out.log(LogLevel::warning, "version_mismatch", text);
  troubles_.note(name, "", errc_name(Errc::version_mismatch), text, now.mono);
  if (links_.count(id) != 0) return drop_link(id, "version_mismatch: " + apart + " there", false, now, out);
  tell_candidate(header.link, Goodbye{"version_mismatch: " + apart + " there: install the same on both nodes"}, out,
                 version);
}

void RouterCore::on_second_link(LinkId id, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  out.count("refused.second_hello");
  out.log(LogLevel::warning, "second_hello", at->second.peer + " wants a second link on one connection");
  drop_link(id, "a second link on one connection", true, now, out);
}

void RouterCore::on_hello(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                          Effects& out) {
  const auto known = links_.find(id);
  const bool dialled = known != links_.end() && known->second.dialled && !known->second.up;
  if (known != links_.end() && !dialled) return out.count("refused.repeated_hello");
  if (!dialled && !may_say_hello(id, key, now, out)) return;
  Link fresh;
  fresh.id = id;
  fresh.key = key;
  fresh.opened = now.mono;
  auto hello = read_hello(id, message);
  auto certificate = hello ? check_hello(dialled ? known->second : fresh, message, *hello, now, out)
                           : Result<Certificate>(hello.error());
  if (!certificate) {
    if (hello) hand_news(id, dialled, message.source, certificate.error(), *hello, out);
    if (dialled) {
      note_trouble(id, errc_name(certificate.error().code), certificate.error().what, now);
    } else {
      // A name that is not proven is nobody's: a stranger could fill the table with names, or speak ill of a member.
      const std::string_view name = hello && proves_name(fresh, message, *hello) ? message.source : std::string_view();
      troubles_.note(name, "", errc_name(certificate.error().code), certificate.error().what, now.mono);
      return refuse_candidate(id, key, certificate.error(), now, out);
    }
    out.count("refused." + std::string(errc_name(certificate.error().code)));
    return drop_link(id, certificate.error().text(), false, now, out);
  }
  candidates_.erase(Bytes(key));
  if (!dialled) {
    links_.emplace(id, fresh);
    out.add(AcceptLink{id});
  }
  Link& link = links_.at(id);
  link.heard = sequence;
  make_peer(*certificate, hello->certificate);
  link_up(link, *certificate, *hello, now, out);
}

Peer& RouterCore::make_peer(const Certificate& certificate, const SignedRecord& record) {
  Peer& peer = peers_[certificate.id];
  if (peer.certificate.link_key != certificate.link_key) peers_by_key_.erase(peer.certificate.link_key.bytes);
  // Another computer under the same name counts its own boots and messages.
  const bool other =
      peer.certificate.identity_key != certificate.identity_key || peer.certificate.link_key != certificate.link_key;
  if (other) {
    peer.number = ++peer_count_;
    peer.beacon_boot = peer.beacon_count = 0;
    peer.by_relay = false;
    peer.relay_key.clear();
    peer.road = RelayRoad(config_.boot, {.lease = config_.timing.lease, .alive = config_.timing.keep_alive});
  }
  peer.id = certificate.id;
  peer.certificate = certificate;
  peer.certificate_record = record;
  peers_by_key_[certificate.link_key.bytes] = certificate.id;
  for (Seed& seed : seeds_) {
    if (seed.key == certificate.link_key.bytes) seed.peer = certificate.id;
  }
  return peer;
}

void RouterCore::link_up(Link& link, const Certificate& certificate, const Hello& hello, Now now, Effects& out) {
  Peer& peer = peers_.at(certificate.id);
  link.peer = certificate.id;
  link.boot = hello.boot;
  link.peer_address = hello.address;
  link.relay = hello.relay && certificate.relay;
  if (hello.clock_verified) link.utc_at_zero = saturating_sub(hello.utc, now.mono.ns);
  link.up = true;
  link.last_heard = now.mono;
  link.confirmed = now.mono;
  link.next_keep_alive = now.mono + config_.timing.keep_alive;
  send_hello(link, now, out);
  bind_seals(link, certificate, hello);
  const Link* old = find_link(peer.link);
  const bool same_place = old != nullptr && old->boot == link.boot && old->own_address == link.own_address &&
                          old->peer_address == link.peer_address;
  const bool in_doubt =
      same_place ? new_link_wins(*old, link, own_is_smaller(peer.id)) : old == nullptr && dialling(link.key);
  if (!link.dialled && in_doubt) {
    link.waiting = hello;
    return;
  }
  carry_by(link, hello, now, out);
}

void RouterCore::carry_by(Link& link, const Hello& hello, Now now, Effects& out) {
  Peer& peer = peers_.at(link.peer);
  const LinkId id = link.id;
  if (peer.link != 0 && !settle_double(link, peer, now, out)) return;
  const bool again = peer.boot == hello.boot && peer.met && !peer.expired;
  peer.boot = hello.boot;
  if (peer.beacon_boot > hello.boot) peer.beacon_boot = peer.beacon_count = 0;
  if (peer.address != hello.address || links_.at(id).dialled) next_store_ = now.mono + kStorePause;
  if (links_.at(id).dialled && is_numeric_endpoint(links_.at(id).address)) peer.good_address = links_.at(id).address;
  peer.address = hello.address;
  peer.version = hello.version;
  peer.clock_verified = hello.clock_verified;
  peer.profile = hello.profile;
  peer.link = id;
  peer.met = true;
  note_up(links_.at(id), hello, now);
  peer.expired = false;
  peer.lost.reset();
  peer.redial = {};
  out.log(LogLevel::info, "peer_joined",
          peer.id + " at " + peer.address + ", boot " + std::to_string(peer.boot) +
              (links_.at(id).dialled ? ", dialled by this node" : ", dialled by it"));
  if (!again) tell_services(PeerJoined{peer.id, peer.boot}, out);
  tell_profile(links_.at(id), out);
  find_lane(links_.at(id), hello, now);
  forget_told_renewal(peer.certificate);
  forget_ended_renewals(now);
  tell_news(links_.at(id), hello.revocations, now, out);
  tell_all_neighbours(links_.at(id), out);
  neighbour_changed(peer.id, now);
}

bool RouterCore::settle_double(Link& link, Peer& peer, Now now, Effects& out) {
  const auto old = links_.find(peer.link);
  if (old == links_.end() || new_link_wins(old->second, link, own_is_smaller(peer.id))) {
    const LinkId gone = peer.link;
    peer.link = 0;
    drop_link(gone, "a better link to " + peer.id + " came up", true, now, out);
    return true;
  }
  drop_link(link.id, "a better link to " + peer.id + " is up", true, now, out);
  return false;
}

void RouterCore::refuse_candidate(LinkId id, BytesView key, const Error& error, Now now, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "candidate_refused", error.text());
  if (!is_expected(key)) {
    candidates_.erase(Bytes(key));
    if (denied_.size() < 8 * kMaxCandidates) denied_[Bytes(key)] = now.mono + config_.timing.denied;
  }
  tell_candidate(id, Goodbye{std::string(errc_name(error.code))}, out);
}

void RouterCore::tell_candidate(LinkId id, const Body& body, Effects& out, std::uint8_t version) {
  if (auto message = make_own("", 0, body, out)) out.add(RefuseCandidate{id, std::move(*message), version});
}

void RouterCore::hand_news(LinkId id, bool dialled, const std::string& to, const Error& refusal, const Hello& hello,
                           Effects& out) {
  const auto news = news_for(refusal, hello);
  if (!news) return;
  if (!dialled) return tell_candidate(id, *news, out);
  // For the other side the link is up: its router takes what names it as the target.
  Link& link = links_.at(id);
  link.peer = to;
  link_send(link, *news, out);
}

}  // namespace trb::router
