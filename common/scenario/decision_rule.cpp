#include "common/scenario/decision_rule.hpp"

#include <algorithm>

#include "proto/body.hpp"

namespace trb {

bool says_cloud(const Member& member) {
  const auto certificate = decode<Certificate>(member.certificate.payload.bytes);
  return certificate.ok() && certificate->role == Role::cloud;
}

std::string first_cloud_of(const std::vector<Member>& members) {
  const auto cloud = std::find_if(members.begin(), members.end(), says_cloud);
  return cloud == members.end() ? std::string() : cloud->id;
}

DecisionRule::DecisionRule(const RunStart& start)
    : decider_(first_cloud_of(start.members)), judge_(decider_.empty() ? start.submitter : decider_) {}

}  // namespace trb
