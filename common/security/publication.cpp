// What an authority hands to its fleet: news.json, the list of the revoked and the newest certificates.
#include <algorithm>
#include <map>

#include "common/security/authority.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/issued.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxRenewed = 256;

}  // namespace

Status check_renewals(std::size_t number) {
  if (number <= kMaxRenewed) return Done{};
  return fail(Errc::too_large, std::to_string(number) + " renewals at once; 256 at most",
              "name some of them, hand these on, then name the others");
}

namespace {

/// Of each node the newest of these that is valid. One that only issued.json names replaces none: it may never have
/// been handed over.
std::vector<SignedRecord> newest_of(const Authority& authority, const std::vector<SignedRecord>& records, UtcTime now) {
  std::vector<std::pair<SignedRecord, Certificate>> valid;
  std::map<std::string, std::uint64_t> newest;
  for (const SignedRecord& record : records) {
    auto certificate = open_certificate_any_time(record, authority.fleet);
    if (!certificate || certificate->not_after <= now.ns) continue;
    if (find_ever_revoked(authority, *certificate) != nullptr) continue;
    newest[certificate->id] = std::max(newest[certificate->id], certificate->serial);
    valid.emplace_back(record, std::move(*certificate));
  }
  std::vector<SignedRecord> out;
  for (const auto& [record, certificate] : valid) {
    const bool counts = newest[certificate.id] == certificate.serial;
    if (counts && std::find(out.begin(), out.end(), record) == out.end()) out.push_back(record);
  }
  return out;
}

}  // namespace

Status publish_trust_updates(const Authority& authority, const std::string& dir,
                             const std::vector<SignedRecord>& renewed, UtcTime now) {
  if (Status few = check_renewals(renewed.size()); !few) return few;
  // The list says up to when a revoked certificate is valid by the rows: none may go with its renewal.
  if (Status kept = authority.news_ahead ? write_issued(dir, authority) : Status(Done{}); !kept) return kept;
  std::vector<SignedRecord> all = renewed;
  if (auto old = read_trust_updates(news_path(dir)))
    all.insert(all.end(), old->certificates.begin(), old->certificates.end());
  TrustUpdate update{authority.revocations, newest_of(authority, all, now)};
  update.certificates.resize(std::min(update.certificates.size(), kMaxRenewed));
  return write_trust_updates(news_path(dir), update);
}

}  // namespace trb
