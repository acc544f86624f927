// fleet init, request, sign, show.
#include <filesystem>
#include <map>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/config/node_config.hpp"
#include "common/security/authority.hpp"
#include "common/security/bus_keys.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/node_keys.hpp"
#include "common/security/revocations.hpp"
#include "common/transport/loop.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/fleet_via.hpp"
#include "services/cli/commands/relay_right.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/fleet_lock.hpp"
#include "services/cli/io/folder_owner.hpp"
#include "services/cli/io/passphrase.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

int run_init(const Arguments& arguments) {
  init_crypto();
  auto secret = ask_for_passphrase(arguments, true);
  if (!secret) return print_error(arguments, secret.error());
  const std::string dir = arguments.words[0];
  auto authority = make_authority(dir, arguments.get("--name", "fleet"), *secret);
  if (!authority) return print_error(arguments, authority.error());
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{
        {"dir", Value{dir}}, {"name", Value{authority->fleet.name}}, {"fleet", Value{to_hex(authority->fleet.id())}}}});
    return kGood;
  }
  print_line("made the fleet '" + authority->fleet.name + "', id " + to_hex(authority->fleet.id()) + ", in " + dir);
  print_line("keep this folder off every node, and a copy of it and of the passphrase in a safe place");
  return kGood;
}

Result<std::string> text_member(const Value& json, const std::string& key, const std::string& otherwise) {
  const Value* member = json.find(key);
  if (member == nullptr) return otherwise;
  if (!member->is_text()) return fail(Errc::bad_value, "node.json: " + key + ": needs text", "put it in quotes");
  return member->text();
}

/// If its bus is over TCP: a key for each service, and for trb.
Status make_keys_of_bus(const std::string& dir) {
  auto bus = read_bus(dir);
  if (!bus) return bus.error();
  return bus->empty() ? Status(Done{}) : make_bus_keys(dir, bus_names(check_node_dir(dir, true).config));
}

int run_fleet_request(const Arguments& arguments) {
  init_crypto();
  const std::string dir = arguments.words[0];
  auto file = read_file(dir + "/node.json");
  if (!file) {
    const bool missing = file.error().code == Errc::missing;
    return print_error(arguments,
                       fail(file.error().code, file.error().what,
                            missing ? "write node.json first: its id goes into the request" : file.error().hint));
  }
  auto json = parse_json(*file);
  if (!json)
    return print_error(arguments, fail(json.error().code, dir + "/node.json: " + json.error().what, json.error().hint));
  auto id = text_member(*json, "id", "");
  auto role = text_member(*json, "role", "robot");
  if (!id || !role) return print_error(arguments, (id ? role : id).error());
  if (*role != "robot" && *role != "cloud")
    return print_error(arguments, fail(Errc::bad_value, "node.json: role: '" + *role + "'", "use robot or cloud"));
  if (Status good = check_id("id", *id); !good)
    return print_error(arguments, fail(good.error().code, dir + "/node.json: " + good.error().what, good.error().hint));
  const Status made = make_request(dir, *id, *role == "cloud" ? Role::cloud : Role::robot);
  if (!made) return print_error(arguments, made.error());
  if (const Status keys = make_keys_of_bus(dir); !keys) return print_error(arguments, keys.error());
  give_keys_to_owner(dir);
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"request", Value{dir + "/keys/request.json"}}}});
    return kGood;
  }
  print_line("wrote " + dir + "/keys/request.json; the secret keys stay in " + dir + "/keys");
  print_line("next, where the authority's folder is: trb fleet sign FLEET_DIR " + dir + "/keys/request.json");
  return kGood;
}

Result<CertificateFile> sign_file(Authority& authority, const Arguments& arguments, const std::string& path) {
  auto text = read_file(path, 65536);
  if (!text)
    return fail(text.error().code, text.error().what, "name a request.json that trb fleet request has written");
  auto record = from_json<SignedRecord>(*text);
  if (!record) return fail(record.error().code, path + ": " + record.error().what, "run trb fleet request again");
  const auto days = arguments.number("--days", 365, kMostDays);
  if (!days) return days.error();
  const auto relay = relay_right(arguments);
  if (!relay) return relay.error();
  return sign_request(authority, arguments.words[0], *record, read_clocks().utc, seconds(*days * 86400), *relay);
}

/// A clock that is wrong shows in them.
std::string dates_of(const CertificateFile& file) {
  const auto certificate = decode<Certificate>(file.certificate.payload.bytes);
  if (!certificate) return "";
  return ": serial " + std::to_string(certificate->serial) + ", valid from " + to_iso8601({certificate->not_before}) +
         " to " + to_iso8601({certificate->not_after});
}

/// The certificate's file: beside its request.
std::string certificate_beside(const std::string& request) {
  const auto slash = request.rfind('/');
  return (slash == std::string::npos ? "" : request.substr(0, slash + 1)) + "certificate.json";
}

/// The second certificate would overwrite the first one. Errors: conflict.
Status check_places(const Arguments& arguments) {
  std::map<std::string, std::string> taken;  // request, by the certificate's place
  for (std::size_t i = 1; i < arguments.words.size(); ++i) {
    const std::string out = certificate_beside(arguments.words[i]);
    std::error_code none;
    const std::string place = std::filesystem::weakly_canonical(std::filesystem::absolute(out, none), none).string();
    const auto [at, is_free] = taken.emplace(place, arguments.words[i]);
    if (is_free) continue;
    return fail(Errc::conflict, at->second + " and " + arguments.words[i] + ": both certificates would be " + out,
                "put each request into a folder of its own");
  }
  return Done{};
}

int run_sign(const Arguments& arguments) {
  init_crypto();
  if (Status good = check_places(arguments); !good) return print_error(arguments, good.error());
  if (Status node = check_via(arguments); !node) return print_error(arguments, node.error());
  auto secret = ask_for_passphrase(arguments, false);
  if (!secret) return print_error(arguments, secret.error());
  const auto lock = FleetLock::take(arguments.words[0]);
  if (!lock) return print_error(arguments, lock.error());
  auto authority = open_authority(arguments.words[0], *secret);
  if (!authority) return print_error(arguments, authority.error());
  const auto learned = learn_from(*authority, arguments, arguments.get("--via"));
  if (!learned) return print_error(arguments, learned.error());
  if (Status right = check_clock(arguments, *authority, *learned, read_clocks().utc); !right)
    return print_error(arguments, right.error());
  Value::List written_to;
  for (std::size_t i = 1; i < arguments.words.size(); ++i) {
    const std::string& path = arguments.words[i];
    auto signed_file = sign_file(*authority, arguments, path);
    if (!signed_file) return print_error(arguments, signed_file.error());
    const std::string out = certificate_beside(path);
    // For anybody to read: it holds no secret, and is carried to the node as another user than the node's.
    if (Status written = write_file(out, certificate_file_to_json(*signed_file), 0644); !written)
      return print_error(arguments, written.error());
    if (!arguments.has("--json")) print_line("wrote " + out + dates_of(*signed_file));
    written_to.push_back(Value{out});
  }
  if (arguments.has("--json")) print_json(Value{Value::Object{{"certificates", Value{std::move(written_to)}}}});
  return kGood;
}

int show_certificate(const Arguments& arguments, const std::string& path) {
  auto file = read_certificate_file(path);
  if (!file) return print_error(arguments, file.error());
  auto certificate = open_certificate_any_time(file->certificate, file->authority);
  if (!certificate) return print_error(arguments, certificate.error());
  if (arguments.has("--json")) {
    print_line(to_json(*certificate));
    return kGood;
  }
  print_line("node      " + certificate->id + " (" + std::string(name_of(certificate->role)) + ")");
  print_line("fleet     " + file->authority.name + ", id " + to_hex(certificate->fleet.bytes));
  print_line("serial    " + std::to_string(certificate->serial));
  print_line("valid     " + to_iso8601({certificate->not_before}) + " to " + to_iso8601({certificate->not_after}));
  print_line("link key  " + to_hex(certificate->link_key.bytes) + "   (the \"key\" of a seed)");
  print_line("identity  " + to_hex(certificate->identity_key.bytes));
  if (certificate->relay) print_line("may relay between members that cannot reach each other");
  return kGood;
}

std::string_view state_of(const Authority& authority, const Certificate& certificate, UtcTime now) {
  if (find_ever_revoked(authority, certificate) != nullptr) return "revoked";
  if (now.ns > certificate.not_after) return "expired";
  return now.ns < certificate.not_before ? "not yet valid" : "valid";
}

using Newest = std::map<std::string, const Certificate*>;  ///< by node

Newest newest_certificates(const Authority& authority) {
  Newest newest;
  for (const Certificate& certificate : authority.issued) {
    const Certificate*& kept = newest[certificate.id];
    if (kept == nullptr || kept->serial < certificate.serial) kept = &certificate;
  }
  return newest;
}

using Unknown = std::map<std::string, const Revocation*>;  ///< by node

/// Who was revoked, and has no certificate in this folder: it was restored from an older copy.
Unknown unknown_revoked(const Authority& authority, const Newest& newest) {
  Unknown unknown;
  for (const auto* entries : {&authority.list.revoked, &authority.revoked}) {
    for (const Revocation& entry : *entries) {
      if (newest.count(entry.id) != 0) continue;
      const Revocation*& kept = unknown[entry.id];
      if (kept == nullptr || kept->serial < entry.serial) kept = &entry;
    }
  }
  return unknown;
}

std::string end_of(const Revocation& entry) {
  return entry.until == 0 ? "" : to_iso8601({entry.until});
}

Value to_value(const Revocation& entry) {
  return Value{Value::Object{{"id", Value{entry.id}},
                             {"role", Value{std::string()}},
                             {"serial", Value{static_cast<std::int64_t>(entry.serial)}},
                             {"state", Value{std::string("revoked")}},
                             {"valid_to", Value{end_of(entry)}}}};
}

Value to_value(const Authority& authority, const Certificate& certificate, UtcTime now) {
  return Value{Value::Object{{"id", Value{certificate.id}},
                             {"role", Value{std::string(name_of(certificate.role))}},
                             {"serial", Value{static_cast<std::int64_t>(certificate.serial)}},
                             {"state", Value{std::string(state_of(authority, certificate, now))}},
                             {"valid_to", Value{to_iso8601({certificate.not_after})}}}};
}

void print_fleet_json(const Authority& authority, const Newest& newest, UtcTime now) {
  Value::List nodes;
  for (const auto& [id, certificate] : newest) nodes.push_back(to_value(authority, *certificate, now));
  for (const auto& [id, entry] : unknown_revoked(authority, newest)) nodes.push_back(to_value(*entry));
  print_json(Value{Value::Object{{"name", Value{authority.fleet.name}},
                                 {"fleet", Value{to_hex(authority.fleet.id())}},
                                 {"authority_key", Value{to_hex(authority.fleet.public_key)}},
                                 {"revocation_list", Value{static_cast<std::int64_t>(authority.list.number)}},
                                 {"beacon_key", Value{static_cast<std::int64_t>(authority.beacon.number)}},
                                 {"nodes", Value{std::move(nodes)}}}});
}

/// The fleet, and the newest certificate of every node.
void show_fleet(const Arguments& arguments, const Authority& authority, UtcTime now) {
  const Newest newest = newest_certificates(authority);
  if (arguments.has("--json")) return print_fleet_json(authority, newest, now);
  std::vector<std::vector<std::string>> rows{{"NODE", "ROLE", "SERIAL", "CERTIFICATE", "VALID TO"}};
  for (const auto& [id, certificate] : newest) {
    rows.push_back({id, std::string(name_of(certificate->role)), std::to_string(certificate->serial),
                    std::string(state_of(authority, *certificate, now)), to_iso8601({certificate->not_after})});
  }
  for (const auto& [id, entry] : unknown_revoked(authority, newest)) {
    const std::string end = end_of(*entry);
    rows.push_back({id, "-", std::to_string(entry->serial), "revoked", end.empty() ? "-" : end});
  }
  print_line("fleet            " + authority.fleet.name + ", id " + to_hex(authority.fleet.id()));
  print_line("authority key    " + to_hex(authority.fleet.public_key));
  print_line("revocation list  " + (authority.list.number == 0 ? "none" : std::to_string(authority.list.number)) +
             ", beacon key " + std::to_string(authority.beacon.number));
  print("\n" + format_table(rows));
}

int run_show(const Arguments& arguments) {
  init_crypto();
  const std::string& path = arguments.words[0];
  if (file_exists(path + "/keys/certificate.json")) return show_certificate(arguments, path + "/keys/certificate.json");
  if (!file_exists(path + "/fleet.json")) {
    std::error_code none;
    if (std::filesystem::is_regular_file(path, none)) return show_certificate(arguments, path);
    return print_error(arguments,
                       fail(Errc::missing, path + ": no fleet.json, keys/certificate.json or certificate there",
                            "name the folder of trb fleet init, or a node's folder after trb fleet sign"));
  }
  auto authority = read_authority(path);
  if (!authority) return print_error(arguments, authority.error());
  show_fleet(arguments, *authority, read_clocks().utc);
  return kGood;
}

const std::vector<Command> kFleetCommands = {
    {{"fleet", "init"},
     {"fleet init FLEET_DIR",
      "Makes a fleet: its authority's key, encrypted with a passphrase, and its beacon key.",
      {"--name NAME|the fleet's name (fleet)", kPassphrase, kJson},
      {"trb fleet init ~/hall-3-authority --name hall3"},
      1,
      1},
     run_init},
    {{"fleet", "request"},
     {"fleet request NODE_DIR",
      "Makes the node's keys, which stay there, and a request to be signed.",
      {kJson},
      {"trb fleet request nodes/ur3"},
      1,
      1},
     run_fleet_request},
    {{"fleet", "sign"},
     {"fleet sign FLEET_DIR REQUEST ...",
      "Signs requests; writes the certificate beside each, as certificate.json.",
      {"--days N|how long the certificate is valid (365)", kRelay, kNoRelay,
       "--via NODE_DIR|first take over what this node, which is up, knows: for a folder restored from a copy",
       kTrustClock, kPassphrase, kJson},
      {"trb fleet sign ~/hall-3-authority nodes/*/keys/request.json"},
      2,
      1000},
     run_sign},
    {{"fleet", "show"},
     {"fleet show PATH",
      "Shows a fleet's folder with its nodes, a node's folder or a certificate file.",
      {kJson},
      {"trb fleet show nodes/ur3", "trb fleet show ~/hall-3-authority --json"},
      1,
      1},
     run_show},
};

}  // namespace

std::vector<Command> fleet_commands() {
  return kFleetCommands;
}

}  // namespace trb::cli
