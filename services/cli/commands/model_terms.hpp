// What `trb model` and `trb simulate` have alike: numbers among the options, and the equations' terms by name.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/model/paper.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// Reads options one after the other and keeps the first error; an option that is not given leaves the number as it is.
class OptionReader {
 public:
  explicit OptionReader(const Arguments& arguments) : arguments_(arguments) {}
  /// A whole number from 0.
  void read(const std::string& option, std::uint64_t& into);
  /// A number from 0.
  void read(const std::string& option, double& into);
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  void refuse(const std::string& option, const std::string& wanted, const std::string& hint);

  const Arguments& arguments_;
  Status status_ = Done{};
};

struct ModelTerm {
  const char* name;
  const char* equation;
  const char* formula;
  double (*value)(const model::PaperParameters&);
};

/// Equations 1 to 12; a phase's term has the phase's name.
const std::vector<ModelTerm>& model_terms();

/// Without a fraction if there is none.
std::string shown_number(double number);

/// Options of both commands, behind those that one of them has alone.
std::vector<std::string> with_model_options(std::vector<std::string> options);

}  // namespace trb::cli
