// SchedulerCore: who has the sensor that a condition speaks of, and what it says.
#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::handle(const RouteTable& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) {
    return refuse(from, fail(Errc::not_permitted, "only the own router tells whom it reaches"), step);
  }
  auto taken = routes_.take(body);
  if (taken.next) step.out.request(settings_.node, std::move(*taken.next));
  if (!taken.whole) return;
  for (Run* run : runs_.runs()) {
    for (Inquiry& inquiry : run->inquiries) inquiry.on(*taken.whole, step.now, step.out);
  }
}

void SchedulerCore::handle(const SensorReading& body, const Inbound& from, Step step) {
  bool used = false;
  for (Run* run : runs_.runs()) {
    for (Inquiry& inquiry : run->inquiries) {
      if (!inquiry.on(body, from.source, step.now)) continue;
      choose_by(body, from.source, *run, inquiry, step);
      used = true;
    }
  }
  if (!used) step.out.count("unused.sensor_reading");
}

void SchedulerCore::refused_reading(const Nack& nack, const Inbound& from, Step step) {
  for (Run* run : runs_.runs()) {
    for (Inquiry& inquiry : run->inquiries) inquiry.on_refusal(nack, from.source, step.now);
  }
}

}  // namespace trb
