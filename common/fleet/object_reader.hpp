// Reads one JSON object of a configuration file key by key, and collects everything that is wrong with it.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/config_fault.hpp"
#include "proto/field.hpp"
#include "proto/value.hpp"

namespace trb {

/// Where the faults of one file go.
class FileFaults {
 public:
  FileFaults(std::string file, ConfigFaults& faults) : file_(std::move(file)), faults_(&faults) {}

  void add(std::string key, std::string what, std::string hint) const {
    if (!full()) faults_->push_back({file_, std::move(key), std::move(what), std::move(hint), false});
  }
  /// Another cure for the fault that add has just brought, once more is known.
  void cure_last(const std::string& key, std::string hint) const {
    if (!faults_->empty() && faults_->back().key == key && !full()) faults_->back().hint = std::move(hint);
  }
  /// A person reads no more than this; a file of a megabyte must not cost a suggestion for each of its words.
  [[nodiscard]] bool full() const { return count() >= kMost; }
  [[nodiscard]] std::size_t count() const { return faults_->size(); }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  static constexpr std::size_t kMost = 200;
  std::string file_;
  ConfigFaults* faults_;
};

enum class Need : std::uint8_t { optional, required };

/// The numbers allowed; `above` excludes the lower bound.
struct Range {
  double from = -std::numeric_limits<double>::max();
  double to = std::numeric_limits<double>::max();
  bool above = false;

  [[nodiscard]] bool holds(double value) const { return (above ? value > from : value >= from) && value <= to; }
  [[nodiscard]] std::string text() const;
};

/// A time-out or a duration: more than 0, at most a week.
constexpr Range kSeconds{0, 7.0 * 24 * 3600, true};

/// Every getter reports a missing required key, a wrong type and a value out of bounds, and then returns nothing.
class ObjectReader {
 public:
  /// A value that is not an object is reported here and then read as an empty one.
  ObjectReader(const Value& json, std::string path, FileFaults faults);

  const Value* value(std::string_view key, Need need);
  std::optional<std::string> text(std::string_view key, Need need, std::size_t max = 255);
  std::optional<double> number(std::string_view key, Need need, Range range = {});
  std::optional<std::int64_t> integer(std::string_view key, Need need, std::int64_t from, std::int64_t to);
  std::optional<bool> boolean(std::string_view key, Need need);
  const Value::Object* object(std::string_view key, Need need, std::size_t max);
  const Value::List* list(std::string_view key, Need need, std::size_t max);

  /// A list of different texts.
  std::vector<std::string> texts(std::string_view key, Need need, std::size_t max);

  template <NamedEnum E>
  std::optional<E> one_of(std::string_view key, Need need) {
    constexpr auto kNames = enum_names(E{});
    const auto index = choice(key, need, {kNames.begin(), kNames.end()});
    if (!index) return std::nullopt;
    return static_cast<E>(*index);
  }

  /// The index of the text among the names.
  std::optional<std::size_t> choice(std::string_view key, Need need, const std::vector<std::string>& names);

  /// Reports the keys that no getter has read. Of what is no object it says which keys belong there.
  void refuse_unknown_keys();

  /// "" for the document itself, whose keys stand alone; else "path.key".
  [[nodiscard]] std::string path(std::string_view key) const;
  [[nodiscard]] bool is_object() const { return json_->is_object(); }
  [[nodiscard]] const FileFaults& faults() const { return faults_; }

 private:
  void wrong_type(std::string_view key, const Value& found, std::string_view wanted) const;

  const Value* json_;
  std::string path_;
  FileFaults faults_;
  std::vector<std::string> asked_;
  bool unusable_ = false;
};

/// Reports a count that exceeds the limit; true if it is within.
bool check_count(const FileFaults& faults, const std::string& key, std::size_t count, std::size_t max);

}  // namespace trb
