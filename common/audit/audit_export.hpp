// An audit log as a file for a third party: a line of JSON for each record, signed head and certificate.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/audit/audit_verify.hpp"
#include "common/security/keys.hpp"

namespace trb {

/// {"record": {"number": 1, ...}, "hash": "64 hexadecimal digits"}
std::string audit_line(const AuditRow& row);
/// {"head": SignedRecord}: a head that the node's router has signed.
std::string audit_head_line(const SignedRecord& head);
/// {"certificate": SignedRecord}: of the node whose gateway wrote the log.
std::string audit_certificate_line(const SignedRecord& certificate);

struct AuditCheck {
  std::string node;  ///< whose log it is, by its certificate; of a shared one, who has begun it
  AuditReport report;
  std::size_t records = 0;
  std::size_t heads = 0;        ///< with a valid signature
  std::size_t other_heads = 0;  ///< of another key of the node, or of nobody's: they prove nothing
};

/// Reads the lines of an export (several joined exports of one log are one) and checks all of it. A certificate counts
/// whatever its dates are: the log may be older than the certificate, and its reader may come later. A log that several
/// gateways share has a certificate of each node, and heads that any of them has signed; of several certificates of one
/// node the last counts. Certificates of robots do not count: no robot has a gateway. Errors: malformed (with the
/// line's number), missing (no certificate of a cloud node), and those of open_certificate.
Result<AuditCheck> check_audit_export(std::string_view text, const FleetAuthority& authority);

/// Two exports of one gateway's log that were made at different times.
struct AuditParting {
  std::uint64_t alike = 0;           ///< the last record that both have; 0: none
  std::optional<AuditRecord> first;  ///< the next one there; nothing: it ends
  std::optional<AuditRecord> second;
};

/// Where they part; nothing: one goes on where the other one ends. A log parts from an earlier export of itself after a
/// backup was brought back, or if somebody has changed it. Errors: malformed.
Result<std::optional<AuditParting>> find_parting(std::string_view first, std::string_view second);

/// The files of one log joined, for each log: a file that begins at a record that was there already is another export.
/// Errors: malformed.
Result<std::vector<std::string>> join_exports(const std::vector<std::string>& files);

}  // namespace trb
