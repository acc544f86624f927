// The audit log: who did what. Each record's hash covers the one before.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"

namespace trb {

/// What a gateway records first whose store comes from a backup. Its number is its time in ms: no log grows by a
/// thousand records a second, so what was recorded since the backup, and is lost, has numbers of its own; also if the
/// same backup is brought back twice.
constexpr std::string_view kAuditRestored = "restored";

/// Who did what; the chain sets the number.
struct AuditRecord {
  std::uint64_t number = 0;  ///< from 1, without gaps but before kAuditRestored
  std::int64_t time = 0;     ///< UTC ns, as the clock was; `number` gives the order
  std::string who;           ///< "ann", "token:exporter"; for a refused sign-in: the name given
  std::string from;          ///< address
  std::string action;        ///< "POST /api/v1/runs/{run}/abort"
  std::string about;         ///< "run-17"
  std::string outcome;       ///< "done", or the problem's code
  bool operator==(const AuditRecord&) const = default;
  template <class T = AuditRecord>
  static FieldTable fields() {
    return FieldTable{field("number", &T::number),      field("time", &T::time),         field("who", &T::who, 80),
                      field("from", &T::from, 80),      field("action", &T::action, 96), field("about", &T::about, 255),
                      field("outcome", &T::outcome, 96)};
  }
};

/// A record as it is stored.
struct AuditRow {
  AuditRecord record;
  Bytes hash;
  bool operator==(const AuditRow&) const = default;
};

/// What number it has behind this one.
std::uint64_t next_audit_number(std::uint64_t last, const AuditRecord& record);

/// The last record of a chain. The node's router signs the payload with purpose kSignedAuditHead.
struct AuditHead {
  Blob start;                ///< audit_start(): identifies the chain
  std::uint64_t number = 0;  ///< of the last record; 0: none yet
  Blob hash;
  std::int64_t time = 0;  ///< UTC ns
  bool operator==(const AuditHead&) const = default;
  template <class T = AuditHead>
  static FieldTable fields() {
    return FieldTable{field("start", &T::start, 32), field("number", &T::number), field("hash", &T::hash, 32),
                      field("time", &T::time)};
  }
};

Bytes audit_head_payload(const AuditHead& head);
/// Errors: malformed, too_large, bad_value.
Result<AuditHead> read_audit_head(BytesView payload);

/// The hash before the first record. It differs for each node and fleet, so no row of another chain fits.
Bytes audit_start(BytesView fleet, std::string_view node);
/// BLAKE2b over the previous hash and the record's msgpack, for this purpose alone.
Bytes audit_hash(BytesView previous, const AuditRecord& record);
/// All texts are UTF-8 and within their bounds. The msgpack of any other record would leave a part unhashed.
bool is_canonical(const AuditRecord& record);

class AuditChain {
 public:
  explicit AuditChain(Bytes start);
  /// Continues after the last stored row.
  AuditChain(Bytes start, const AuditRow& last);

  /// Sets the record's number, cuts texts that are too long, and hashes the record. Store the row before you answer the
  /// request that it records.
  AuditRow append(AuditRecord record);
  [[nodiscard]] AuditHead head(UtcTime now) const;
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  Bytes start_;
  Bytes hash_;
  std::uint64_t number_ = 0;
};

}  // namespace trb
