// A fleet's authority, and who it has let sign: for tests in which no fleet runs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/security/keys.hpp"
#include "proto/bodies/run.hpp"

namespace trb::scheduler::test {

class Identities {
 public:
  Identities();
  void add(const std::string& id, Role role);

  [[nodiscard]] const FleetAuthority& authority() const { return authority_; }
  [[nodiscard]] const SignedRecord& certificate(const std::string& id) const { return all_.at(id).certificate; }
  [[nodiscard]] Member member(const std::string& id) const { return {id, certificate(id)}; }
  [[nodiscard]] std::vector<Member> members() const;
  [[nodiscard]] SignedRecord sign(const std::string& by, std::string_view purpose, Bytes payload) const;
  /// The signed start of a run of these tasks with everybody as a member.
  [[nodiscard]] SignedRecord make_start(const Scenario& scenario, const std::string& submitter, UtcTime now,
                                        Duration life, const std::string& run) const;

 private:
  struct Identity {
    SigningKey key;
    SignedRecord certificate;
  };
  SigningKey authority_key_;
  FleetAuthority authority_;
  std::map<std::string, Identity> all_;
  std::uint64_t serials_ = 0;
};

inline const std::string kKnownRun(32, 'a');

/// The members of every known run: two cloud nodes and five robots. "cloud" submits, decides and judges.
struct Signers : Identities {
  Signers();
  [[nodiscard]] SignedRecord start(const Scenario& scenario) const {
    return make_start(scenario, "cloud", kNow.utc, seconds(3600), kKnownRun);
  }
  static constexpr Now kNow{{1'000'000'000}, {1'800'000'001'000'000'000}};
};

}  // namespace trb::scheduler::test
