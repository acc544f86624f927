#include "services/mode-adapter/io/out_of_use_file.hpp"

#include <array>

#include "common/base/files.hpp"
#include "proto/value.hpp"

namespace trb::adapter {
namespace {

// More lines than a description's rules, its capabilities and the modes' reports can cause.
constexpr std::size_t kMaxLines = 256;
constexpr std::size_t kMaxCause = 160;

Value to_json(const Kept& line) {
  const OutOfUse& what = line.what;
  return Value{Value::Object{{"cause", Value{line.cause}},
                             {"capability", Value{what.capability}},
                             {"severity", Value{std::string(name_of(what.severity))}},
                             {"text", Value{what.text}},
                             {"since_ns", Value{what.since}},
                             {"retired", Value{what.retired}},
                             {"by", Value{what.by}}}};
}

std::optional<std::string> text_of(const Value& json, std::string_view key, std::size_t most) {
  const Value* found = json.find(key);
  if (found == nullptr || !found->is_text() || found->text().size() > most) return std::nullopt;
  return found->text();
}

std::optional<Kept> from_json(const Value& json) {
  const auto cause = text_of(json, "cause", kMaxCause);
  const auto capability = text_of(json, "capability", 64);
  const auto severity = text_of(json, "severity", 16);
  const auto text = text_of(json, "text", 255);
  const auto by = text_of(json, "by", 64);
  const Value* since = json.find("since_ns");
  const Value* retired = json.find("retired");
  const bool whole = cause && !cause->empty() && capability && severity && text && by && since != nullptr &&
                     since->is_integer() && retired != nullptr && retired->is_bool();
  if (!whole) return std::nullopt;
  constexpr auto kNames = enum_names(Severity{});
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (*severity != kNames[i]) continue;
    return Kept{*cause, {*capability, static_cast<Severity>(i), *text, since->integer(), retired->boolean(), *by}};
  }
  return std::nullopt;
}

std::optional<std::vector<Kept>> parse(const Bytes& bytes) {
  const auto json = parse_json(bytes);
  const Value* list = json ? json->find("out_of_use") : nullptr;
  if (list == nullptr || !list->is_list() || list->list().size() > kMaxLines) return std::nullopt;
  std::vector<Kept> lines;
  for (const Value& one : list->list()) {
    auto line = from_json(one);
    if (!line) return std::nullopt;
    lines.push_back(std::move(*line));
  }
  return lines;
}

}  // namespace

OutOfUseFile::OutOfUseFile(const std::string& node_dir) : path_(node_dir + "/state/out_of_use.json") {}

std::vector<Kept> OutOfUseFile::read() const {
  if (!file_exists(path_)) return {};
  const auto bytes = read_file(path_);
  if (bytes) {
    if (auto lines = parse(*bytes)) return *lines;
  }
  return {{"unreadable",
           {"", Severity::critical, "state/out_of_use.json cannot be read: look what is broken", 0, false,
            "mode-adapter"}}};
}

Status OutOfUseFile::save(const std::vector<Kept>& lines) const {
  Value::List list;
  for (const Kept& line : lines) list.push_back(to_json(line));
  return write_file(path_, dump_json(Value{Value::Object{{"out_of_use", Value{std::move(list)}}}}) + "\n");
}

}  // namespace trb::adapter
