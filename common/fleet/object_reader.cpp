#include "common/fleet/object_reader.hpp"

#include <algorithm>
#include <cstdio>

#include "common/fleet/did_you_mean.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

std::string show(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%g", number);
  return out;
}

}  // namespace

std::string Range::text() const {
  std::string out = above ? "more than " + show(from) : "from " + show(from);
  if (to < std::numeric_limits<double>::max()) out += (above ? " and at most " : " to ") + show(to);
  return out;
}

bool check_count(const FileFaults& faults, const std::string& key, std::size_t count, std::size_t max) {
  if (count <= max) return true;
  faults.add(key, "has " + std::to_string(count) + " entries", "keep it to " + std::to_string(max));
  return false;
}

ObjectReader::ObjectReader(const Value& json, std::string path, FileFaults faults)
    : json_(&json), path_(std::move(path)), faults_(std::move(faults)), unusable_(!json.is_object()) {
  if (!unusable_) return;
  const std::string what = in_words(json) + " is where an object belongs";
  faults_.add(path_, what, "write it as { \"KEY\": VALUE, … }");
}

std::string ObjectReader::path(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

const Value* ObjectReader::value(std::string_view key, Need need) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
  const Value* found = json_->find(key);
  if (found == nullptr && need == Need::required && !unusable_) {
    faults_.add(path(key), "is missing", "add \"" + std::string(key) + "\"");
  }
  return found;
}

void ObjectReader::wrong_type(std::string_view key, const Value& found, std::string_view wanted) const {
  faults_.add(path(key), "is " + in_words(found), "write " + std::string(wanted) + " here");
}

std::optional<std::string> ObjectReader::text(std::string_view key, Need need, std::size_t max) {
  const Value* found = value(key, need);
  if (found == nullptr) return std::nullopt;
  if (!found->is_text()) {
    wrong_type(key, *found, "a text, in quotes,");
    return std::nullopt;
  }
  if (found->text().size() > max) {
    faults_.add(path(key), "is " + std::to_string(found->text().size()) + " bytes long",
                "keep it to " + std::to_string(max));
    return std::nullopt;
  }
  return found->text();
}

std::optional<double> ObjectReader::number(std::string_view key, Need need, Range range) {
  const Value* found = value(key, need);
  if (found == nullptr) return std::nullopt;
  if (!found->is_number()) {
    wrong_type(key, *found, "a number, without quotes,");
    return std::nullopt;
  }
  if (!range.holds(found->number())) {
    faults_.add(path(key), show(found->number()) + " is out of range", "use a number " + range.text());
    return std::nullopt;
  }
  return found->number();
}

std::optional<std::int64_t> ObjectReader::integer(std::string_view key, Need need, std::int64_t from, std::int64_t to) {
  const Value* found = value(key, need);
  if (found == nullptr) return std::nullopt;
  if (!found->is_integer()) {
    wrong_type(key, *found, "a whole number, without quotes,");
    return std::nullopt;
  }
  if (found->integer() < from || found->integer() > to) {
    faults_.add(path(key), std::to_string(found->integer()) + " is out of range",
                "use a number from " + std::to_string(from) + " to " + std::to_string(to));
    return std::nullopt;
  }
  return found->integer();
}

std::optional<bool> ObjectReader::boolean(std::string_view key, Need need) {
  const Value* found = value(key, need);
  if (found == nullptr) return std::nullopt;
  if (found->is_bool()) return found->boolean();
  wrong_type(key, *found, "true or false, without quotes,");
  return std::nullopt;
}

const Value::Object* ObjectReader::object(std::string_view key, Need need, std::size_t max) {
  const Value* found = value(key, need);
  if (found == nullptr) return nullptr;
  if (!found->is_object()) {
    wrong_type(key, *found, "an object, { \"NAME\": VALUE, … },");
    return nullptr;
  }
  return check_count(faults_, path(key), found->object().size(), max) ? &found->object() : nullptr;
}

const Value::List* ObjectReader::list(std::string_view key, Need need, std::size_t max) {
  const Value* found = value(key, need);
  if (found == nullptr) return nullptr;
  if (!found->is_list()) {
    wrong_type(key, *found, "a list, [ … ],");
    return nullptr;
  }
  return check_count(faults_, path(key), found->list().size(), max) ? &found->list() : nullptr;
}

std::vector<std::string> ObjectReader::texts(std::string_view key, Need need, std::size_t max) {
  std::vector<std::string> out;
  const Value::List* items = list(key, need, max);
  if (items == nullptr) return out;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Value& item = (*items)[i];
    const std::string at = std::string(key) + "[" + std::to_string(i) + "]";
    if (!item.is_text()) {
      wrong_type(at, item, "a text, in quotes,");
    } else if (std::find(out.begin(), out.end(), item.text()) != out.end()) {
      faults_.add(path(at), in_quotes(item.text()) + " occurs twice", "keep one of them");
    } else {
      out.push_back(item.text());
    }
  }
  return out;
}

std::optional<std::size_t> ObjectReader::choice(std::string_view key, Need need,
                                                const std::vector<std::string>& names) {
  const auto word = text(key, need);
  if (!word) return std::nullopt;
  const auto at = std::find(names.begin(), names.end(), *word);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  const std::string guess = nearest(*word, names);
  faults_.add(path(key), in_quotes(*word) + " is not known here",
              "use one of: " + join(names) + (guess.empty() ? "" : "; did you mean '" + guess + "'?"));
  return std::nullopt;
}

void ObjectReader::refuse_unknown_keys() {
  if (unusable_) {
    if (asked_.empty()) return;
    std::string members;
    constexpr std::size_t kShown = 8;
    for (std::size_t i = 0; i < std::min(asked_.size(), kShown); ++i)
      members += (i == 0 ? "\"" : ", \"") + asked_[i] + "\": …";
    if (asked_.size() > kShown) members += ", …";
    return faults_.cure_last(path_, "write it as { " + members + " }, with those of these keys that you need");
  }
  for (const auto& [key, ignored] : json_->object()) {
    if (faults_.full()) return;
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    faults_.add(path_.empty() ? key : path_ + "." + key, "is no key that is known here",
                did_you_mean(key, asked_, "remove it, or use one of"));
  }
}

}  // namespace trb
