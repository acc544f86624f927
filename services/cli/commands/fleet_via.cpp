#include "services/cli/commands/fleet_via.hpp"

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"
#include "common/security/revocations.hpp"
#include "common/security/signing_clock.hpp"
#include "common/security/stored_updates.hpp"
#include "proto/body.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

/// Errors: those of reading, but missing: such a node knows nothing.
Status read_known(const std::string& via, const FleetAuthority& fleet, TrustUpdate& known) {
  auto stored = read_stored_updates(via, fleet);
  if (!stored) return stored.error();
  known = std::move(stored->update);
  const std::string own_path = via + "/keys/certificate.json";
  const auto own = read_certificate_file(own_path);
  if (!own && (own.error().code != Errc::missing || file_exists(own_path))) return own.error();
  if (own) known.certificates.push_back(own->certificate);
  return Done{};
}

/// The working directory, as it was before a probe took the node's folder for it.
class KeptDirectory {
 public:
  KeptDirectory() : path_(std::filesystem::current_path(none_)) {}
  KeptDirectory(const KeptDirectory&) = delete;
  KeptDirectory& operator=(const KeptDirectory&) = delete;
  ~KeptDirectory() { std::filesystem::current_path(path_, none_); }

 private:
  std::error_code none_;
  std::filesystem::path path_;
};

/// What a router has in its table was shown by its owner. A node that is down shows none: what is signed is handed to
/// it later, and says then that it is down.
void ask_for_shown(const std::string& via, const FleetAuthority& fleet, TrustUpdate& known) {
  const KeptDirectory kept;
  auto probe = Probe::open(via);
  if (!probe) return;
  const auto table = (*probe)->routes();
  if (!table) return;
  for (const Route& route : table->routes) {
    // Of another fleet's authority the router has none; what it may have mistaken must not stop a revocation.
    if (open_certificate_any_time(route.certificate, fleet)) known.certificates.push_back(route.certificate);
  }
}

std::optional<UtcTime> noted_time(const std::string& via) {
  const auto text = read_file(via + "/state/utc", 64);
  if (!text) return std::nullopt;
  const auto ns = parse_number<std::int64_t>(std::string_view(*text).substr(0, text->find('\n')));
  return ns ? std::optional(UtcTime{*ns}) : std::nullopt;
}

/// What a certificate of another fleet is told to do: it makes a member of another fleet's node, who asks for none.
Error of_another_fleet(const std::string& via, const std::string& dir) {
  return fail(
      Errc::foreign_fleet, "--via " + via + ": a node of another fleet than that of " + dir,
      "name the folder of a node of this fleet (trb fleet show NODE_DIR says which), or that fleet's authority");
}

}  // namespace

Status check_via(const Arguments& arguments) {
  const std::string via = arguments.get("--via");
  if (via.empty()) return Done{};
  const Status there = find_node_json(via, "name the folder of a node that is up");
  return there ? there : fail(there.error().code, "--via " + there.error().what, there.error().hint);
}

Result<Learned> learn_from(Authority& authority, const Arguments& arguments, const std::string& via) {
  if (via.empty()) return Learned{};
  TrustUpdate known;
  // To take it for a node that knows nothing would make who was revoked after the copy a member again.
  if (Status read = read_known(via, authority.fleet, known); !read) {
    return fail(read.error().code, "what " + via + " knows cannot be read: " + read.error().what,
                "run this as the node's user, or name another node with --via; to mend that one: " + read.error().hint);
  }
  ask_for_shown(via, authority.fleet, known);
  const std::string& dir = arguments.words[0];
  auto learned = catch_up(authority, dir, known);
  if (!learned && learned.error().code == Errc::foreign_fleet) return of_another_fleet(via, dir);
  if (!learned) return learned.error();
  const std::string note = "note: " + dir + " was older than what " + via + " knows; taken over from there";
  if (*learned && arguments.has("--json")) print_problem(note + "\n");
  if (*learned && !arguments.has("--json")) print_line(note);
  return Learned{*learned, noted_time(via)};
}

Status check_clock(const Arguments& arguments, const Authority& authority, const Learned& learned, UtcTime now) {
  return arguments.has("--trust-clock") ? Status(Done{}) : check_signing_clock(authority, learned.utc, now);
}

}  // namespace trb::cli
