// Faults of configuration files, collected: a person gets all of them at once.
#pragma once

#include <string>
#include <vector>

namespace trb {

/// A fault in a configuration file, for `trb check`, which reports all of them at once.
struct ConfigFault {
  std::string file;
  std::string key;  ///< path of the key, "skills.go_to.end.kind"; may be empty
  std::string what;
  std::string hint;
  bool may_wait = false;  ///< what is missing may come later: `trb up` starts anyway and waits for it
};
using ConfigFaults = std::vector<ConfigFault>;

/// Only the faults that prevent a start: those that may wait are left out.
ConfigFaults faults_that_stop(const ConfigFaults& faults);

/// "FILE: KEY: WHAT; CURE", a line for each fault.
std::string to_text(const ConfigFaults& faults);

}  // namespace trb
