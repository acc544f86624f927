#include "common/operator/doctor/certificate_findings.hpp"

namespace trb::op {
namespace {

constexpr std::int64_t kDay = 86'400'000'000'000;
constexpr std::int64_t kWarnDays = 30;

std::string days(std::int64_t ns) {
  return std::to_string(ns / kDay) + (ns / kDay == 1 ? " day" : " days");
}

}  // namespace

void add_certificate_findings(const Observed& seen, std::vector<Finding>& out) {
  if (!seen.own) return;
  const std::int64_t left = seen.own->not_after - seen.now.ns;
  const std::string until = to_iso8601({seen.own->not_after});
  const std::string hint = "where the authority is: trb fleet renew FLEET_DIR " + seen.own->id;
  if (seen.now.ns < seen.own->not_before) {
    out.push_back({Weight::problem, "clock_off", seen.node,
                   "this node's clock (" + to_iso8601(seen.now) + ") is before the beginning of its own certificate (" +
                       to_iso8601({seen.own->not_before}) + ")",
                   "if this clock is behind: timedatectl; if the authority's was ahead: " + hint});
  } else if (left <= 0) {
    out.push_back({Weight::problem, "cert_expired", seen.node, "its certificate ended " + until, hint});
  } else if (left < kWarnDays * kDay) {
    out.push_back(
        {Weight::note, "cert_ends_soon", seen.node, "its certificate ends in " + days(left) + ", " + until, hint});
  }
}

}  // namespace trb::op
