#include "services/virtual-robots/lines/reports.hpp"

#include <algorithm>
#include <array>

#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::lines {
namespace {

constexpr std::array<std::string_view, 4> kSeverities = {"WARNING", "URGENT", "CRITICAL", "FATAL"};

/** The number of a word in numeric data; 0 if it has none. */
std::string number_in_data(const Vocabulary& vocabulary, const std::string& word) {
  return vocabulary.codes.subtype_number(word).value_or("0");
}

Message own_information(std::string subtype, std::string data) {
  return {"information", std::move(subtype), "", std::move(data)};
}

struct ToMessage {
  using Result = std::optional<Message>;
  const Vocabulary& vocabulary;

  Result operator()(const Started&) const { return std::nullopt; }

  Result operator()(const Done& event) const {
    return own_information("done", vocabulary.numeric ? number_in_data(vocabulary, event.skill) : event.skill);
  }

  Result operator()(const Failed& event) const {
    const int number = static_cast<int>(event.reason);
    return own_information("failed", vocabulary.numeric
                                         ? number_in_data(vocabulary, event.skill) + " " + std::to_string(number)
                                         : event.skill + " " + std::string(reason_text(event.reason)));
  }

  Result operator()(const Answer& event) const {
    const bool unsayable = vocabulary.numeric && event.data == "unknown";
    return Message{"information", event.subtype, event.target, unsayable ? "0" : event.data};
  }
};

struct BodyLine {
  using Result = std::optional<std::string>;
  Result operator()(const Started& event) const { return "start " + event.skill + " " + escape_line(event.data); }
  Result operator()(const Done& event) const { return "done " + event.skill; }
  Result operator()(const Failed& event) const {
    return "failed " + event.skill + " " + std::string(reason_text(event.reason));
  }
  Result operator()(const Answer&) const { return std::nullopt; }
};

struct SessionLine {
  std::string operator()(const FieldReceived& event) const {
    return "field " + std::to_string(event.index) + " " + escape_line(event.text);
  }
  std::string operator()(const MessageReceived& event) const {
    const Message& message = event.message;
    return "message " + message.type + " " + escape_line(message.subtype) + " " +
           (message.peer.empty() ? "-" : escape_line(message.peer)) + " " + std::to_string(message.data.size()) + " " +
           escape_line(message.data);
  }
  std::string operator()(const StopReceived&) const { return "stopped"; }
  std::string operator()(const ReleaseReceived&) const { return "released"; }
  std::string operator()(const Violation& event) const { return "violation " + escape_line(event.what); }
};

}  // namespace

std::optional<Message> message_of(const BodyEvent& event, const Vocabulary& vocabulary) {
  return std::visit(ToMessage{vocabulary}, event);
}

std::optional<std::string> line_of(const BodyEvent& event) {
  return std::visit(BodyLine{}, event);
}

std::string line_of(const SessionEvent& event) {
  return std::visit(SessionLine{}, event);
}

std::optional<Message> parse_say(std::string_view words) {
  Message message;
  message.type = take_word(words);
  message.subtype = take_word(words);
  message.peer = take_word(words);
  if (message.type.empty() || message.subtype.empty() || message.peer.empty()) return std::nullopt;
  if (message.peer == "-") message.peer.clear();
  message.data = unescape_line(words);
  return message;
}

std::optional<Message> parse_fault(std::string_view words, const Vocabulary& vocabulary) {
  const auto order = parse_fault_order(words);
  if (!order) return std::nullopt;
  if (!vocabulary.numeric) {
    return own_information("fault", order->capability + " " + order->severity + " " + order->text);
  }
  const auto* const place = std::find(kSeverities.begin(), kSeverities.end(), order->severity);
  const auto number = std::to_string(place - kSeverities.begin() + 1);
  return own_information("fault", number_in_data(vocabulary, order->capability) + " " + number);
}

Message fault_over(const std::string& capability, const Vocabulary& vocabulary) {
  return own_information("fault",
                         vocabulary.numeric ? number_in_data(vocabulary, capability) + " 0" : capability + " OVER");
}

}  // namespace trb::virtual_robots::lines
