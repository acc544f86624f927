#include "services/scheduler/core/run/members.hpp"

namespace trb::scheduler {
namespace {

/// A cloud node has no robot: it holds only what names none, until the decider chooses one.
Status check_assignment(const RunDefinition& definition, const Members& members) {
  const std::vector<std::string>& robots = definition.start().first.robots;
  for (std::size_t i = 0; i < definition.tasks().size(); ++i) {
    const bool bound_late = definition.tasks()[i].robot.empty() && definition.rule().may_decide(robots[i]);
    if (bound_late || members.is_robot(robots[i])) continue;
    return fail(Errc::bad_value,
                "task '" + definition.tasks()[i].id + "' is assigned to '" + robots[i] + "', which is no robot's node");
  }
  return Done{};
}

}  // namespace

Result<Certificate> open_member(const Member& member, Certificates& certificates) {
  auto certificate = certificates.open(member.certificate);
  if (!certificate) return certificate;
  if (certificate->id != member.id) {
    return fail(Errc::source_mismatch, "member '" + member.id + "' has the certificate of '" + certificate->id + "'");
  }
  return certificate;
}

Result<Members> Members::open(const RunDefinition& definition, Certificates& certificates) {
  Members out;
  for (const Member& member : definition.start().members) {
    auto certificate = open_member(member, certificates);
    if (!certificate) return certificate.error();
    out.certificates_.emplace(member.id, std::move(*certificate));
    out.ids_.push_back(member.id);
  }
  if (auto checked = check_assignment(definition, out); !checked) return checked.error();
  return out;
}

Result<Members::Opened> Members::open_new(const Decision& decision, Certificates& certificates) const {
  Opened out;
  for (const Member& member : decision.members) {
    const std::string name = "run " + decision.run + ": decision: member '" + member.id + "' ";
    auto certificate = certificates.open(member.certificate);
    if (!certificate) return certificate.error();
    if (certificate->id != member.id) {
      return fail(Errc::source_mismatch, name + "has the certificate of '" + certificate->id + "'");
    }
    if (certificate->role != Role::robot) return fail(Errc::bad_value, name + "is no robot's node");
    if (contains(member.id) || !out.emplace(member.id, *certificate).second) {
      return fail(Errc::duplicate, name + "is one already");
    }
  }
  return out;
}

void Members::add(const Decision& decision, const Opened& opened) {
  certificates_.insert(opened.begin(), opened.end());
  for (const Member& member : decision.members) ids_.push_back(member.id);
}

const Certificate* Members::find(const std::string& node) const {
  const auto found = certificates_.find(node);
  return found == certificates_.end() ? nullptr : &found->second;
}

bool Members::is_robot(const std::string& node) const {
  const Certificate* certificate = find(node);
  return certificate != nullptr && certificate->role == Role::robot;
}

std::vector<std::string> Members::clouds_without(const std::string& node) const {
  std::vector<std::string> out;
  for (const std::string& id : ids_) {
    if (id != node && find(id)->role == Role::cloud) out.push_back(id);
  }
  return out;
}

}  // namespace trb::scheduler
