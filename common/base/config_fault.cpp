#include "common/base/config_fault.hpp"

#include "common/base/printable.hpp"

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
    std::string line = fault.file + ": ";
    if (!fault.key.empty()) line += fault.key + ": ";
    line += fault.what;
    if (!fault.hint.empty()) line += "; " + fault.hint;
    out += in_one_line(line) + '\n';
  }
  return out;
}

}  // namespace trb
