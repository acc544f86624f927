// Members' certificates that were opened before: the robots of a hall are the members of every run.
#pragma once

#include <map>
#include <string>

#include "common/base/result.hpp"
#include "common/security/keys.hpp"

namespace trb::scheduler {

class Certificates {
 public:
  static constexpr std::size_t kMost = 1024;  ///< then it begins anew

  explicit Certificates(FleetAuthority authority) : authority_(std::move(authority)) {}

  /// Errors: those of open_certificate_any_time, each time anew.
  Result<Certificate> open(const SignedRecord& record);
  [[nodiscard]] std::size_t size() const { return opened_.size(); }

 private:
  FleetAuthority authority_;
  std::map<std::string, Certificate> opened_;  ///< by all that was signed, and the signature
};

}  // namespace trb::scheduler
