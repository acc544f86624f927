#include "services/cloud-gateway/io/json_messages.hpp"

#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

/// The members of an object's JSON text, without its braces.
std::string_view inside(std::string_view json) {
  return json.substr(1, json.size() - 2);
}

/// A page has up to 500 messages, and a few bytes may stand for many empty records.
constexpr std::size_t kMostText = 64U << 10U;

std::string json_of(const PassedMessage& passed) {
  const Message& message = passed.message;
  std::string whole = passed.is_cut() ? "" : message_to_json(message);
  if (!whole.empty() && whole.size() <= kMostText) return whole;
  JsonObject out;
  out.text("type", name_of(message.type)).text("subtype", message.subtype).text("source", message.source);
  return out.text("target", message.target).number("size", passed.size).flag("cut", true).done();
}

}  // namespace

std::string json_message(const PassedMessage& passed) {
  JsonObject out;
  out.number("number", passed.number).time("time", passed.time).text("direction", {&passed.direction, 1});
  std::string head = out.text("phase", name_of(passed.phase)).done();
  head.pop_back();
  return head + "," + std::string(inside(json_of(passed))) + "}";
}

std::string json_phases(const MessageLog::PhaseCounts& counts) {
  JsonObject out;
  for (std::size_t i = 0; i < counts.size(); ++i) out.number(enum_names(CostPhase{})[i], counts[i]);
  return out.done();
}

}  // namespace trb::gateway
