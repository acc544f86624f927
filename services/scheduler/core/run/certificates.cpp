#include "services/scheduler/core/run/certificates.hpp"

#include "proto/body.hpp"

namespace trb::scheduler {

Result<Certificate> Certificates::open(const SignedRecord& record) {
  const std::string key = encode(record);
  if (const auto known = opened_.find(key); known != opened_.end()) return known->second;
  auto certificate = open_certificate_any_time(record, authority_);
  if (!certificate) return certificate;
  if (opened_.size() >= kMost) opened_.clear();
  opened_.emplace(key, *certificate);
  return certificate;
}

}  // namespace trb::scheduler
