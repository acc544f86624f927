#include "common/scenario/run_proof_file.hpp"

#include "common/base/hex.hpp"
#include "common/scenario/run_proof.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

/// Of a file: 4000 records of the largest run.
constexpr ParseLimits kFileLimits{64U << 20U, 64, 4'000'000};

std::string quoted(std::string_view text) {
  return dump_json(Value{std::string(text)});
}

std::string json_of(const SignedRecord& record) {
  const auto content = content_of(record);
  return "{\"kind\":" + quoted(record.kind) + ",\"signer\":" + quoted(record.signer) + ",\"payload\":\"" +
         to_hex(record.payload.bytes) + "\",\"signature\":\"" + to_hex(record.signature.bytes) +
         "\",\"content\":" + (content ? *content : "{}") + "}";
}

Result<std::string> text_of(const Value& row, std::string_view name) {
  const Value* found = row.find(name);
  if (found != nullptr && found->is_text()) return found->text();
  return fail(Errc::malformed, std::string(name) + ": is missing, or no text");
}

Result<Bytes> bytes_of(const Value& row, std::string_view name) {
  const auto text = text_of(row, name);
  if (!text) return text.error();
  auto bytes = from_hex(*text);
  if (!bytes) return fail(Errc::malformed, std::string(name) + ": is not hexadecimal");
  return bytes;
}

/// A reader looks at the content: it must be what was signed.
Status check_content(const Value& row, const SignedRecord& record) {
  const Value* shown = row.find("content");
  if (shown == nullptr) return Done{};
  const auto content = content_of(record);
  if (!content) return content.error();
  const auto value = parse_json(*content, kFileLimits);
  if (value && *value == *shown) return Done{};
  return fail(Errc::bad_value, "content: is not what was signed");
}

Result<SignedRecord> record_of(const Value& row) {
  if (!row.is_object()) return fail(Errc::malformed, "is no object");
  SignedRecord out;
  auto kind = text_of(row, "kind");
  auto signer = text_of(row, "signer");
  auto payload = bytes_of(row, "payload");
  auto signature = bytes_of(row, "signature");
  if (!kind) return kind.error();
  if (!signer) return signer.error();
  if (!payload) return payload.error();
  if (!signature) return signature.error();
  out.kind = std::move(*kind);
  out.signer = std::move(*signer);
  out.payload.bytes = std::move(*payload);
  out.signature.bytes = std::move(*signature);
  if (auto checked = check_content(row, out); !checked) return checked.error();
  return out;
}

}  // namespace

std::string write_run_proof(const std::string& run, std::span<const SignedRecord> records,
                            const FleetAuthority& authority) {
  const bool is_complete = check_run_proof(records, authority).is_complete();
  std::string out = "{\"run\":" + quoted(run) + ",\"fleet\":\"" + to_hex(authority.id()) + "\",\"authority\":\"" +
                    to_hex(authority.public_key) + "\",\"complete\":" + (is_complete ? "true" : "false") +
                    ",\"records\":[";
  for (std::size_t i = 0; i < records.size(); ++i) out += (i == 0 ? "" : ",") + json_of(records[i]);
  return out + "]}";
}

Result<std::vector<SignedRecord>> read_run_proof(std::string_view json) {
  const auto file = parse_json(json, kFileLimits);
  if (!file) return file.error();
  const Value* rows = file->is_object() ? file->find("records") : nullptr;
  if (rows == nullptr || !rows->is_list()) {
    return fail(Errc::malformed, "records: is missing, or no list",
                "give the file of trb run proof, or of the gateway");
  }
  std::vector<SignedRecord> out;
  for (const Value& row : rows->list()) {
    auto record = record_of(row);
    if (!record) {
      return fail(record.error().code, "records[" + std::to_string(out.size()) + "]: " + record.error().what);
    }
    out.push_back(std::move(*record));
  }
  return out;
}

}  // namespace trb
