#include "common/config/resilience_edit.hpp"

#include <algorithm>

#include "common/config/json_edit.hpp"
#include "common/config/resilience_file.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr const char* kFile = "resilience.json";

/// A member of an object, without which it is not there.
void set(Value::Object& object, const std::string& key, const Value* value) {
  std::erase_if(object, [&](const auto& member) { return member.first == key; });
  if (value != nullptr) object.emplace_back(key, *value);
}

std::string with_or_without(const std::string& text, std::string_view key, const Value* value) {
  return value != nullptr ? with_member(text, key, *value) : without_member(text, key);
}

std::string edit_policy(const std::string& text, const Value& change) {
  Value::Object policy = change.object();
  set(policy, "expires_s", nullptr);
  return with_or_without(with_member(text, "policy", Value{std::move(policy)}), "expires_s", change.find("expires_s"));
}

std::string edit_criteria(const std::string& text, const Value& change, const FileFaults& faults) {
  ObjectReader reader(change, "", faults);
  const Value* criteria = reader.value("criteria", Need::required);
  const Value* judgments = reader.value("judgments", Need::optional);
  reader.refuse_unknown_keys();
  if (criteria == nullptr) return text;
  return with_or_without(with_member(text, "criteria", *criteria), "judgments", judgments);
}

/// The criteria as objects; those of a file that lists none: the three with what they count.
Value::Object listed_criteria(const Value& file, const ResilienceSettings& settings) {
  Value::Object out;
  const bool judged = file.find("judgments") != nullptr;
  if (const Value* criteria = file.find("criteria")) {
    for (const auto& [name, value] : criteria->object()) {
      out.emplace_back(name, value.is_object() ? value : Value{Value::Object{{"weight", value}}});
    }
    return out;
  }
  for (const ReplacementCriterion& one : settings.criteria) {
    out.emplace_back(one.name, Value{judged ? Value::Object{} : Value::Object{{"weight", Value{one.weight}}}});
  }
  return out;
}

/// A minimum has its two bounds alone: it must not change what the criterion counts.
void check_minimum(const std::string& name, const Value& minimum, const FileFaults& faults) {
  ObjectReader reader(minimum, name, faults);
  reader.value("at_least", Need::optional);
  reader.value("at_most", Need::optional);
  reader.refuse_unknown_keys();
}

void check_minimums(const Value& change, const ResilienceSettings& settings, const FileFaults& faults) {
  for (const auto& [name, minimum] : change.object()) {
    if (std::ranges::find(settings.criteria, name, &ReplacementCriterion::name) != settings.criteria.end()) {
      check_minimum(name, minimum, faults);
      continue;
    }
    std::string all;
    for (const ReplacementCriterion& one : settings.criteria) all += (all.empty() ? "" : ", ") + one.name;
    faults.add(cut_utf8(name, 64), "is no criterion", "use: " + all + "; a new one is added to the criteria first");
  }
}

/// One of the paper's three that counts nothing gets a row, so that its bound has a place.
void add_unlisted(const Value& change, bool judged, const FileFaults& faults, Value::Object& criteria) {
  for (const auto& [name, minimum] : change.object()) {
    if (std::ranges::find(criteria, name, [](const auto& one) { return one.first; }) != criteria.end()) continue;
    if (judged) {
      faults.add(name, "is not among the criteria that the judgments compare",
                 "list it in the criteria, with a judgment about it");
    }
    criteria.emplace_back(name, Value{Value::Object{{"weight", Value{std::int64_t{0}}}}});
  }
}

std::string edit_minimums(const std::string& text, const Value& change, const FileFaults& faults) {
  const auto file = parse_json(text);
  ConfigFaults none;  // the file was read before
  const ResilienceSettings settings = read_resilience(*file, kFile, none);
  check_minimums(change, settings, faults);
  Value::Object criteria = listed_criteria(*file, settings);
  add_unlisted(change, file->find("judgments") != nullptr, faults, criteria);
  for (auto& [name, criterion] : criteria) {
    const Value* minimum = change.find(name);
    Value::Object members = criterion.object();
    for (const char* bound : {"at_least", "at_most"}) {
      set(members, bound, minimum == nullptr ? nullptr : minimum->find(bound));
    }
    criterion = Value{std::move(members)};
  }
  return with_member(text, "criteria", Value{std::move(criteria)});
}

/// "policy.mode" of the file is "mode" of the change.
void point_into_change(ResiliencePart part, ConfigFaults& faults) {
  if (part == ResiliencePart::criteria) return;
  const std::string_view prefix = part == ResiliencePart::policy ? "policy" : "criteria";
  for (ConfigFault& one : faults) {
    if (!one.key.starts_with(prefix)) continue;
    one.key.erase(0, std::min(prefix.size() + 1, one.key.size()));
  }
}

std::string edited(const std::string& text, ResiliencePart part, const Value& change, const FileFaults& faults) {
  if (part == ResiliencePart::policy) return edit_policy(text, change);
  return part == ResiliencePart::criteria ? edit_criteria(text, change, faults) : edit_minimums(text, change, faults);
}

}  // namespace

std::optional<std::string> edit_resilience(std::string_view text, ResiliencePart part, const Value& change,
                                           ConfigFaults& faults) {
  const FileFaults sink(kFile, faults);
  const std::string old = text.empty() ? "{}\n" : std::string(text);
  const auto file = parse_json(old);
  if (!file || !change.is_object()) {
    sink.add("", file ? "is no object" : "the file is no JSON", R"(write {"NAME": ...})");
    return std::nullopt;
  }
  read_resilience(*file, kFile, faults);  // a file with faults is repaired by hand
  if (!faults.empty()) return std::nullopt;
  std::string out = edited(old, part, change, sink);
  if (faults.empty()) {
    const auto json = parse_json(out);
    if (json) {
      read_resilience(*json, kFile, faults);
    } else {
      sink.add("", json.error().what, json.error().hint);
    }
    point_into_change(part, faults);
  }
  return faults.empty() ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace trb
