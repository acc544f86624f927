#include "common/security/certificate_file.hpp"

#include <sodium.h>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

const unsigned char* raw(BytesView bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}
unsigned char* raw(Bytes& bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}

Result<Bytes> hex_member(const Value& json, std::string_view key, std::size_t size) {
  const Value* member = json.find(key);
  if (member == nullptr || !member->is_text()) return fail(Errc::missing, std::string(key) + ": missing");
  auto bytes = from_hex(member->text());
  if (!bytes || bytes->size() != size)
    return fail(Errc::malformed, std::string(key) + ": not " + std::to_string(size) + " bytes");
  return bytes;
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
  auto sealed = hex_member(json, "sealed_beacon_key", 32 + crypto_box_SEALBYTES);
  if (!sealed) return sealed.error();
  file.sealed_beacon = std::move(*sealed);
  return file;
}

}  // namespace

CertificateFile make_certificate_file(const SignedRecord& certificate, const FleetAuthority& authority,
                                      const BeaconKey& beacon, BytesView link_key) {
  Bytes sealed(beacon.secret.size() + crypto_box_SEALBYTES, '\0');
  crypto_box_seal(raw(sealed), raw(beacon.secret), beacon.secret.size(), raw(link_key));
  return {certificate, authority, beacon.number, std::move(sealed)};
}

std::string certificate_file_to_json(const CertificateFile& file) {
  Value::Object out;
  out.emplace_back("fleet", Value{file.authority.name});
  out.emplace_back("authority_key", Value{to_hex(file.authority.public_key)});
  out.emplace_back("certificate", *parse_json(to_json(file.certificate)));
  out.emplace_back("beacon_key_number", Value{static_cast<std::int64_t>(file.beacon_number)});
  out.emplace_back("sealed_beacon_key", Value{to_hex(file.sealed_beacon)});
  return dump_json(Value{std::move(out)}) + "\n";
}

Result<CertificateFile> read_certificate_file(const std::string& path) {
  auto text = read_file(path, 65536);
  if (!text) {
    return fail(text.error().code, text.error().what, "run trb fleet sign with this node's keys/request.json");
  }
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, path + ": " + json.error().what, json.error().cure);
  auto file = parse(*json);
  if (!file) return fail(file.error().code, path + ": " + file.error().what, "run trb fleet sign again");
  return file;
}

Result<BeaconKey> open_beacon_key(const CertificateFile& file, const LinkKey& link) {
  BeaconKey key{file.beacon_number, Bytes(32, '\0')};
  if (file.sealed_beacon.size() != 32 + crypto_box_SEALBYTES ||
      crypto_box_seal_open(raw(key.secret), raw(file.sealed_beacon), file.sealed_beacon.size(), raw(link.public_key),
                           raw(link.secret_key)) != 0) {
    return fail(Errc::wrong_key, "the beacon key in certificate.json was sealed for another node",
                "run trb fleet sign again");
  }
  return key;
}

}  // namespace trb
