#include "common/operator/doctor/causes.hpp"

#include <algorithm>
#include <iterator>

namespace trb::op {
namespace {

// The errors that a router records about others, and their meaning. A refusal by the other side is "refused_us".
constexpr Cause kCauses[] = {
    {"foreign_fleet", "foreign_fleet", "its certificate is of another fleet",
     "if it is another hall's, nothing: it does no harm; if it belongs here, have its request signed by this fleet's "
     "authority: trb fleet sign"},
    {"bad_signature", "bad_signature", "its certificate or beacon was not signed by this fleet's authority",
     "have its request signed again: trb fleet sign; if nobody made it, somebody tries to get in"},
    {"cert_expired", "cert_expired", "its certificate has ended",
     "renew it where the authority is: trb fleet renew; if it is new, look at the clocks"},
    {"cert_not_yet_valid", "clock_off", "its certificate is not valid yet by this node's clock",
     "compare with a true clock: if this node's is behind, set it (timedatectl); if the authority's was ahead, renew "
     "it "
     "again there: trb fleet renew"},
    {"cert_revoked", "cert_revoked", "its certificate was revoked",
     "if the node is yours again: new keys (rm keys/identity.key keys/link.key), trb fleet request, trb fleet sign"},
    {"revocations_unknown", "revocations_unknown", "",
     "if it cannot be read: chown -R --reference=NODE_DIR NODE_DIR/state; if it is damaged: the newest news.json of "
     "the "
     "authority's folder into NODE_DIR/keys, then rm NODE_DIR/state/news NODE_DIR/state/news.copy"},
    {"wrong_key", "wrong_key", "its certificate is for another link key than it used",
     "the certificate in its keys/ belongs to other keys: trb fleet request, trb fleet sign"},
    {"duplicate", "id_taken", "two nodes have the same id", "give each node its own id in node.json, and sign again"},
    {"downgraded", "downgraded", "it showed an older certificate than one that was seen",
     "put the newest certificate.json into its keys/"},
    {"conflict", "old_start", "it showed an older certificate or an older start than one that was seen",
     "if two computers use its keys, stop one; else put its newest certificate.json and its state/ back"},
    {"version_mismatch", "versions_apart", "it speaks another version of the messages",
     "install the same release on both"},
    {"clock_off", "clock_off", "", "set the clock: timedatectl; on a PC without a battery let NTP do it"},
    {"no_name", "no_name", "", "until then it is not dialled; everything else goes on"},
    {"profile_too_large", "profile_too_large", "",
     "if it is yours: name fewer skills, places and sensors in its robot's description; if not: trb fleet revoke"},
    {"incomplete", "incomplete", "it sent parts of a message without end, and was cut",
     "no node of this fleet does that: look at that computer; if its keys were stolen: trb fleet revoke"},
    {"one_way", "one_way", "what this node sends does not arrive there, what it sends does",
     "look for a firewall rule or a broken fibre in that direction; ping both ways"},
    {"not_heard", "silent", "nothing was received from it for 10 s, its lease", "look at its power and cable; ping it"},
};

}  // namespace

const Cause* cause_of(std::string_view code) {
  const auto* at = std::find_if(std::begin(kCauses), std::end(kCauses), [&](const Cause& c) { return c.code == code; });
  return at == std::end(kCauses) ? nullptr : at;
}

}  // namespace trb::op
