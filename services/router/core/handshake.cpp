#include "services/router/core/handshake.hpp"

#include <algorithm>

#include "common/base/address.hpp"
#include "common/base/saturate.hpp"

namespace trb::router {
namespace {

Link fresh_link(LinkId id, BytesView key, MonotonicTime opened) {
  Link link;
  link.id = id;
  link.key = key;
  link.opened = opened;
  return link;
}

}  // namespace

void Handshake::on_dial_connected(LinkId link, Now now, Effects& out) {
  if (Link* known = table_.link(link)) send_hello(*known, now, out);
}

void Handshake::send_hello(Link& link, Now now, Effects& out) {
  if (link.hello_sent) return;
  const RouterConfig& own = node_.config();
  link.hello_sent = true;
  link.own_address = own.address;
  seals_.open(link);
  const UtcTime utc = node_.checked_utc(now.utc);
  const std::string_view seal = own.seal_before_delivery ? kSealBeforeDelivery : kSealBehind;
  Hello hello{own.certificate, own.boot,           own.address,          own.version,       utc.ns,
              utc == now.utc,  profile_.profile(), trust_.list_number(), std::string(seal), node_.relays(),
              own.lane};
  link.profile = profile_.number();
  if (encode(hello).size() > kMaxHelloSize) {
    // A stranger's Hello is bounded; the profile follows when the link is up.
    hello.profile = {};
    link.profile = 0;
  }
  messages_.send(link, hello, out);
}

Result<Hello> Handshake::read(LinkId id, const Message& message) {
  if (id == 0) return fail(Errc::malformed, "Hello without a link id");
  // The same for a member's: no Hello is larger, since a profile that does not fit is sent later.
  if (message.data.size() > kMaxHelloSize) return fail(Errc::too_large, "Hello over 4 kB");
  return decode<Hello>(message.data);
}

Result<Certificate> Handshake::check(const Link& link, const Message& message, const Hello& hello, Now now,
                                     Effects& out) {
  auto certificate = trust_.open_member(hello.certificate, now, out);
  if (!certificate && certificate.error().code == Errc::cert_revoked)
    trust_.remember_presented(hello.certificate, link.key);
  if (!certificate) return certificate;
  if (Status good = check_claims(link, message, hello, *certificate); !good) return good.error();
  if (Status good = check_known(link, hello, *certificate); !good) {
    if (good.error().code == Errc::conflict) look_for_older(link, hello, *certificate, now, out);
    return good.error();
  }
  for (const auto& [field, address] : {std::pair("address", hello.address), std::pair("lane", hello.lane)}) {
    if (Status numbers = check_address(field, address, certificate->id); !numbers) return numbers.error();
  }
  return certificate;
}

/// Does the Hello speak for its own sender, on its own connection, in a version that is known here?
Status Handshake::check_claims(const Link& link, const Message& message, const Hello& hello,
                               const Certificate& certificate) const {
  if (certificate.link_key.bytes != link.key) {
    return fail(Errc::wrong_key, "certificate of '" + certificate.id + "' names another link key than the connection's",
                "its certificate.json belongs to other keys: trb fleet request and trb fleet sign there");
  }
  if (message.source != certificate.id) {
    return fail(Errc::source_mismatch,
                "Hello of '" + message.source + "' with the certificate of '" + certificate.id + "'",
                "a member that speaks under another's name: look at that computer");
  }
  if (hello.seal != kSealBehind && hello.seal != kSealBeforeDelivery) {
    return fail(
        Errc::downgraded,
        "Hello of '" + certificate.id + "' wants messages sealed '" + hello.seal + "', which is no way known here",
        "run the same version on both nodes: every link of a fleet is sealed");
  }
  if (certificate.id != node_.id()) return Done{};
  return fail(Errc::duplicate, "another node is called '" + node_.id() + "' too", "give each node its own id");
}

/// Does the Hello agree with what is known about that node?
Status Handshake::check_known(const Link& link, const Hello& hello, const Certificate& certificate) const {
  if (!table_.has_room_for(certificate.id))
    return fail(Errc::queue_full, "the routing table is full", std::string(kFullCure));
  if (Status newest = trust_.check_newest(certificate); !newest) return newest;
  // Only a link that is up keeps an older boot out: a thief of the keys that sends the highest possible boot is out
  // once its link is.
  const Peer* known = table_.find(certificate.id);
  const Link* up = known == nullptr ? nullptr : table_.link(known->link);
  if (up == nullptr || up->key != link.key || up->boot <= hello.boot) return Done{};
  return fail(Errc::conflict,
              "boot " + std::to_string(hello.boot) + " of '" + certificate.id + "' while its boot " +
                  std::to_string(up->boot) + " is linked",
              "two computers, or two copies of one node's folder, use the same keys: stop one; if its keys were "
              "stolen: trb fleet revoke");
}

/// Only that both live tells a copy from a node that was started again.
void Handshake::look_for_older(const Link& link, const Hello& hello, const Certificate& certificate, Now now,
                               Effects& out) {
  const Link& up = *table_.link(table_.find(certificate.id)->link);
  if (shared_.on_older(certificate.id, link.key, hello.boot, up.last_heard, now.mono))
    tell_shared(certificate, {up.boot, up.peer_address}, {hello.boot, hello.address}, now, out);
}

void Handshake::tell_shared(const Certificate& certificate, const NodeStart& one, const NodeStart& other, Now now,
                            Effects& out) {
  const std::string text = "two computers use the keys of '" + certificate.id + "' (certificate serial " +
                           std::to_string(certificate.serial) + "): start " + std::to_string(one.boot) +
                           ", which says it is at " + one.address + ", and start " + std::to_string(other.boot) +
                           ", which says it is at " + other.address;
  out.count("shared_keys");
  out.log(LogLevel::error, std::string(kSharedKeys),
          text +
              "; if its keys were stolen: trb fleet revoke, new keys, and look at its robot, which may not have "
              "got its orders");
  errors_.note(certificate.id, "", kSharedKeys, text, now);
}

bool Handshake::proves_name(const Link& link, const Message& message, const Hello& hello) const {
  const auto certificate = open_certificate_any_time(hello.certificate, node_.config().authority);
  return certificate && certificate->link_key.bytes == link.key && certificate->id == message.source;
}

/// A member makes a link only now and then. Each further Hello costs a check of its signature, descriptors, and all
/// trust updates: a member that sends too many stays out for a while, and has three links at most.
bool Handshake::may_send_hello(LinkId id, BytesView key, Now now, Effects& out) {
  Peer* peer = table_.by_key(key);
  if (peer == nullptr) return true;
  if (now.mono < peer->out_until) {
    out.count("refused.noisy_key");
    send(id, Goodbye{"its key is out for a while"}, out);
    return false;
  }
  if (!peer->hellos.take(now.mono)) {
    out.count("refused.too_many_hellos");
    out.log(LogLevel::warning, "too_many_hellos",
            peer->id + " says Hello over " + std::to_string(kHellosOfOne) +
                " times in a second; its key stays out for a while");
    admission_.silence(key, now.mono);
    send(id, Goodbye{"too many Hellos"}, out);
    return false;
  }
  std::vector<const Link*> waiting;
  for (const LinkId other : table_.links_of(key)) {
    const Link& link = *std::as_const(table_).link(other);
    if (!link.dialled && other != peer->link) waiting.push_back(&link);
  }
  if (waiting.size() < kSpareLinks) return true;
  const auto oldest = std::ranges::min_element(waiting, {}, &Link::opened);
  links_.drop((*oldest)->id, "more links than one node makes", true, now, out);
  return true;
}

/// The name of a node of another version, if it proves one; else empty.
std::string Handshake::name_of_other(BytesView key, const HeaderView& header) {
  if (const Peer* known = table_.by_key(key)) return known->id;
  if (header.subtype != Hello::kSubtype) return "";
  // A body only grows at its tail: the certificate in an older or newer Hello can be read all the same.
  const auto hello = decode<Hello>(header.data);
  if (!hello) return "";
  const auto certificate = open_certificate_any_time(hello->certificate, node_.config().authority);
  return certificate && certificate->link_key.bytes == key ? certificate->id : "";
}

void Handshake::on_other_version(LinkId id, BytesView key, std::uint8_t version, const HeaderView& header, Now now,
                                 Effects& out) {
  const std::string name = name_of_other(key, header);
  const std::string apart = "version " + std::to_string(kWireVersion) + " of the wire here, " + std::to_string(version);
  const std::string text = (name.empty() ? "a node that proves no name" : "'" + name + "'") +
                           " speaks another: " + apart +
                           " there; install the same version of talkrobots on both, then trb fleet renew";
  out.count("refused.version_mismatch");
  out.log(LogLevel::warning, "version_mismatch", text);
  errors_.note(name, "", errc_name(Errc::version_mismatch), text, now);
  if (table_.link(id) != nullptr) return links_.drop(id, "version_mismatch: " + apart + " there", false, now, out);
  send(header.link, Goodbye{"version_mismatch: " + apart + " there: install the same on both nodes"}, out, version);
}

std::optional<Carried> Handshake::on_hello(LinkId id, BytesView key, const Message& message, std::uint64_t sequence,
                                           Now now, Effects& out) {
  Link* known = table_.link(id);
  const bool dialled = known != nullptr && known->dialled && !known->up;
  if (known != nullptr && !dialled) {
    out.count("refused.repeated_hello");
    return std::nullopt;
  }
  if (!dialled && !may_send_hello(id, key, now, out)) return std::nullopt;
  const Link fresh = fresh_link(id, key, now.mono);
  const auto hello = read(id, message);
  const auto certificate =
      hello ? check(dialled ? *known : fresh, message, *hello, now, out) : Result<Certificate>(hello.error());
  if (!certificate && dialled) refuse_dialled(*known, message, hello, certificate.error(), now, out);
  if (!certificate && !dialled) refuse_accepted(fresh, message, hello, certificate.error(), now, out);
  if (!certificate) return std::nullopt;
  admission_.settle(key);
  if (!dialled) {
    table_.add(fresh);
    out.add(AcceptLink{id});
  }
  Link& link = *table_.link(id);
  link.heard = sequence;
  table_.learn(*certificate, hello->certificate);
  return link_up(link, *certificate, *hello, now, out);
}

void Handshake::refuse_dialled(Link& link, const Message& message, const Result<Hello>& hello, const Error& why,
                               Now now, Effects& out) {
  if (const auto update = hello ? trust_.for_refused(why, *hello) : std::nullopt) {
    // For the other side the link is up: its router takes a message that names it as the target.
    link.peer = message.source;
    messages_.send(link, *update, out);
  }
  errors_.note_link(link.id, errc_name(why.code), why.what, now);
  out.count("refused." + std::string(errc_name(why.code)));
  links_.drop(link.id, why.text(), false, now, out);
}

void Handshake::refuse_accepted(const Link& link, const Message& message, const Result<Hello>& hello, const Error& why,
                                Now now, Effects& out) {
  if (const auto update = hello ? trust_.for_refused(why, *hello) : std::nullopt) send(link.id, *update, out);
  // An unproven name is not recorded: a stranger could fill the table with names, or blame a member.
  const std::string_view name = hello && proves_name(link, message, *hello) ? message.source : std::string_view();
  errors_.note(name, "", errc_name(why.code), why.what, now);
  refuse(link.id, link.key, why, now, out);
}

void Handshake::refuse(LinkId id, BytesView key, const Error& error, Now now, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "candidate_refused", error.text());
  if (!table_.is_expected(key)) admission_.deny(key, now.mono);
  send(id, Goodbye{std::string(errc_name(error.code))}, out);
}

/// Answers the connection whose message is being handled; there is no link yet.
void Handshake::send(LinkId id, const Body& body, Effects& out, std::uint8_t version) {
  if (auto message = messages_.make("", 0, body, out)) out.add(RefuseCandidate{id, std::move(*message), version});
}

std::optional<Carried> Handshake::link_up(Link& link, const Certificate& certificate, const Hello& hello, Now now,
                                          Effects& out) {
  link.peer = certificate.id;
  link.boot = hello.boot;
  link.peer_address = hello.address;
  link.relay = hello.relay && certificate.relay;
  if (hello.clock_verified) link.utc_at_zero = saturating_sub(hello.utc, now.mono.ns);
  link.up = true;
  link.last_heard = now.mono;
  link.confirmed = now.mono;
  link.next_keep_alive = now.mono + node_.config().timing.keep_alive;
  send_hello(link, now, out);
  seals_.bind(link, certificate, hello);
  if (link.dialled || !is_in_doubt(link, *table_.find(certificate.id))) return carry(link, hello, now, out);
  link.waiting = std::make_shared<const Hello>(hello);
  return std::nullopt;
}

/// The dialler may have given this link up before its Hello was read here: another one is up or being dialled.
bool Handshake::is_in_doubt(const Link& link, const Peer& peer) const {
  const Link* old = table_.link(peer.link);
  if (old == nullptr) return table_.is_dialling(link.key);
  const bool same_address =
      old->boot == link.boot && old->own_address == link.own_address && old->peer_address == link.peer_address;
  return same_address && new_link_wins(*old, link, node_.is_smaller_than(peer.id));
}

std::optional<Carried> Handshake::carry(Link& link, const Hello& hello, Now now, Effects& out) {
  Peer& peer = *table_.find(link.peer);
  const LinkId id = link.id;
  if (peer.link != 0 && !settle_double(link, peer, now, out)) return std::nullopt;
  const bool again = peer.boot == hello.boot && peer.met && !peer.expired;
  const bool new_address = peer.address != hello.address || link.dialled;
  note(link, peer, hello, now, out);
  errors_.note_up(link, hello, now);
  table_.forget_hints(link.key);
  out.log(LogLevel::info, "peer_joined",
          peer.id + " at " + peer.address + ", boot " + std::to_string(peer.boot) +
              (link.dialled ? ", dialled by this node" : ", dialled by it"));
  return Carried{id, hello, again, new_address};
}

void Handshake::note(const Link& link, Peer& peer, const Hello& hello, Now now, Effects& out) {
  if (shared_.is_over(peer.id, link.key)) errors_.forget(peer.id, kSharedKeys);
  const NodeStart before{peer.boot, peer.address};
  const NodeStart after{hello.boot, hello.address};
  if (peer.met && before.address != after.address && shared_.on_moved(peer.id, link.key, before, after, now.mono))
    tell_shared(peer.certificate, before, after, now, out);
  if (peer.beacon_boot > hello.boot) peer.beacon_boot = peer.beacon_count = 0;
  if (link.dialled && is_numeric_endpoint(link.address)) peer.good_address = link.address;
  peer.boot = hello.boot;
  peer.address = hello.address;
  peer.version = hello.version;
  peer.clock_verified = hello.clock_verified;
  peer.profile = hello.profile;
  peer.link = link.id;
  peer.met = true;
  peer.expired = false;
  peer.lost.reset();
  peer.redial = {};
}

bool Handshake::settle_double(const Link& link, Peer& peer, Now now, Effects& out) {
  const Link* old = table_.link(peer.link);
  if (old == nullptr || new_link_wins(*old, link, node_.is_smaller_than(peer.id))) {
    const LinkId gone = peer.link;
    peer.link = 0;
    links_.drop(gone, "a better link to " + peer.id + " came up", true, now, out);
    return true;
  }
  links_.drop(link.id, "a better link to " + peer.id + " is up", true, now, out);
  return false;
}

}  // namespace trb::router
