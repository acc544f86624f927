#include "common/base/config_fault.hpp"

namespace trb {

ConfigFaults faults_that_stop(const ConfigFaults& faults) {
  ConfigFaults out;
  for (const ConfigFault& fault : faults) {
    if (!fault.may_wait) out.push_back(fault);
  }
  return out;
}

std::string to_text(const ConfigFaults& faults) {
  std::string out;
  for (const ConfigFault& fault : faults) {
    out += fault.file + ": ";
    if (!fault.key.empty()) out += fault.key + ": ";
    out += fault.what;
    if (!fault.hint.empty()) out += "; " + fault.hint;
    out += '\n';
  }
  return out;
}

}  // namespace trb
