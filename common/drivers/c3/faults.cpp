#include "common/drivers/c3/faults.hpp"

#include "common/drivers/text/fault_text.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kStop = "stop message";
constexpr const char* kError = "error";
/// A text reported this shortly before the program was stopped is the reason.
constexpr Duration kSameFault = std::chrono::seconds(1);

}  // namespace

Error C3Faults::why_stopped() const {
  return fail(Errc::robot_error, "the robot's controller has stopped its program: " + stop_text_,
              "clear the message on the robot's panel and start the program");
}

void C3Faults::on_text(const std::string& text, Now now, const DriverOut& out) {
  if (text.empty()) out.emit(FaultOver{kError});
  if (text == text_) return;
  text_ = text;
  if (!text.empty()) report(text, kError, true, now, out);
}

bool C3Faults::on_stop_message(bool raised, const std::string& variable, const DriverOut& out) {
  if (!raised) out.emit(FaultOver{kStop});
  if (raised == stopped_) return false;
  stopped_ = raised;
  if (raised) stop_text_ = variable + " is TRUE: see the message on the robot's panel";
  return raised;
}

void C3Faults::report_stop(const std::optional<std::string>& text, Now now, const DriverOut& out) {
  if (!text) return report(stop_text_, kStop, true, now, out);
  if (!text->empty()) stop_text_ = *text;
  const bool told = *text == text_ && now.mono - told_ < kSameFault;
  report(stop_text_, kStop, !told, now, out);
  text_ = *text;
}

void C3Faults::restart() {
  stopped_ = false;
  text_.clear();
}

void C3Faults::report(const std::string& text, const char* cause, bool is_new, Now now, const DriverOut& out) {
  if (is_new) told_ = now.mono;
  FaultSaid fault = read_fault_text(text, capabilities_, cause);
  fault.is_new = is_new;
  out.emit(std::move(fault));
}

}  // namespace trb::drivers
