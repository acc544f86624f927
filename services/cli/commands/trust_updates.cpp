// fleet renew, revoke, tell: what the authority says after it has signed, and how it reaches the fleet.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/security/authority.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/revocations.hpp"
#include "common/security/signing_clock.hpp"
#include "common/transport/loop.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/fleet_via.hpp"
#include "services/cli/commands/relay_right.hpp"
#include "services/cli/io/fleet_lock.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/passphrase.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

/// Locked until the command is over.
struct HeldFleet {
  FleetLock lock;
  Authority authority;
};

/// Without a passphrase it cannot sign.
Result<HeldFleet> hold_fleet(const std::string& dir, const std::optional<std::string>& passphrase) {
  auto lock = FleetLock::take(dir);
  if (!lock) return lock.error();
  auto authority = passphrase ? open_authority(dir, *passphrase) : read_authority(dir);
  if (!authority) return authority.error();
  return HeldFleet{std::move(*lock), std::move(*authority)};
}

Result<HeldFleet> open_for(const Arguments& arguments) {
  init_crypto();
  auto secret = ask_for_passphrase(arguments, false);
  if (!secret) return secret.error();
  return hold_fleet(arguments.words[0], *secret);
}

/// Of a word that is a serial; nothing of any other.
std::optional<std::uint64_t> serial_of(const std::string& word) {
  return parse_number<std::uint64_t>(word);
}

bool is_file(const std::string& path) {
  std::error_code none;
  return std::filesystem::is_regular_file(path, none);
}

Error revoked_already(const std::string& dir, const std::string& word) {
  return fail(Errc::cert_revoked, "'" + word + "' is revoked already",
              "if the fleet does not know it: trb fleet tell " + dir +
                  " --via NODE_DIR; trb fleet request with new keys and trb fleet sign make it a member again");
}

/// Why no certificate that could be renewed or revoked is behind this word.
Error nothing_found(const Authority& authority, const std::string& dir, const std::string& word) {
  std::vector<std::string> ids;
  for (const Certificate& row : authority.issued) {
    if (row.id == word || row.serial == serial_of(word)) {
      return revoked_already(dir, word);
    }
    if (std::find(ids.begin(), ids.end(), row.id) == ids.end()) ids.push_back(row.id);
  }
  // Its certificate was signed in a newer copy of this folder.
  const auto is_meant = [&](const Revocation& entry) { return entry.id == word; };
  for (const auto* entries : {&authority.list.revoked, &authority.revoked}) {
    if (std::any_of(entries->begin(), entries->end(), is_meant)) return revoked_already(dir, word);
  }
  const std::string otherwise = "name its certificate.json, or add --via NODE_DIR of a node that has met it";
  return fail(Errc::unknown_target, "no certificate of '" + word + "' is known in this folder",
              ids.empty() ? otherwise : did_you_mean(word, ids, otherwise + "; known"));
}

/// The newest of that id that is not revoked, also if it has ended: what can be renewed.
const Certificate* find_renewable(const Authority& authority, std::string_view id) {
  return find_living(authority, id, UtcTime{std::numeric_limits<std::int64_t>::min()});
}

/// The certificate that a word of the command line means: an id, a serial, a certificate.json.
Result<Certificate> find_certificate(Authority& authority, const std::string& dir, const std::string& word) {
  std::string id = word;
  if (is_file(word)) {
    auto file = read_certificate_file(word);
    if (!file) return file.error();
    auto adopted = adopt_certificate(authority, dir, file->certificate);
    if (!adopted) return adopted.error();
    id = adopted->id;
  } else if (const auto serial = serial_of(word)) {
    for (const Certificate& row : authority.issued) {
      if (row.serial == *serial) id = row.id;
    }
  }
  const Certificate* living = find_renewable(authority, id);
  return living == nullptr ? Result<Certificate>(nothing_found(authority, dir, id)) : *living;
}

/// `or_revoked`: those that are revoked already are named, and left out.
Result<std::vector<Certificate>> find_certificates(Authority& authority, const Arguments& arguments,
                                                   bool or_revoked = false) {
  std::vector<Certificate> out;
  for (std::size_t i = 1; i < arguments.words.size(); ++i) {
    auto found = find_certificate(authority, arguments.words[0], arguments.words[i]);
    if (!found && or_revoked && found.error().code == Errc::cert_revoked) {
      print_line("note: " + found.error().what);
      continue;
    }
    if (!found) return found.error();
    if (std::find(out.begin(), out.end(), *found) == out.end()) out.push_back(std::move(*found));
  }
  return out;
}

/// Every member's newest certificate. Who has ended is no member any more, and may be long out of use: it must be
/// named.
std::vector<Certificate> members_of(const Authority& authority, UtcTime now) {
  std::set<std::string> ids;
  std::vector<Certificate> out;
  for (const Certificate& row : authority.issued) {
    if (!ids.insert(row.id).second) continue;
    if (const Certificate* living = find_living(authority, row.id, now)) {
      out.push_back(*living);
    } else if (find_renewable(authority, row.id) != nullptr) {
      print_line("note: the certificate of " + row.id + " has ended; name it to renew it");
    }
  }
  return out;
}

/// Serials below the next one that no file names. Those that a restored folder passed over were given by nobody, as far
/// as anybody knows.
std::size_t count_unknown(const Authority& authority) {
  const auto signed_ones = static_cast<std::size_t>(authority.next_serial - 1 - authority.skipped);
  return signed_ones - std::min(signed_ones, authority.issued.size());
}

/// `then`: what this means for their nodes.
void note_unknown(const Authority& authority, const std::string& then) {
  const std::size_t unknown = count_unknown(authority);
  if (unknown == 0) return;
  const std::string what = unknown == 1 ? " certificate was signed before this folder kept it; "
                                        : " certificates were signed before this folder kept them; ";
  print_line("note: " + std::to_string(unknown) + what + then);
}

/// Errors: missing (nobody), conflict (both, or a right for everybody).
Status check_choice(const Arguments& arguments) {
  const bool named = arguments.words.size() > 1;
  for (const std::string option : {"--relay", "--no-relay"}) {
    if (!arguments.has("--all") || !arguments.has(option)) continue;
    return fail(Errc::conflict, option + ": with --all it would change a right of every member",
                "renew those with " + option + " by name, then all without it");
  }
  if (named != arguments.has("--all")) return Done{};
  return named ? fail(Errc::conflict, "--all: nodes are named, too", "name nodes, or give --all")
               : fail(Errc::missing, "whose certificate is to be renewed?", "name a node, or give --all");
}

/// What is named, or with --all every member's. Errors: missing (no member), those of find_certificates.
Result<std::vector<Certificate>> chosen_certificates(Authority& authority, const Arguments& arguments, UtcTime now) {
  if (!arguments.has("--all")) return find_certificates(authority, arguments);
  note_unknown(authority, "such a node is left out. Name its certificate.json to renew it.");
  std::vector<Certificate> members = members_of(authority, now);
  if (!members.empty()) return members;
  return fail(Errc::missing, "--all: " + arguments.words[0] + " has no member",
              "trb fleet sign and trb fleet invite make members");
}

/// Two lists have one number, and the fleet has the other one, or a list was signed in an older copy of this folder,
/// and lacks what was revoked here: only a next list, which has both, can be told. Errors: conflict.
Status check_one_list(const Authority& authority, const Arguments& arguments, UtcTime now) {
  const std::string& dir = arguments.words[0];
  const std::string via = arguments.get("--via", "NODE_DIR");
  const auto list = decode<RevocationList>(authority.revocations.payload.bytes);
  if (!authority.revocations.kind.empty() && !(list && *list == authority.list)) {
    return fail(Errc::conflict,
                dir + " was put back to an older copy, and has revoked since: the fleet has another list " +
                    std::to_string(authority.list.number),
                "trb fleet revoke " + dir + " ID --via " + via +
                    " with one that is revoked here: the next list has what both have");
  }
  const std::vector<Revocation> missing = missing_from_list(authority, now);
  if (missing.empty()) return Done{};
  return fail(Errc::conflict,
              "list " + std::to_string(authority.list.number) + " lacks '" + missing.front().id + "' (serial " +
                  std::to_string(missing.front().serial) + "), which was revoked in " + dir +
                  ": it was signed in an older copy of this folder, or by a wrong clock",
              "trb fleet revoke " + dir + " " + missing.front().id + " --via " + via + ": the next list has all");
}

/// What is signed is in the folder by now. `first`: what is to be done before it is told again.
Error not_handed_on(const Error& why, const std::string& dir, const std::string& via, const std::string& first) {
  // A router that has not answered in time may have told it; to tell it again does no harm.
  return fail(why.code, "signed, and in " + dir + ", but the fleet does not know: " + why.what,
              (first.empty() ? "" : first + ", then ") + "trb fleet tell " + dir + " --via " + via);
}

std::string make_room(const std::string& dir) {
  return "make room there (df -h " + dir + ")";
}

/// Writes what the fleet is to be told: the list, which is in the folder, and the renewals that news.json has.
Status publish(const Authority& authority, const std::string& dir, UtcTime now) {
  Status told = publish_trust_updates(authority, dir, {}, now);
  if (told) return told;
  return not_handed_on(told.error(), dir, "NODE_DIR", make_room(dir));
}

/// To renew again does no harm, whether news.json had room for the renewals or not.
Error not_renewed(Error why, const std::string& dir) {
  if (why.code == Errc::io_error && why.hint.empty()) why.hint = make_room(dir) + ", then renew again";
  return why;
}

/// Hands news.json to the fleet by a running node's router, or says how else it gets there.
int hand_on(const Arguments& arguments) {
  const std::string& dir = arguments.words[0];
  const std::string path = std::filesystem::absolute(dir + "/news.json").string();
  const std::string via = arguments.get("--via");
  if (via.empty()) {
    print_line("wrote " + path + "; the fleet does not know it yet. Bring it to any one node that is up:");
    print_line("  on this machine   trb fleet tell " + dir + " --via NODE_DIR");
    print_line(
        "  on another one    copy news.json into its NODE_DIR/keys; its router takes it at once and tells the others");
    return kGood;
  }
  const auto not_told = [&](const Error& why) {
    return print_error(arguments, not_handed_on(why, dir, via, why.hint));
  };
  auto updates = read_trust_updates(path);
  if (!updates) return not_told(updates.error());
  auto probe = Probe::open(via);
  if (!probe) return not_told(probe.error());
  auto answer = (*probe)->ask_node<Ack>(std::move(*updates));
  // The router's own words for a full disk: it is in force.
  if (!answer && answer.error().code == Errc::io_error) return print_error(arguments, answer.error());
  if (!answer) return not_told(answer.error());
  print_line((*probe)->node() + ": " + answer->text);
  return kGood;
}

/// Makes news.json if it is not what the folder has: it was not written if the disk was full when the list was.
Status publish_again(const Authority& authority, const std::string& dir, bool learned) {
  const auto updates = read_trust_updates(dir + "/news.json");
  if (!learned && updates && updates->revocations == authority.revocations) return Done{};
  return publish(authority, dir, read_clocks().utc);
}

int run_renew(const Arguments& arguments) {
  if (Status clear = check_choice(arguments); !clear) return print_error(arguments, clear.error());
  if (Status node = check_via(arguments); !node) return print_error(arguments, node.error());
  auto held = open_for(arguments);
  if (!held) return print_error(arguments, held.error());
  Authority* const authority = &held->authority;
  const auto days = arguments.number("--days", 365, kMostDays);
  if (!days) return print_error(arguments, days.error());
  const auto relay = relay_right(arguments);
  if (!relay) return print_error(arguments, relay.error());
  const std::string& dir = arguments.words[0];
  const auto learned = learn_from(*authority, arguments, arguments.get("--via"));
  if (!learned) return print_error(arguments, learned.error());
  const UtcTime now = read_clocks().utc;
  if (Status right = check_clock(arguments, *authority, *learned, now); !right)
    return print_error(arguments, right.error());
  if (Status one = check_one_list(*authority, arguments, now); !one) return print_error(arguments, one.error());
  auto old = chosen_certificates(*authority, arguments, now);
  if (!old) return print_error(arguments, old.error());
  if (Status few = check_renewals(old->size()); !few) return print_error(arguments, few.error());
  const auto renewed = renew_certificates(*authority, dir, *old, now, seconds(*days * 86400), *relay);
  if (!renewed) return print_error(arguments, not_renewed(renewed.error(), dir));
  for (auto fresh = authority->issued.end() - std::ssize(*renewed); fresh != authority->issued.end(); ++fresh) {
    print_line(fresh->id + ": serial " + std::to_string(fresh->serial) + ", valid to " +
               to_iso8601({fresh->not_after}));
  }
  return hand_on(arguments);
}

/// As the list says it: it may cover more than the certificate that was named.
void print_revoked(const Authority& authority, const Certificate& certificate, UtcTime now) {
  const Revocation* entry = find_revocation(authority.list, certificate);
  if (entry == nullptr) return;
  print_line(certificate.id + ": revoked up to serial " + std::to_string(entry->serial) +
             (certificate.not_after <= now.ns ? "; its certificate had ended already" : ""));
}

int run_revoke(const Arguments& arguments) {
  if (Status node = check_via(arguments); !node) return print_error(arguments, node.error());
  auto held = open_for(arguments);
  if (!held) return print_error(arguments, held.error());
  Authority* const authority = &held->authority;
  const std::string& dir = arguments.words[0];
  const auto learned = learn_from(*authority, arguments, arguments.get("--via"));
  if (!learned) return print_error(arguments, learned.error());
  const UtcTime now = read_clocks().utc;
  Status right = check_clock(arguments, *authority, *learned, now);
  if (right && !arguments.has("--trust-clock")) right = check_members_clock(*authority, now);
  if (!right) return print_error(arguments, right.error());
  // With a node named, the fleet is told of whom was revoked before, too: it may not know it yet.
  auto over = find_certificates(*authority, arguments, arguments.has("--via"));
  if (!over) return print_error(arguments, over.error());
  // Two lists of one number are made one by a next list, even if it revokes nobody else.
  if (over->empty() && check_one_list(*authority, arguments, now)) {
    if (Status told = publish_again(*authority, dir, learned->is_news); !told)
      return print_error(arguments, told.error());
    return hand_on(arguments);
  }
  const Status done = revoke_certificates(*authority, dir, *over, arguments.get("--reason", "revoked"), now);
  if (!done) return print_error(arguments, done.error());
  for (const Certificate& certificate : *over) print_revoked(*authority, certificate, now);
  print_line("list " + std::to_string(authority->list.number) + ", beacon key " +
             std::to_string(authority->list.beacon_number) + " for the " +
             std::to_string(authority->list.beacon_keys.size()) + " nodes that stay");
  note_unknown(*authority,
               "such a node gets no new beacon key. Name its certificate.json in trb fleet renew, then revoke again.");
  if (Status told = publish(*authority, dir, now); !told) return print_error(arguments, told.error());
  return hand_on(arguments);
}

int run_tell(const Arguments& arguments) {
  init_crypto();
  if (Status node = check_via(arguments); !node) return print_error(arguments, node.error());
  const std::string& dir = arguments.words[0];
  auto held = hold_fleet(dir, std::nullopt);
  if (!held) return print_error(arguments, held.error());
  Authority* const authority = &held->authority;
  auto learned = learn_from(*authority, arguments, arguments.get("--via"));
  if (!learned) return print_error(arguments, learned.error());
  if (Status one = check_one_list(*authority, arguments, read_clocks().utc); !one)
    return print_error(arguments, one.error());
  if (Status told = publish_again(*authority, dir, learned->is_news); !told)
    return print_error(arguments, told.error());
  return hand_on(arguments);
}

const std::string kVia = "--via NODE_DIR|hand it to the fleet by this node, which is up";
const std::string kErrorsJson = "--json|errors for programs";

const std::vector<Command> kTrustUpdateCommands = {
    {{"fleet", "renew"},
     {"fleet renew FLEET_DIR [ID|SERIAL|CERTIFICATE ...]",
      "Signs new certificates for the same keys; a fleet that is up takes them without a restart.",
      {"--all|every member's, but not those that have ended or are revoked",
       "--days N|how long the certificate is valid (365)", kRelay, kNoRelay, kVia, kTrustClock, kPassphrase,
       kErrorsJson},
      {"trb fleet renew ~/hall-3-authority ur3 ur5 --via nodes/cloud",
       "trb fleet renew ~/hall-3-authority --all --via nodes/cloud"},
      1,
      1000},
     run_renew},
    {{"fleet", "revoke"},
     {"fleet revoke FLEET_DIR ID|SERIAL|CERTIFICATE ...",
      "Ends nodes' membership: the next revocation list, and a new beacon key for those that stay.",
      {"--reason TEXT|for the list, which every node reads (revoked)", kVia, kTrustClock, kPassphrase, kErrorsJson},
      {"trb fleet revoke ~/hall-3-authority ur3 --reason stolen --via nodes/cloud"},
      2,
      1000},
     run_revoke},
    {{"fleet", "tell"},
     {"fleet tell FLEET_DIR",
      "Hands the folder's news to the fleet: list, renewed certificates. Needs no passphrase. A folder that was put\n"
      "back from an older copy first takes over what the node knows.",
      {kVia, kErrorsJson},
      {"trb fleet tell ~/hall-3-authority --via nodes/cloud"},
      1,
      1},
     run_tell},
};

}  // namespace

std::vector<Command> trust_update_commands() {
  return kTrustUpdateCommands;
}

}  // namespace trb::cli
