#include "services/simulator/job/answer.hpp"

#include <algorithm>
#include <array>

namespace trb::simulator {
namespace {

using counting::Count;

Value integer(std::uint64_t number) {
  return Value{static_cast<std::int64_t>(number)};
}

Value::Object count_object(const Count& count) {
  return {{"messages", integer(count.messages)}, {"bytes", integer(count.bytes)}};
}

Value with_between(const Count& all, const Count& between) {
  Value::Object out = count_object(all);
  out.emplace_back("between_computers", Value{count_object(between)});
  return Value{std::move(out)};
}

/// Up to the end: behind it the tally has what the run might have taken longer.
Value over_time(const counting::Tally& tally, double seconds) {
  const auto intervals = static_cast<std::size_t>(seconds / tally.interval_s()) + 1;
  Value::List messages, bytes;
  for (std::size_t i = 0; i < std::min(intervals, tally.over_time().size()); ++i) {
    const Count& one = tally.over_time()[i];
    messages.push_back(integer(one.messages));
    bytes.push_back(integer(one.bytes));
  }
  return Value{Value::Object{{"interval_s", Value{tally.interval_s()}},
                             {"messages", Value{std::move(messages)}},
                             {"bytes", Value{std::move(bytes)}}}};
}

std::string end_name(const counting::End& end) {
  constexpr std::array<const char*, 5> kNames{"cloud", "middleware", "robot", "device", "everybody"};
  const std::string name = kNames[static_cast<std::size_t>(end.party)];
  const bool one = end.party == counting::Party::cloud || end.party == counting::Party::everybody;
  return one ? name : name + " " + std::to_string(end.of);
}

}  // namespace

Value answer_value(const counting::Tally& tally, double seconds) {
  Value::Object phases;
  for (std::size_t i = 0; i < counting::kPhases; ++i) {
    const auto phase = static_cast<CostPhase>(i);
    phases.emplace_back(std::string(enum_names(CostPhase{})[i]), with_between(tally.all(phase), tally.between(phase)));
  }
  Value::Object out{{"seconds", Value{seconds}}};
  for (auto& [key, value] : count_object(tally.all())) out.emplace_back(key, std::move(value));
  out.emplace_back("between_computers", Value{count_object(tally.between())});
  out.emplace_back("phases", Value{std::move(phases)});
  out.emplace_back("over_time", over_time(tally, seconds));
  return Value{std::move(out)};
}

Value trace_value(const counting::CountedMessage& message) {
  return Value{
      Value::Object{{"at_s", Value{message.at_s}},
                    {"phase", Value{std::string(enum_names(CostPhase{})[static_cast<std::size_t>(message.phase)])}},
                    {"from", Value{end_name(message.from)}},
                    {"to", Value{end_name(message.to)}},
                    {"bytes", integer(message.bytes)}}};
}

Value trace_value(const world::Sending& sending, CostPhase phase) {
  return Value{Value::Object{{"at_s", Value{sending.at_s}},
                             {"phase", Value{std::string(name_of(phase))}},
                             {"from", Value{std::string(sending.from)}},
                             {"to", Value{std::string(sending.to)}},
                             {"subtype", Value{std::string(sending.subtype)}},
                             {"bytes", integer(sending.bytes)}}};
}

}  // namespace trb::simulator
