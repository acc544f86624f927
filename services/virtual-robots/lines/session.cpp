#include "services/virtual-robots/lines/session.hpp"

#include <algorithm>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::lines {
namespace {

/** The positions of a message's fields; all fields behind the size are data. */
enum Place : std::size_t { kType, kSubtype, kSource, kSize };

}  // namespace

void Session::restart() {
  reader_.clear();
  drop_partial();
  output_.clear();
  output_bytes_ = 0;
  next_output_ = 0;
  fault_.clear();
}

void Session::receive(std::string_view bytes, double now) {
  // A field that was complete before these bytes came must not be joined with them.
  advance(now);
  if (hung_ || !fault_.empty()) return;
  reader_.add(bytes, now);
  advance(now);
}

void Session::advance(double now) {
  while (!hung_ && fault_.empty()) {
    const auto field = reader_.next(now);
    if (!field) break;
    take_field(*field);
  }
  if (reader_.overflowed() && fault_.empty()) fault_ = "field_too_long";
}

void Session::take_field(const Field& field) {
  if (field.longer_than_chunk) emit(Violation{"line_too_long"});
  if (field.bad_escape) emit(Violation{"bad_escape"});
  if (take_urgent(field.text)) return;
  emit(FieldReceived{fields_ + 1, field.text});
  if (settings_.acknowledge) queue_field(settings_.vocabulary.ok());
  take_part(field.text);
}

void Session::take_part(const std::string& text) {
  const Vocabulary& words = settings_.vocabulary;
  switch (fields_++) {
    case kType:
      if (const auto type = words.type_word(text)) {
        partial_.type = *type;
      } else {
        fault_ = "bad_type";
      }
      break;
    case kSubtype:
      partial_.subtype = words.numeric ? words.codes.subtype_word(text) : text;
      break;
    case kSource:
      partial_.peer = words.numeric ? (text == "0" ? "" : words.codes.id_word(text)) : text;
      break;
    case kSize:
      take_size(text);
      break;
    default:
      take_chunk(text);
  }
}

void Session::take_size(const std::string& text) {
  const auto size = parse_integer(text);
  if (!size || *size < 0) {
    fault_ = "bad_size";
    return;
  }
  size_ = static_cast<std::size_t>(*size);
  if (size_ > kLargestMessage) fault_ = "message_too_long";
  // With the delay framing an empty chunk cannot be seen: only the size shows that it was sent.
  if (size_ == 0 && delayed()) take_field({});
}

void Session::take_chunk(const std::string& text) {
  partial_.data += text;
  if (partial_.data.size() > size_) {
    fault_ = "size_mismatch";
  } else if (partial_.data.size() == size_) {
    finish_message();
  }
}

void Session::finish_message() {
  emit(MessageReceived{std::move(partial_)});
  drop_partial();
  ++messages_;
  hung_ = settings_.hang_after != 0 && messages_ >= settings_.hang_after;
}

bool Session::take_urgent(const std::string& text) {
  const Vocabulary& words = settings_.vocabulary;
  if (text == words.stop()) {
    drop_partial();
    queue_field(words.stopped());
    emit(StopReceived{});
    return true;
  }
  if (text == words.release()) {
    queue_field(words.released());
    emit(ReleaseReceived{});
    return true;
  }
  return false;
}

void Session::drop_partial() {
  partial_ = {};
  fields_ = 0;
  size_ = 0;
}

void Session::send(const Message& message) {
  Message said = message;
  if (said.peer.empty() && delayed() && !settings_.vocabulary.numeric) said.peer = settings_.own_name;
  const auto head = settings_.vocabulary.head_of(said);
  if (const auto* missing = std::get_if<std::string>(&head)) {
    emit(Violation{"no_code " + *missing});
    return;
  }
  for (const std::string& field : std::get<std::vector<std::string>>(head)) queue_field(field);
  for (std::string& chunk : frame_data(said.data, settings_.frame)) queue(std::move(chunk));
}

void Session::queue(std::string framed) {
  if (framed.empty()) return;
  output_bytes_ += framed.size();
  output_.push_back(std::move(framed));
  if (output_bytes_ > kLargestOutput && fault_.empty()) fault_ = "node_does_not_read";
}

std::string Session::take_output(double now) {
  std::string bytes;
  if (delayed() && now < next_output_) return bytes;
  while (!output_.empty()) {
    bytes += output_.front();
    output_.pop_front();
    if (delayed()) break;
  }
  output_bytes_ -= bytes.size();
  if (!bytes.empty()) next_output_ = now + settings_.frame.delay_s;
  return bytes;
}

std::optional<double> Session::next_deadline() const {
  auto deadline = hung_ ? std::nullopt : reader_.next_deadline();
  if (delayed() && !output_.empty()) deadline = std::min(deadline.value_or(next_output_), next_output_);
  return deadline;
}

}  // namespace trb::virtual_robots::lines
