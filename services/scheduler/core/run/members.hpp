// The nodes that take part in a run, and the certificates that prove what they sign.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/scheduler/core/run/run_definition.hpp"

namespace trb::scheduler {

/// Error: source_mismatch (another node's certificate), those of open_certificate_any_time.
Result<Certificate> open_member(const Member& member, Certificates& certificates);

class Members {
 public:
  using Opened = std::map<std::string, Certificate>;

  /// Those of the start. Errors: those of open_member; bad_value (a task is given to a node without a robot).
  static Result<Members> open(const RunDefinition& definition, Certificates& certificates);
  /// Those that a decision adds. Errors: bad_value (no robot's node), duplicate, those of open_member.
  [[nodiscard]] Result<Opened> open_new(const Decision& decision, Certificates& certificates) const;
  void add(const Decision& decision, const Opened& opened);

  /// nullptr: no member.
  [[nodiscard]] const Certificate* find(const std::string& node) const;
  [[nodiscard]] bool contains(const std::string& node) const { return find(node) != nullptr; }
  [[nodiscard]] bool is_robot(const std::string& node) const;
  /// In the order of the start, then of the decisions.
  [[nodiscard]] const std::vector<std::string>& ids() const { return ids_; }
  /// The cloud nodes among them, without one, in that order.
  [[nodiscard]] std::vector<std::string> clouds_without(const std::string& node) const;

 private:
  Members() = default;

  Opened certificates_;
  std::vector<std::string> ids_;
};

}  // namespace trb::scheduler
