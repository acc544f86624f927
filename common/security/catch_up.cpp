// The authority's folder restored from a copy: what the fleet has received since then stays in force.
#include <algorithm>
#include <utility>

#include "common/security/authority.hpp"
#include "common/security/issued.hpp"
#include "common/security/revocations.hpp"

namespace trb {
namespace {

/// Certificates first: a list is checked against what was signed.
Result<bool> adopt_unknown(Authority& authority, const std::string& dir, const std::vector<SignedRecord>& records) {
  bool learned = false;
  for (const SignedRecord& record : records) {
    const std::size_t before = authority.issued.size();
    if (auto adopted = adopt_certificate(authority, dir, record); !adopted) return adopted.error();
    learned = learned || authority.issued.size() > before;
  }
  return learned;
}

}  // namespace

Result<bool> catch_up(Authority& authority, const std::string& dir, const TrustUpdate& known) {
  auto learned = adopt_unknown(authority, dir, known.certificates);
  if (!learned || known.revocations.kind.empty() || known.revocations == authority.revocations) return learned;
  auto list = open_revocations(known.revocations, authority.fleet);
  if (!list) return list.error();
  if (list->number < authority.list.number) return learned;
  if (list->number == authority.list.number) {
    // Both were signed, and one of them is in force: the next list merges both.
    const std::vector<Revocation> own = std::exchange(authority.list, *list).revoked;
    for (const Revocation& entry : own) {
      const auto covers = [&](const Revocation& row) { return row.id == entry.id && row.serial >= entry.serial; };
      std::vector<Revocation>& rows = authority.list.revoked;
      if (std::none_of(rows.begin(), rows.end(), covers)) rows.push_back(entry);
    }
    return true;
  }
  if (Status stored = write_revocations(dir, known.revocations); !stored) return stored.error();
  authority.revocations = known.revocations;
  authority.list = std::move(*list);
  authority.beacon.number = authority.list.beacon_number;
  if (!authority.key.secret_key.empty())
    authority.beacon = derive_beacon_key(authority.key.secret_key, authority.list.beacon_number);
  if (Status stored = write_fleet(dir, authority); !stored) return stored.error();
  return true;
}

}  // namespace trb
