#include "services/mode-adapter/core/fault_injection.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb::adapter {
namespace {

/// As a virtual robot reads it: a single line.
std::string line_of(const InjectFault& order) {
  if (order.capability.empty()) return "clear";
  std::string line = "fault " + order.capability + " " + std::string(name_of(order.severity)) + " ";
  for (const char c : order.text) {
    if (c == '\n' || c == '\\') line += '\\';
    line += c == '\n' ? 'n' : c;
  }
  return line;
}

}  // namespace

Status FaultInjection::injected(const InjectFault& order) const {
  if (!inject_) {
    return fail(Errc::not_permitted,
                "'" + settings_.id + "' is not known to be a virtual robot, and a real one is not made to fail",
                "for a virtual one, name its --control address in node.json: \"robot\": {\"fault_injection\": "
                "\"HOST:PORT\"}");
  }
  const std::vector<std::string>& known = settings_.description.capabilities;
  if (!order.capability.empty() && std::find(known.begin(), known.end(), order.capability) == known.end()) {
    return fail(Errc::bad_value, "'" + settings_.id + "' has no capability '" + order.capability + "'",
                did_you_mean(order.capability, known, "use one of"));
  }
  return inject_(line_of(order));
}

void FaultInjection::on_inject(const Inbound& message, const InjectFault& order, Outbox& out) const {
  const Status done = injected(order);
  if (!done) {
    out.count("refused." + std::string(errc_name(done.error().code)));
    return out.nack(message, done.error());
  }
  out.count("to_robot.inject_fault");
  out.reply(message, Ack{"handed_over", order.capability.empty() ? "the injected faults are cleared" : ""});
}

}  // namespace trb::adapter
