#include "services/cli/io/join_folder.hpp"

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/security/bus_keys.hpp"
#include "common/security/invitation.hpp"
#include "common/security/node_keys.hpp"
#include "proto/body.hpp"
#include "services/cli/io/folder_owner.hpp"

namespace trb::cli {
namespace {

std::string certificate_path(const std::string& dir) {
  return dir + "/keys/certificate.json";
}

Result<std::string> text_in(const Value& json, const std::string& key, const std::string& otherwise) {
  const Value* member = json.find(key);
  if (member == nullptr) return otherwise;
  if (member->is_text()) return member->text();
  return fail(Errc::bad_value, "node.json: " + key + ": needs text", "put it in quotes");
}

Result<Value> node_json(const std::string& dir, const JoinOffer& invited) {
  const auto text = read_file(dir + "/node.json");
  if (!text && text.error().code != Errc::missing) return text.error();
  if (!text) {
    return fail(
        Errc::missing, dir + ": no node.json there",
        "make the folder first: trb node new " + dir + " --robot " + invited.name + " --like KIND --address HOST");
  }
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, dir + "/node.json: " + json.error().what, json.error().hint);
  return json;
}

/// A member of another fleet is not moved by a mistyped command.
Status check_fleet(const std::string& dir, const JoinOffer& invited) {
  const std::string path = certificate_path(dir);
  if (!file_exists(path)) return Done{};
  const auto file = read_certificate_file(path);
  if (!file || same_bytes(file->authority.public_key, invited.authority_key.bytes)) return Done{};
  return fail(Errc::conflict, dir + " is a member of the fleet '" + file->authority.name + "'",
              "to move it: remove " + path + " and " + dir + "/state, then join again with a fresh code");
}

Status make_keys_of_bus(const std::string& dir) {
  auto bus = read_bus(dir);
  if (!bus) return bus.error();
  return bus->empty() ? Status(Done{}) : make_bus_keys(dir, bus_names(check_node_dir(dir, true).config));
}

}  // namespace

Status check_join(const std::string& dir, const JoinOffer& invited) {
  const auto json = node_json(dir, invited);
  if (!json) return json.error();
  const auto id = text_in(*json, "id", "");
  const auto role = text_in(*json, "role", "robot");
  if (!id || !role) return (id ? role : id).error();
  if (*id != invited.name) {
    return fail(Errc::conflict, dir + "/node.json: id: is '" + *id + "', the code is for '" + invited.name + "'",
                "name that node's folder, or have a code made for '" + *id + "'");
  }
  if (*role != name_of(invited.role)) {
    return fail(Errc::conflict,
                dir + "/node.json: role: is '" + *role + "', the code is for a " + std::string(name_of(invited.role)),
                "correct \"role\", or have a code made with --role " + *role);
  }
  return check_fleet(dir, invited);
}

Result<SignedRecord> request_of(const std::string& dir, const JoinOffer& invited) {
  if (Status made = make_request(dir, invited.name, invited.role); !made) return made.error();
  if (Status keys = make_keys_of_bus(dir); !keys) return keys.error();
  const auto text = read_file(dir + "/keys/request.json", 65536);
  if (!text) return text.error();
  return from_json<SignedRecord>(*text);
}

Result<CertificateFile> certificate_of(const std::string& dir, const JoinOffer& offer) {
  CertificateFile file;
  file.certificate = offer.certificate;
  file.authority = {offer.fleet, offer.authority_key.bytes};
  file.beacon_number = offer.beacon_number;
  file.sealed_beacon = offer.sealed_beacon.bytes;
  file.revocations = offer.revocations;
  file.seeds = offer.seeds;
  const auto certificate = open_certificate_any_time(file.certificate, file.authority);
  if (!certificate) return certificate.error();
  const auto wanted = request_of(dir, offer);
  if (!wanted) return wanted.error();
  const auto own = decode<CertificateRequest>(wanted->payload.bytes);
  if (!own) return own.error();
  const bool for_us = certificate->id == own->id && certificate->role == own->role &&
                      same_bytes(certificate->identity_key.bytes, own->identity_key.bytes) &&
                      same_bytes(certificate->link_key.bytes, own->link_key.bytes);
  if (!for_us) return fail(Errc::wrong_key, "the certificate that came is not for the keys in " + dir + "/keys");
  const auto link = read_link_key(dir + "/keys/link.key");
  if (!link) return link.error();
  if (const auto beacon = open_beacon_key(file, *link); !beacon) return beacon.error();
  return file;
}

Status take_certificate(const std::string& dir, const JoinOffer& offer) {
  const auto file = certificate_of(dir, offer);
  if (!file) return file.error();
  const Status written = write_file(certificate_path(dir), certificate_file_to_json(*file));
  if (written) give_keys_to_owner(dir);
  return written;
}

}  // namespace trb::cli
