#include "common/security/certificate_file.hpp"

#include <sodium.h>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

Result<Bytes> hex_member(const Value& json, std::string_view key, std::size_t size) {
  const Value* member = json.find(key);
  if (member == nullptr || !member->is_text()) return fail(Errc::missing, std::string(key) + ": missing");
  auto bytes = from_hex(member->text());
  if (!bytes || bytes->size() != size)
    return fail(Errc::malformed, std::string(key) + ": not " + std::to_string(size) + " bytes");
  return bytes;
}

Result<std::vector<FleetSeed>> seeds_in(const Value& json) {
  std::vector<FleetSeed> out;
  const Value* seeds = json.find("seeds");
  if (seeds == nullptr) return out;
  if (!seeds->is_list() || seeds->list().size() > kMaxFleetSeeds)
    return fail(Errc::malformed, "seeds: no list of " + std::to_string(kMaxFleetSeeds) + " at most");
  for (const Value& seed : seeds->list()) {
    const Value* address = seed.find("address");
    if (address == nullptr || !address->is_text() || !is_numeric_endpoint(address->text()))
      return fail(Errc::malformed, "seeds: address: no numeric HOST:PORT");
    auto key = hex_member(seed, "key", 32);
    if (!key) return fail(key.error().code, "seeds: " + key.error().what);
    out.push_back({address->text(), {std::move(*key)}});
  }
  return out;
}

Result<CertificateFile> parse(const Value& json) {
  CertificateFile file;
  const Value* record = json.find("certificate");
  if (record == nullptr) return fail(Errc::missing, "certificate: missing");
  auto certificate = from_json<SignedRecord>(dump_json(*record));
  if (!certificate) return certificate.error();
  file.certificate = std::move(*certificate);
  auto key = hex_member(json, "authority_key", 32);
  if (!key) return key.error();
  file.authority.public_key = std::move(*key);
  if (const Value* name = json.find("fleet"); name != nullptr && name->is_text()) file.authority.name = name->text();
  const Value* number = json.find("beacon_key_number");
  if (number == nullptr || !number->is_integer()) return fail(Errc::missing, "beacon_key_number: missing");
  file.beacon_number = static_cast<std::uint32_t>(number->integer());
  constexpr std::size_t kSealedSize = 32 + crypto_box_SEALBYTES;
  auto sealed = hex_member(json, "sealed_beacon_key", kSealedSize);
  if (!sealed) return sealed.error();
  file.sealed_beacon = std::move(*sealed);
  if (const Value* list = json.find("revocations"); list != nullptr) {
    auto revocations = from_json<SignedRecord>(dump_json(*list));
    if (!revocations) return revocations.error();
    file.revocations = std::move(*revocations);
  }
  auto seeds = seeds_in(json);
  if (!seeds) return seeds.error();
  file.seeds = std::move(*seeds);
  return file;
}

}  // namespace

CertificateFile make_certificate_file(const SignedRecord& certificate, const FleetAuthority& authority,
                                      const BeaconKey& beacon, BytesView link_key) {
  return {certificate, authority, beacon.number, seal_beacon_key(beacon, link_key), {}, {}};
}

std::string certificate_file_to_json(const CertificateFile& file) {
  Value::Object out;
  out.emplace_back("fleet", Value{file.authority.name});
  out.emplace_back("authority_key", Value{to_hex(file.authority.public_key)});
  out.emplace_back("certificate", *parse_json(to_json(file.certificate)));
  out.emplace_back("beacon_key_number", Value{static_cast<std::int64_t>(file.beacon_number)});
  out.emplace_back("sealed_beacon_key", Value{to_hex(file.sealed_beacon)});
  if (!file.revocations.kind.empty()) out.emplace_back("revocations", *parse_json(to_json(file.revocations)));
  Value::List seeds;
  for (const FleetSeed& seed : file.seeds) {
    seeds.push_back(Value{Value::Object{{"address", Value{seed.address}}, {"key", Value{to_hex(seed.key.bytes)}}}});
  }
  if (!seeds.empty()) out.emplace_back("seeds", Value{std::move(seeds)});
  return dump_json(Value{std::move(out)}) + "\n";
}

Result<CertificateFile> certificate_file_from_json(std::string_view text) {
  auto json = parse_json(text);
  if (!json) return json.error();
  auto file = parse(*json);
  if (!file) return fail(file.error().code, file.error().what, "run trb fleet sign again");
  return file;
}

Result<CertificateFile> read_certificate_file(const std::string& path) {
  auto text = read_file(path);
  if (!text) {
    const bool missing = text.error().code == Errc::missing;
    return fail(text.error().code, text.error().what,
                missing ? "run trb fleet sign with this node's keys/request.json" : text.error().hint);
  }
  auto file = certificate_file_from_json(*text);
  if (!file) return fail(file.error().code, path + ": " + file.error().what, file.error().hint);
  return file;
}

Result<BeaconKey> open_beacon_key(const CertificateFile& file, const LinkKey& link) {
  return open_sealed_beacon_key(file.beacon_number, file.sealed_beacon, link);
}

}  // namespace trb
