// Faults of configuration files, collected: a person gets all of them at once.
#pragma once

#include <string>
#include <vector>

namespace trb {

/// A fault of a configuration file, for `trb check`: all of them are told at once.
struct ConfigFault {
  std::string file;
  std::string key;  ///< path of the key, "skills.go_to.end.kind"; may be empty
  std::string what;
  std::string hint;
  bool may_wait = false;  ///< what is missing may come later: `trb up` starts and waits for it
};
using ConfigFaults = std::vector<ConfigFault>;

/// Without those that may wait.
ConfigFaults faults_that_stop(const ConfigFaults& faults);

/// "FILE: KEY: WHAT; CURE", a line for each fault.
std::string to_text(const ConfigFaults& faults);

}  // namespace trb
