// The authority's folder restored from a copy: what the fleet has received since then stays in force.
#include <utility>

#include "common/security/authority.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/issued.hpp"
#include "common/security/revocations.hpp"

namespace trb {
namespace {

/// More than anybody signs between two copies of the folder: what was signed there, and reached no node that is asked,
/// must have no serial in common with what is signed here.
constexpr std::uint64_t kSerialsSkipped = 10'000;

/// Nothing is kept if one of them was not signed by this authority.
Status adopt_all(Authority& authority, const std::string& dir, const std::vector<SignedRecord>& records) {
  std::vector<Certificate> opened;
  for (const SignedRecord& record : records) {
    auto certificate = open_certificate_any_time(record, authority.fleet);
    if (!certificate) return certificate.error();
    opened.push_back(std::move(*certificate));
  }
  return keep_certificates(authority, dir, opened);
}

/// Both were signed, and one of them is in force: the next list merges both.
void merge(Authority& authority, RevocationList list) {
  const std::vector<Revocation> own = std::exchange(authority.list, std::move(list)).revoked;
  const std::vector<Revocation> more = not_in_list(authority.list, own);
  authority.list.revoked.insert(authority.list.revoked.end(), more.begin(), more.end());
}

/// What the own list has, and this one has not, stays known: remember_list().
Status take_list(Authority& authority, const std::string& dir, const SignedRecord& record, RevocationList list) {
  if (Status kept = remember_list(authority, dir); !kept) return kept;
  if (Status stored = write_revocations(dir, record); !stored) return stored;
  authority.revocations = record;
  authority.list = std::move(list);
  authority.beacon.number = authority.list.beacon_number;
  if (!authority.key.secret_key.empty())
    authority.beacon = derive_beacon_key(authority.key.secret_key, authority.list.beacon_number);
  return Done{};
}

/// True if the list was news.
Result<bool> learn_list(Authority& authority, const std::string& dir, const SignedRecord& record) {
  if (record.kind.empty() || record == authority.revocations) return false;
  auto list = open_revocations(record, authority.fleet);
  if (!list) return list.error();
  if (list->number < authority.list.number) return false;
  if (list->number == authority.list.number) {
    merge(authority, std::move(*list));
    return true;
  }
  if (Status taken = take_list(authority, dir, record, std::move(*list)); !taken) return taken.error();
  return true;
}

void skip_serials(Authority& authority) {
  pass_revoked_serials(authority);
  if (authority.next_serial == authority.skipped_to + 1) return;  // none was given since
  authority.next_serial += kSerialsSkipped;
  authority.skipped += kSerialsSkipped;
  authority.skipped_to = authority.next_serial - 1;
}

}  // namespace

Result<bool> catch_up(Authority& authority, const std::string& dir, const TrustUpdate& known) {
  const std::size_t rows = authority.issued.size();
  const std::uint64_t next = authority.next_serial;
  if (Status adopted = adopt_all(authority, dir, known.certificates); !adopted) return adopted.error();
  auto listed = learn_list(authority, dir, known.revocations);
  if (!listed) return listed;
  // A certificate with a lower serial proves no newer copy of the folder: an earlier version kept no rows.
  if (*listed || authority.next_serial > next) {
    skip_serials(authority);
    if (Status stored = write_fleet(dir, authority); !stored) return stored.error();
  }
  return *listed || authority.issued.size() > rows;
}

}  // namespace trb
