// node join: with a code, a node's folder gets its certificate and its seeds through a cloud node.
#include <iostream>
#include <optional>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/operator/io/door_call.hpp"
#include "common/operator/join_patience.hpp"
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

constexpr double kNobody_s = 30;  ///< without any answer from the start

std::string code_text(const Arguments& arguments) {
  std::string out;
  for (std::size_t i = 1; i < arguments.words.size(); ++i) out += arguments.words[i] + " ";
  if (!out.empty()) return out;
  if (can_ask()) return ask("the code of trb fleet invite");
  std::getline(std::cin, out);
  return out;
}

/// A cloud node needs no more than its name and its network.
Status make_cloud(const Arguments& arguments, const std::string& dir, const JoinOffer& invited) {
  const auto config = config_dir();
  if (!config) return config.error();
  const auto side = fleet_side_of(arguments, {});
  if (!side) return side.error();
  return make_cloud_folder({invited.name, *side}, dir, *config);
}

Result<SignedRecord> prepare(const Arguments& arguments, const std::string& dir, const JoinOffer& invited) {
  if (invited.role == Role::cloud && !file_exists(dir + "/node.json")) {
    if (Status made = make_cloud(arguments, dir, invited); !made) return made.error();
  }
  if (Status good = check_join(dir, invited); !good) return good.error();
  return request_of(dir, invited);
}

/// The calls, one after the other, until the node has joined or cannot.
class Joining {
 public:
  Joining(const Arguments& arguments, const std::string& dir, const JoinCode& code, Duration nobody)
      : address_(arguments.get("--at", code.door)),
        keys_(invitation_keys(code.secret)),
        joiner_(
            keys_, [&arguments, dir](const JoinOffer& invited) { return prepare(arguments, dir, invited); },
            [this, dir, door = Blob{code.door_key}](JoinOffer offer) {
              // Where it has answered, the node will reach it again.
              dial_at(offer.seeds, {address_, door});
              return take_certificate(dir, offer);
            }),
        call_(context_, loop_, code, keys_.caller),
        patience_(address_, nobody, read_clocks().mono) {
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
    call_.call(address_, joiner_.message(), [this](const op::DoorAnswer& answer) { on_answer(answer); });
  }

  void on_answer(const op::DoorAnswer& answer) {
    const MonotonicTime now = read_clocks().mono;
    const Status goes_on = receive(answer, now);
    if (!goes_on) {
      end_ = goes_on;
    } else if (joiner_.is_over()) {
      end_ = Done{};
    } else {
      next_ = now + patience_.pause();
    }
  }

  Status receive(const op::DoorAnswer& answer, MonotonicTime now) {
    if (answer.kind != op::DoorAnswer::Kind::offer) return patience_.on_none(answer, stage(), now);
    if (Status good = joiner_.receive(answer.offer); !good) return good;
    return patience_.on_offer(stage(), now);
  }

  [[nodiscard]] op::JoinStage stage() const {
    if (joiner_.has_joined()) return op::JoinStage::joined;
    return joiner_.is_invited() ? op::JoinStage::invited : op::JoinStage::asks;
  }

  std::string address_;
  InvitationKeys keys_;
  Context context_;
  Loop loop_;
  op::Joiner joiner_;
  op::DoorCall call_;
  op::JoinPatience patience_;
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
  const std::string dir = plain_folder(arguments.words[0]);
  if (arguments.has("--at") && !is_numeric_endpoint(arguments.get("--at")))
    return print_error(arguments, fail(Errc::bad_value, "--at: '" + arguments.get("--at") + "' is no numeric HOST:PORT",
                                       "write it as 10.0.0.1:45000"));
  const auto code = read_join_code(code_text(arguments));
  if (!code) return print_error(arguments, code.error());
  if (const Status there = find_node_json(dir, "the code is a robot's, so make the folder first: trb node new " + dir);
      !there && (code->role == Role::robot || there.error().code != Errc::missing)) {
    return print_error(arguments, there.error());
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
        "As a\n"
        "word it is in the shell's history and in ps. May be stopped and repeated.",
        {"--at HOST:PORT|where the cloud node is dialled, from now on, if not where the code says",
         "--timeout S|how long to try until the cloud node answers (30)",
         "--network NAME|of a cloud node's folder that is made: interface or address on the fleet's network", kJson},
        {"trb node join nodes/arm1 3F2KQ-...", "trb node join nodes/arm1"},
        1,
        40},
       run_join}};
}

}  // namespace trb::cli
