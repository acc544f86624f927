#include "services/scheduler/test/signers.hpp"

#include "common/scenario/run_start.hpp"
#include "proto/body.hpp"

namespace trb::scheduler::test {

Identities::Identities() {
  init_crypto();
  authority_key_ = make_signing_key();
  authority_ = {"test", authority_key_.public_key};
}

void Identities::add(const std::string& id, Role role) {
  Identity& is = all_[id];
  is.key = make_signing_key();
  Certificate certificate;
  certificate.fleet.bytes = authority_.id();
  certificate.serial = ++serials_;
  certificate.id = id;
  certificate.role = role;
  certificate.identity_key.bytes = is.key.public_key;
  certificate.link_key.bytes = Bytes(32, 'l');
  certificate.not_before = 1'700'000'000'000'000'000;
  is.certificate = trb::sign(kSignedCertificate, "", authority_.id(), encode(certificate), authority_key_);
}

std::vector<Member> Identities::members() const {
  std::vector<Member> out;
  for (const auto& [id, is] : all_) out.push_back({id, is.certificate});
  return out;
}

SignedRecord Identities::sign(const std::string& by, std::string_view purpose, Bytes payload) const {
  return trb::sign(purpose, by, authority_.id(), std::move(payload), all_.at(by).key);
}

SignedRecord Identities::make_start(const Scenario& scenario, const std::string& submitter, UtcTime now, Duration life,
                                    const std::string& run) const {
  return sign(submitter, kSignedRunStart,
              encode(build_run_start(scenario, members(), submitter, now, now + life, run)));
}

Signers::Signers() {
  add("cloud", Role::cloud);
  add("cloud2", Role::cloud);
  for (const char* robot : {"conveyor", "drone", "pioneer", "ridgeback", "ur3"}) add(robot, Role::robot);
}

}  // namespace trb::scheduler::test
