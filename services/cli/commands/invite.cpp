// fleet invite: a code with which a new node gets its certificate through a cloud node.
#include <csignal>
#include <filesystem>

#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/operator/invite_node.hpp"
#include "common/security/authority.hpp"
#include "common/security/join_code.hpp"
#include "common/transport/signals.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/fleet_via.hpp"
#include "services/cli/io/fleet_lock.hpp"
#include "services/cli/io/passphrase.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMostList = 20U << 10U;  ///< a longer list comes to the node by its first link

struct Wish {
  std::string dir;  ///< the authority's, absolute
  std::string passphrase;
  std::string name;
  Role role{};
  Duration validity{};
  bool json = false;
};

struct Doors {
  std::string id;  ///< of the cloud node that keeps the invitation
  FleetSeed door;
  std::vector<FleetSeed> seeds;  ///< every cloud node that is there
};

Result<Wish> invite_wish_of(const Arguments& arguments) {
  Wish wish;
  wish.dir = std::filesystem::absolute(arguments.words[0]).string();
  wish.name = arguments.words[1];
  wish.json = arguments.has("--json");
  if (Status good = check_id("NAME", wish.name); !good) return good.error();
  const std::string role = arguments.get("--role", "robot");
  if (role != "robot" && role != "cloud") return fail(Errc::bad_value, "--role: '" + role + "'", "use robot or cloud");
  wish.role = role == "cloud" ? Role::cloud : Role::robot;
  const auto days = arguments.number("--days", 365, kMostDays);
  if (!days) return days.error();
  wish.validity = seconds(*days * 86400);
  auto passphrase = ask_for_passphrase(arguments, false);
  if (!passphrase) return passphrase.error();
  wish.passphrase = std::move(*passphrase);
  return wish;
}

/// The cloud nodes that this node reaches, as the authority has signed them. `at`: the new node reaches the door there.
Result<Doors> doors_of(const RouteTable& table, const FleetAuthority& fleet, const std::string& through,
                       const std::string& at) {
  Doors out;
  std::vector<std::string> ids;
  for (const Route& route : table.routes) {
    if (route.role != Role::cloud || !op::is_reached(route) || route.address.empty()) continue;
    const auto certificate = open_certificate_any_time(route.certificate, fleet);
    if (!certificate) return certificate.error();
    const FleetSeed seed{route.address, certificate->link_key};
    ids.push_back(route.id);
    if (out.seeds.size() < kMaxFleetSeeds) out.seeds.push_back(seed);
    if (out.id.empty() && (through.empty() || through == route.id)) {
      out.id = route.id;
      out.door = seed;
    }
  }
  if (!out.id.empty()) {
    if (!at.empty()) out.door.address = at;
    dial_at(out.seeds, out.door);
    return out;
  }
  if (ids.empty())
    return fail(Errc::peer_unreachable, "no cloud node is reached by this node",
                "start one (trb up), or look why it is not reached: trb doctor");
  return fail(Errc::unknown_target, "--through: no cloud node '" + through + "' is reached",
              did_you_mean(through, ids, "use one of"));
}

JoinOffer open_offer(const Wish& wish, const FleetAuthority& fleet) {
  JoinOffer offer;
  offer.name = wish.name;
  offer.role = wish.role;
  offer.fleet = fleet.name;
  offer.authority_key = {fleet.public_key};
  return offer;
}

/// The folder is read anew: another invitation may have taken a serial meanwhile.
Result<JoinOffer> sign_offer(const Wish& wish, const std::vector<FleetSeed>& seeds, const SignedRecord& request) {
  const auto lock = FleetLock::take(wish.dir);
  if (!lock) return lock.error();
  auto authority = open_authority(wish.dir, wish.passphrase);
  if (!authority) return authority.error();
  auto file = sign_request(*authority, wish.dir, request, read_clocks().utc, wish.validity);
  if (!file) return file.error();
  JoinOffer offer = open_offer(wish, authority->fleet);
  offer.certificate = std::move(file->certificate);
  offer.beacon_number = file->beacon_number;
  offer.sealed_beacon = {std::move(file->sealed_beacon)};
  if (file->revocations.payload.bytes.size() <= kMostList) offer.revocations = std::move(file->revocations);
  offer.seeds = seeds;
  return offer;
}

void print_event(const Wish& wish, const std::string& event, const std::string& text, Value::Object more = {}) {
  if (!wish.json) return print_line(text);
  more.insert(more.begin(), {"event", Value{event}});
  print_json(Value{std::move(more)});
}

void print_code(const Wish& wish, const std::string& code, UtcTime until, const Doors& doors) {
  if (wish.json) {
    return print_event(wish, "code", "",
                       {{"code", Value{code}}, {"name", Value{wish.name}}, {"until", Value{to_iso8601(until)}}});
  }
  print("the code for '" + wish.name + "', once, until " + to_iso8601(until) + ":\n\n  " + code + "\n\n");
  print_line("on the new computer:  trb node join DIR  (it asks for the code)");
  print_line("waiting for it at " + doors.id + " (" + doors.door.address + "); Ctrl-C withdraws the code");
}

void print_received(const Wish& wish, op::Inviter::Received received, const op::Inviter& inviter) {
  using Received = op::Inviter::Received;
  const std::string identity = to_hex(inviter.identity()).substr(0, 16);
  if (received == Received::signed_one) {
    print_event(wish, "signed",
                "signed for '" + wish.name + "', identity " + identity + " (the new computer shows the same)",
                {{"identity", Value{to_hex(inviter.identity())}}});
  } else if (received == Received::refused) {
    print_event(wish, "refused", "a request came and was not signed: " + inviter.refusal(),
                {{"why", Value{inviter.refusal()}}});
  } else if (received == Received::second) {
    print_event(
        wish, "second",
        "ATTENTION: a second computer has used this code and got nothing. If the first was not yours (identity " +
            identity + "), end it: trb fleet revoke " + wish.dir + " " + wish.name);
  }
}

int report_end(const Arguments& arguments, const Wish& wish, const Result<op::InviteEnd>& end) {
  if (!end) return print_error(arguments, end.error());
  if (*end == op::InviteEnd::joined) {
    print_event(wish, "joined", "'" + wish.name + "' has joined");
    return kGood;
  }
  if (*end == op::InviteEnd::unused)
    return print_error(
        arguments,
        fail(Errc::expired, "nobody has used the code of '" + wish.name + "'; it is good no more", "invite again"));
  return print_error(
      arguments,
      fail(Errc::not_confirmed, "'" + wish.name + "' was signed, and has not said that it has its certificate",
           "look there: trb check DIR; if it has none, invite again: the same keys are signed anew. If nobody of yours "
           "has used the code: trb fleet revoke " +
               wish.dir + " " + wish.name));
}

int wait_for_node(const Arguments& arguments, const Wish& wish, const Authority& authority, const Doors& doors,
                  Probe& probe) {
  const Bytes secret = random_bytes(kJoinSecret);
  const InvitationKeys keys = invitation_keys(secret);
  const auto code = to_text({secret, wish.role, doors.door.key.bytes, doors.door.address});
  if (!code) return print_error(arguments, code.error());
  const UtcTime until = read_clocks().utc + kInvitationTime;
  op::InviteNode order{
      .door = doors.id,
      .invitation = sign_invitation({{authority.fleet.id()}, wish.name, wish.role, {keys.caller.public_key}, until.ns},
                                    authority.key),
      .inviter = op::Inviter(keys, open_offer(wish, authority.fleet),
                             [&](const SignedRecord& request) { return sign_offer(wish, doors.seeds, request); }),
      .on_held = [&] { print_code(wish, *code, until, doors); },
      .on_received = [&](op::Inviter::Received received,
                         const op::Inviter& inviter) { print_received(wish, received, inviter); },
      .on_silent =
          [&](const Error& why) { print_event(wish, "silent", "waiting for " + doors.id + ": " + why.text()); }};
  std::optional<Result<op::InviteEnd>> end;
  const op::InvitingPtr inviting = op::invite_node(
      probe.session(), std::move(order), [&end](Result<op::InviteEnd> result) { end.emplace(std::move(result)); });
  const Signals signals(probe.bus().loop(), [&](int) { op::end_inviting(inviting); });
  probe.wait_until([&end] { return end.has_value(); });
  return report_end(arguments, wish, *end);
}

/// The folder may be restored from an older copy: who was revoked since must not be signed.
Status learn_before(const Arguments& arguments, const Wish& wish, const std::string& node) {
  const auto lock = FleetLock::take(wish.dir);
  if (!lock) return lock.error();
  auto authority = read_authority(wish.dir);
  if (!authority) return authority.error();
  const auto learned = learn_from(*authority, arguments, node);
  if (!learned) return learned.error();
  return check_clock(arguments, *authority, *learned, read_clocks().utc);
}

int run_invite(const Arguments& arguments) {
  init_crypto();
  const auto wish = invite_wish_of(arguments);
  if (!wish) return print_error(arguments, wish.error());
  block_signals();  // who is asked for the passphrase can still end it
  const auto authority = open_authority(wish->dir, wish->passphrase);
  if (!authority) return print_error(arguments, authority.error());
  if (find_living(*authority, wish->name, read_clocks().utc) != nullptr && !wish->json) {
    print_problem("note: '" + wish->name +
                  "' is a member. The code renews it on its own computer; on another one it is "
                  "refused until the first is revoked.\n");
  }
  Arguments where = arguments;
  if (arguments.has("--via")) where.options["--node"] = arguments.get("--via");
  const auto node = find_node(where);
  if (!node)
    return print_error(arguments,
                       fail(node.error().code, node.error().what, "give --via NODE_DIR of a node that is up here"));
  if (const Status ready = learn_before(arguments, *wish, *node); !ready) return print_error(arguments, ready.error());
  auto probe = Probe::open(*node);
  if (!probe) return print_error(arguments, probe.error());
  const auto table = (*probe)->routes();
  if (!table) return print_error(arguments, table.error());
  const auto doors = doors_of(*table, authority->fleet, arguments.get("--through"), arguments.get("--at"));
  if (!doors) return print_error(arguments, doors.error());
  return wait_for_node(arguments, *wish, *authority, *doors, **probe);
}

}  // namespace

std::vector<Command> invite_commands() {
  return {{{"fleet", "invite"},
           {"fleet invite FLEET_DIR NAME",
            "Prints a code with which the new node NAME gets its certificate through a cloud node: once, within ten\n"
            "minutes. Waits for it, for the authority's key signs here and lies on no node.",
            {"--via NODE_DIR|a node that is up on this computer (else TRB_NODE, else this folder)",
             "--through CLOUD|the cloud node that the new one calls (the first that is reached)",
             "--at HOST:PORT|where the new node dials that cloud node, from now on, if another address leads there",
             "--role ROLE|robot or cloud (robot)", "--days N|how long the certificate is valid (365)", kTrustClock,
             kPassphrase, "--json|an object a line"},
            {"trb fleet invite ~/hall-3-authority arm1 --via nodes/cloud"},
            2,
            2},
           run_invite}};
}

}  // namespace trb::cli
