#include "common/drivers/arcos/order.hpp"

#include <charconv>
#include <cmath>

#include "common/drivers/arcos/packet.hpp"
#include "common/drivers/text/vendor_template.hpp"

namespace trb::drivers {
namespace {

constexpr std::uint8_t kSetOrigin = 7;
constexpr std::size_t kShown = 40;
/// Further than any robot drives: 10 km.
constexpr double kFarthest = 1e7;

Result<double> fill_number(const std::string& step, const std::string& words, BytesView data) {
  const auto text = VendorTemplate(words).fill_bytes(data);
  if (!text) return text.error();
  double number = 0;
  const char* const last = text->data() + text->size();
  const auto [end, problem] = std::from_chars(text->data(), last, number);
  if (problem == std::errc() && end == last && std::isfinite(number)) return number;
  return fail(Errc::bad_value, step + ": '" + text->substr(0, kShown) + "' is no number",
              "give a number, or a list of numbers such as [1000, 500, 90]");
}

Result<Bytes> number_packet(const ArcosStep& step, BytesView data, ArcosOrder& order) {
  const auto number = fill_number(step.name, step.argument, data);
  if (!number) return number.error();
  const double whole = std::round(*number);
  if (whole < step.lowest || whole > step.highest) {
    return fail(
        Errc::bad_value,
        step.name + ": the number is not from " + std::to_string(step.lowest) + " to " + std::to_string(step.highest),
        "give a number in that range");
  }
  if (step.command == kArcosEnable) order.enables = whole != 0;
  return arcos_command(step.command, static_cast<int>(whole));
}

Result<Bytes> packet_of(const ArcosStep& step, BytesView data, ArcosOrder& order) {
  if (step.kind == ArcosStep::Argument::none) return arcos_command(step.command);
  if (step.kind == ArcosStep::Argument::number) return number_packet(step, data, order);
  const auto text = VendorTemplate(step.argument).fill_bytes(data);
  if (!text) return text.error();
  if (text->size() > kMaxArcosText) {
    return fail(Errc::too_large, step.name + ": a text of " + std::to_string(text->size()) + " bytes",
                "give at most " + std::to_string(kMaxArcosText) + " bytes");
  }
  return arcos_command(step.command, BytesView(*text));
}

Result<ArcosGoal> goal_of(const ArcosTravel& travel, BytesView data) {
  ArcosGoal goal;
  goal.tolerance = travel.tolerance;
  goal.angle = travel.angle;
  const auto x = fill_number("goto", travel.x, data);
  if (!x) return x.error();
  const auto y = fill_number("goto", travel.y, data);
  if (!y) return y.error();
  goal.x = *x;
  goal.y = *y;
  if (std::abs(goal.x) > kFarthest || std::abs(goal.y) > kFarthest) {
    return fail(Errc::bad_value, "goto: further than 10 km", "give x and y in millimetres");
  }
  if (travel.heading.empty()) return goal;
  const auto heading = fill_number("goto", travel.heading, data);
  if (!heading) return heading.error();
  goal.heading = std::remainder(*heading, 360);
  return goal;
}

}  // namespace

Result<ArcosOrder> fill_arcos(const std::vector<ArcosStep>& steps, BytesView data) {
  ArcosOrder order;
  for (const ArcosStep& step : steps) {
    order.moves = order.moves || step.effect == ArcosEffect::moves;
    order.stops = order.stops || step.effect == ArcosEffect::stops;
    order.resets_origin = order.resets_origin || step.command == kSetOrigin;
    if (step.travel) {
      const auto goal = goal_of(*step.travel, data);
      if (!goal) return goal.error();
      order.goal = *goal;
      continue;
    }
    auto packet = packet_of(step, data, order);
    if (!packet) return packet.error();
    order.packets += *packet;
  }
  return order;
}

}  // namespace trb::drivers
