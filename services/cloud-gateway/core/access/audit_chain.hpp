// The audit: who did what, each record hashed with the one before.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/field.hpp"

namespace trb::gateway {

/// Who did what; the chain gives it its number.
struct AuditRecord {
  std::uint64_t number = 0;  ///< from 1, none left out
  std::int64_t time = 0;     ///< UTC ns, as the clock was: the order is the numbers'
  std::string who;           ///< "ann", "token:exporter"; the name that was given, of a sign-in that was refused
  std::string from;          ///< address
  std::string action;        ///< "POST /api/v1/runs/{run}/abort"
  std::string about;         ///< "run-17"
  std::string outcome;       ///< "done", or the code of the problem
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
};

/// Where a chain stands. Its node's router signs the payload with purpose kSignedAuditHead.
struct AuditHead {
  Blob start;                ///< audit_start(): of which chain
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
constexpr std::string_view kSignedAuditHead = "audit_head";

Bytes audit_head_payload(const AuditHead& head);
/// Errors: malformed, too_large, bad_value.
Result<AuditHead> read_audit_head(BytesView payload);

/// What stands before the first record of this node's chain in this fleet: no row of another chain fits.
Bytes audit_start(BytesView fleet, std::string_view node);
/// BLAKE2b over the hash before and the record's msgpack, for this purpose alone.
Bytes audit_hash(BytesView previous, const AuditRecord& record);
/// Its texts are UTF-8 within their bounds, so that its msgpack has all of it: of another one a part were not hashed.
bool is_canonical(const AuditRecord& record);

class AuditChain {
 public:
  explicit AuditChain(Bytes start);
  /// Goes on behind the last row that is stored.
  AuditChain(Bytes start, const AuditRow& last);

  /// Gives the record its number, cuts what is over its bound, and hashes it. The row has to be stored before what it
  /// tells of is answered.
  AuditRow append(AuditRecord record);
  [[nodiscard]] AuditHead head(UtcTime now) const;
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  Bytes start_;
  Bytes hash_;
  std::uint64_t number_ = 0;
};

}  // namespace trb::gateway
