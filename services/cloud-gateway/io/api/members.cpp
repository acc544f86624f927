#include "services/cloud-gateway/io/api/members.hpp"

#include <algorithm>
#include <cmath>

#include "proto/value.hpp"
#include "proto/value_words.hpp"

namespace trb::gateway {
namespace {

Error wrong_member(std::string_view name, const Value& found, std::string_view wanted) {
  return fail(Errc::bad_value, std::string(name) + ": is " + in_words(found), "write a " + std::string(wanted));
}

}  // namespace

Result<Members> Members::of(const Call& call, std::initializer_list<std::string_view> names) {
  auto json = body_of(call);
  if (!json) return json.error();
  return of(std::move(*json), names);
}

Result<Members> Members::of(Value json, std::initializer_list<std::string_view> names) {
  if (!json.is_object()) return fail(Errc::bad_value, "it is no object", R"(write {"name": ...})");
  for (const auto& [name, value] : json.object()) {
    if (std::ranges::find(names, name) != names.end()) continue;
    std::string all;
    for (const std::string_view one : names) all += (all.empty() ? "" : ", ") + std::string(one);
    return fail(Errc::bad_value, name.substr(0, 60) + ": there is no such member", "use: " + all);
  }
  return Members(std::move(json));
}

Result<std::string> Members::text(std::string_view name, std::size_t most) const {
  const Value* found = json_.find(name);
  if (found == nullptr) return fail(Errc::missing, std::string(name) + ": is missing", "add it");
  if (!found->is_text()) return wrong_member(name, *found, "text");
  if (found->text().size() <= most) return found->text();
  return fail(Errc::too_large, std::string(name) + ": has " + std::to_string(found->text().size()) + " bytes",
              "use at most " + std::to_string(most));
}

Result<std::string> Members::text_or(std::string_view name, std::size_t most, std::string otherwise) const {
  return has(name) ? text(name, most) : Result<std::string>(std::move(otherwise));
}

Result<bool> Members::flag_or(std::string_view name, bool otherwise) const {
  const Value* found = json_.find(name);
  if (found == nullptr) return otherwise;
  return found->is_bool() ? Result<bool>(found->boolean()) : wrong_member(name, *found, "true or false");
}

Result<std::int64_t> Members::number_or(std::string_view name, std::int64_t otherwise, std::int64_t from,
                                        std::int64_t to) const {
  const Value* found = json_.find(name);
  if (found == nullptr) return otherwise;
  if (found->is_integer() && found->integer() >= from && found->integer() <= to) return found->integer();
  return fail(Errc::bad_value, std::string(name) + ": is out of range",
              "use a whole number from " + std::to_string(from) + " to " + std::to_string(to));
}

Result<std::vector<double>> Members::numbers(std::string_view name, std::size_t most) const {
  const Value* found = json_.find(name);
  if (found == nullptr) return fail(Errc::missing, std::string(name) + ": is missing", "add it");
  if (!found->is_list()) return wrong_member(name, *found, "list of numbers");
  if (found->list().size() > most) {
    return fail(Errc::too_large, std::string(name) + ": has " + std::to_string(found->list().size()) + " numbers",
                "use at most " + std::to_string(most));
  }
  std::vector<double> out;
  for (const Value& one : found->list()) {
    if (!one.is_number() || !std::isfinite(one.number())) return wrong_member(name, one, "list of numbers");
    out.push_back(one.number());
  }
  return out;
}

Result<std::string> reason_in(const Call& call, std::size_t most) {
  if (call.request.body.empty()) return std::string();
  const auto body = Members::of(call, {"reason"});
  if (!body) return body.error();
  return body->text_or("reason", most, "");
}

std::string with_name(const Call& call, const std::string& reason, std::size_t most) {
  return cut_utf8("by " + call.who().name + (reason.empty() ? "" : ": " + reason), most);
}

}  // namespace trb::gateway
