#include "services/cloud-gateway/io/live_word.hpp"

#include "proto/value.hpp"
#include "services/cloud-gateway/io/drive_words.hpp"

namespace trb::gateway {
namespace {

std::optional<Resume> resume_of(const Value& word) {
  const Value* instance = word.find("instance");
  const Value* from = word.find("from");
  if (instance == nullptr || from == nullptr || !instance->is_integer() || !from->is_integer()) return std::nullopt;
  return Resume{static_cast<std::uint64_t>(instance->integer()), static_cast<std::uint64_t>(from->integer())};
}

Result<Topic> topic_in(const Value& word, std::string_view key) {
  const Value* topic = word.find(key);
  if (topic != nullptr && topic->is_text()) return parse_topic(topic->text());
  return fail(Errc::bad_value, "no topic", R"(send {"subscribe": "fleet"} or {"unsubscribe": "fleet"})");
}

template <class Word>
Result<LiveWord> as_word(Result<Word> read) {
  if (!read) return read.error();
  return LiveWord(std::move(*read));
}

template <class Word>
Result<LiveWord> robot_word(const Value& word, std::string_view name) {
  auto robot = read_robot_word(word, name);
  if (!robot) return robot.error();
  return LiveWord(Word{std::move(*robot)});
}

}  // namespace

Result<LiveWord> read_live_word(BytesView text) {
  const auto word = parse_json(text);
  if (!word) return word.error();
  if (word->find("drive") != nullptr) return as_word(read_drive_word(*word));
  if (word->find("ask_for") != nullptr) return robot_word<AskFor>(*word, "ask_for");
  if (word->find("let_go") != nullptr) return robot_word<LetGo>(*word, "let_go");
  const bool leaves = word->find("unsubscribe") != nullptr;
  auto topic = topic_in(*word, leaves ? "unsubscribe" : "subscribe");
  if (!topic) return topic.error();
  if (leaves) return LiveWord(Unsubscribe{std::move(*topic)});
  return LiveWord(Subscribe{std::move(*topic), resume_of(*word)});
}

}  // namespace trb::gateway
