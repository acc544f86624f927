// node join: with a code, a node's folder gets its certificate and its seeds through a cloud node.
#include <filesystem>
#include <iostream>
#include <optional>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/operator/io/door_call.hpp"
#include "common/operator/joiner.hpp"
#include "common/security/join_code.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/node_new.hpp"
#include "services/cli/core/new_node.hpp"
#include "services/cli/io/join_folder.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/questions.hpp"

namespace trb::cli {
namespace {

constexpr Duration kPause = std::chrono::milliseconds(350);  ///< between calls: fewer than a cloud node allows
constexpr double kNobody_s = 30;                             ///< without any answer from the start
constexpr Duration kForgotten = std::chrono::seconds(60);    ///< without a good answer after one
constexpr Duration kUnsigned = std::chrono::seconds(120);    ///< the inviter has not answered
constexpr Duration kUnconfirmed = std::chrono::seconds(10);  ///< to say that the certificate is here

std::string code_text(const Arguments& arguments) {
  std::string out;
  for (std::size_t i = 1; i < arguments.words.size(); ++i) out += arguments.words[i] + " ";
  if (!out.empty()) return out;
  if (can_ask()) return ask("the code of trb fleet invite");
  std::getline(std::cin, out);
  return out;
}

/// A cloud node needs no more than its name and its network.
Status make_cloud_folder(const Arguments& arguments, const std::string& dir, const JoinOffer& invited) {
  auto side = fleet_side_of(arguments, {});
  if (!side) return side.error();
  NewNode node;
  node.id = invited.name;
  node.fleet_side = *side;
  const std::string text =
      "{\n  \"id\": \"" + invited.name +
      "\",\n  \"role\": \"cloud\",\n  \"services\": [\"router\", \"scheduler\", \"resilience\"]\n}\n";
  return make_whole_folder(dir, [&](const std::string& making) {
    if (Status made = make_private_dir(making); !made) return made;
    if (Status written = write_file(making + "/node.json", text); !written) return written;
    return write_file(making + "/network.json", network_json_of(node));
  });
}

Result<SignedRecord> prepare(const Arguments& arguments, const std::string& dir, const JoinOffer& invited) {
  if (invited.role == Role::cloud && !file_exists(dir + "/node.json")) {
    if (Status made = make_cloud_folder(arguments, dir, invited); !made) return made.error();
  }
  if (Status good = check_join(dir, invited); !good) return good.error();
  return request_of(dir, invited);
}

/// The calls, one after the other, until the node has joined or cannot.
class Joining {
 public:
  Joining(const Arguments& arguments, const std::string& dir, const JoinCode& code, Duration nobody)
      : address_(arguments.get("--at", code.door)),
        nobody_(nobody),
        keys_(invitation_keys(code.secret)),
        joiner_(
            keys_, [&arguments, dir](const JoinOffer& invited) { return prepare(arguments, dir, invited); },
            [dir](const JoinOffer& offer) { return take_certificate(dir, offer); }),
        call_(context_, loop_, code, keys_.caller),
        good_(read_clocks().mono),
        asked_(good_) {
    loop_.add_timer([this] { return next_; },
                    [this](Now now) {
                      if (next_ && now.mono >= *next_) call();
                    });
  }

  /// The offer with the certificate, which is on disk. Errors: why it cannot join.
  Result<JoinOffer> run() {
    next_ = read_clocks().mono;
    while (!end_) loop_.turn();
    if (!*end_ && !joiner_.has_joined()) return end_->error();
    return joiner_.offer();
  }

 private:
  void call() {
    next_.reset();
    call_.call(address_, joiner_.word(), [this](const op::DoorAnswer& answer) { on_answer(answer); });
  }

  void on_answer(const op::DoorAnswer& answer) {
    const MonotonicTime now = read_clocks().mono;
    const Status goes_on =
        answer.kind == op::DoorAnswer::Kind::offer ? on_offer(answer.offer, now) : on_none(answer, now);
    if (!goes_on) {
      end_ = goes_on;
    } else if (joiner_.is_over()) {
      end_ = Done{};
    } else {
      next_ = now + kPause;
    }
  }

  Status on_offer(const Bytes& offer, MonotonicTime now) {
    const bool was = joiner_.is_invited();
    good_ = now;
    if (Status good = joiner_.hear(offer); !good) return good;
    if (!was && joiner_.is_invited()) asked_ = now;
    if (joiner_.has_joined() || now - asked_ < kUnsigned) return Done{};
    return fail(Errc::timeout, "the cloud node at " + address_ + " answers, the inviter does not",
                "is trb fleet invite still open there? then join again with the same code");
  }

  Status on_none(const op::DoorAnswer& answer, MonotonicTime now) {
    using Kind = op::DoorAnswer::Kind;
    const bool first = !joiner_.is_invited();
    const Duration silent = now - good_;
    if (answer.text.starts_with("version_mismatch"))
      return fail(Errc::version_mismatch, "the cloud node at " + address_ + " has another version",
                  "install the same version on both");
    if (first && (answer.kind == Kind::goodbye || answer.kind == Kind::refused)) {
      return fail(Errc::not_permitted,
                  "the cloud node at " + address_ +
                      " does not know this code: it was used or has ended, or its trb fleet invite has",
                  "ask for a new code");
    }
    if (joiner_.has_joined() ? silent < kUnconfirmed : silent < (first ? nobody_ : kForgotten)) return Done{};
    if (answer.kind == Kind::nobody) {
      return fail(Errc::peer_unreachable,
                  "nobody at " + address_ +
                      " has the cloud node's key: it is not reached from here, or another computer answers",
                  "ping it; if another address leads to it: --at HOST:PORT; if somebody stands between, join from "
                  "another network");
    }
    return fail(Errc::timeout, "the cloud node at " + address_ + " gives no good answer any more",
                "join again; if the code is over, with a new one");
  }

  std::string address_;
  Duration nobody_;
  InvitationKeys keys_;
  Context context_;
  Loop loop_;
  op::Joiner joiner_;
  op::DoorCall call_;
  MonotonicTime good_;   ///< the last good answer
  MonotonicTime asked_;  ///< the request was written
  std::optional<MonotonicTime> next_;
  std::optional<Status> end_;
};

int print_joined(const Arguments& arguments, const std::string& dir, const JoinOffer& offer) {
  const auto certificate = open_certificate_any_time(offer.certificate, {offer.fleet, offer.authority_key.bytes});
  if (!certificate) return print_error(arguments, certificate.error());
  const UtcTime now = read_clocks().utc;
  const std::string until = to_iso8601({certificate->not_after});
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"dir", Value{dir}},
                                   {"node", Value{certificate->id}},
                                   {"fleet", Value{offer.fleet}},
                                   {"serial", Value{static_cast<std::int64_t>(certificate->serial)}},
                                   {"identity", Value{to_hex(certificate->identity_key.bytes)}},
                                   {"valid_to", Value{until}},
                                   {"seeds", Value{static_cast<std::int64_t>(offer.seeds.size())}}}});
    return kGood;
  }
  print_line("joined the fleet '" + offer.fleet + "' as '" + certificate->id + "': serial " +
             std::to_string(certificate->serial) + ", valid to " + until + ", " + std::to_string(offer.seeds.size()) +
             " cloud nodes as seeds");
  print_line("identity " + to_hex(certificate->identity_key.bytes).substr(0, 16) + ", as the inviter shows it");
  if (now.ns < certificate->not_before)
    print_line("note: this computer's clock is behind (" + to_iso8601(now) + "): set it");
  print_line("next: trb check " + dir + "; trb up " + dir);
  return kGood;
}

int run_join(const Arguments& arguments) {
  init_crypto();
  const std::string dir = std::filesystem::path(arguments.words[0]).lexically_normal().string();
  if (arguments.has("--at") && !is_numeric_endpoint(arguments.get("--at")))
    return print_error(arguments, fail(Errc::bad_value, "--at: '" + arguments.get("--at") + "' is no numeric HOST:PORT",
                                       "write it as 10.0.0.1:45000"));
  const auto code = read_join_code(code_text(arguments));
  if (!code) return print_error(arguments, code.error());
  if (code->role == Role::robot && !file_exists(dir + "/node.json")) {
    return print_error(arguments, fail(Errc::missing, dir + ": no node.json there, and the code is a robot's",
                                       "make the folder first: trb node new " + dir));
  }
  const auto nobody = arguments.number("--timeout", kNobody_s);
  if (!nobody) return print_error(arguments, nobody.error());
  Joining joining(arguments, dir, *code, seconds(*nobody));
  const auto joined = joining.run();
  if (!joined) return print_error(arguments, joined.error());
  return print_joined(arguments, dir, *joined);
}

}  // namespace

std::vector<Command> node_join_commands() {
  return {
      {{"node", "join"},
       {"node join DIR [CODE ...]",
        "Gets the node's certificate and its seeds with a code of trb fleet invite, through the cloud node in it. "
        "DIR is a\n"
        "folder of trb node new; of a cloud node it is made. Without CODE it is asked for, or read from the input. "
        "May be\n"
        "stopped and repeated.",
        {"--at HOST:PORT|where the cloud node is dialled, if not where the code says",
         "--timeout S|how long to try until the cloud node answers (30)",
         "--network NAME|of a cloud node's folder that is made: interface or address on the fleet's network", kJson},
        {"trb node join nodes/arm1 3F2KQ-...", "trb node join nodes/arm1"},
        1,
        40},
       run_join}};
}

}  // namespace trb::cli
