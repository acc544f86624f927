#include "services/virtual-robots/ur/rtde_session.hpp"

#include <algorithm>
#include <cmath>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::size_t kHeader = 3;

std::string package(char type, std::string_view body) {
  Bytes bytes;
  bytes.u16(static_cast<std::uint16_t>(kHeader + body.size())).u8(static_cast<std::uint8_t>(type)).text(body);
  return bytes.str();
}

std::string accepted(char type, bool yes) {
  return package(type, Bytes().u8(yes ? 1 : 0).str());
}

std::string joined(const std::vector<std::string_view>& types) {
  std::string out;
  for (const std::string_view type : types) out += (out.empty() ? "" : ",") + std::string(type);
  return out;
}

std::string with_id(std::uint8_t id, const std::string& types) {
  return Bytes().u8(id).text(types).str();
}

/** The names of a recipe; none if the list is too long. */
std::vector<std::string> names_of(std::string_view list) {
  if (list.empty() || list.size() > RtdeSession::kLongestNames) return {};
  std::vector<std::string> names;
  for (const std::string& name : split(list, ',')) names.emplace_back(trim(name));
  return names;
}

}  // namespace

std::string RtdeSession::take(std::string& input, RtdeWritten& written, double time) {
  std::string answers;
  std::size_t at = 0;
  while (!broken_ && input.size() - at >= kHeader) {
    Reader header(std::string_view(input).substr(at, kHeader));
    const std::size_t size = header.u16();
    const std::uint8_t type = header.u8();
    broken_ = size < kHeader;
    if (broken_ || input.size() - at < size) break;
    answers += answer(type, std::string_view(input).substr(at + kHeader, size - kHeader), written, time);
    at += size;
  }
  input.erase(0, at);
  return answers;
}

std::string RtdeSession::answer(std::uint8_t type, std::string_view body, RtdeWritten& written, double time) {
  switch (type) {
    case 'V':
      return negotiate(body);
    case 'v':
      return package('v', Bytes().u32(5).u32(12).u32(0).u32(0).str());
    case 'M':
      return keep_text(body);
    case 'O':
      return set_outputs(body);
    case 'I':
      return set_inputs(body);
    case 'S':
      return start(time);
    case 'P':
      started_ = false;
      return accepted('P', true);
    case 'U':
      return take_data(body, written);
    default:
      return complaint("unknown package type " + std::to_string(type));
  }
}

std::string RtdeSession::negotiate(std::string_view body) {
  Reader in(body);
  const int wanted = in.u16();
  const bool known = in.at_end() && (wanted == 1 || wanted == 2);
  if (known) version_ = wanted;
  return accepted('V', known);
}

std::string RtdeSession::set_outputs(std::string_view body) {
  Reader in(body);
  const double rate = version_ == 2 ? in.f64() : kFastest;
  const std::vector<std::string> names = names_of(in.rest());
  Outputs outputs;
  // Beyond what it can do it does what it can; a rate that is no number is the fastest.
  outputs.period = 1 / (rate > 0 ? std::clamp(rate, 1.0, kFastest) : kFastest);
  std::vector<std::string_view> types;
  for (const std::string& name : names) {
    const auto found = rtde_output(name);
    types.push_back(found ? name_of(found->type) : "NOT_FOUND");
    if (found) outputs.fields.push_back(*found);
  }
  const bool valid = in.ok() && !names.empty() && outputs.fields.size() == names.size();
  started_ = false;
  outputs_ = valid ? std::optional(std::move(outputs)) : std::nullopt;
  return package('O', version_ == 2 ? with_id(valid ? 1 : 0, joined(types)) : joined(types));
}

std::string RtdeSession::set_inputs(std::string_view body) {
  const std::vector<std::string> names = names_of(body);
  std::vector<RtdeInput> recipe;
  std::vector<std::string_view> types;
  std::vector<std::string> seen;
  for (const std::string& name : names) {
    const auto found = rtde_input(name);
    const bool in_use = claims_.owner_of(name) != 0 || std::find(seen.begin(), seen.end(), name) != seen.end();
    types.push_back(!found ? "NOT_FOUND" : in_use ? "IN_USE" : name_of(found->type));
    if (found && !in_use) recipe.push_back(*found);
    seen.push_back(name);
  }
  if (names.empty() || recipe.size() != names.size() || recipes_.size() == kMostRecipes) {
    return package('I', with_id(0, joined(types)));
  }
  for (const std::string& name : names) claims_.claim(name, id_);
  recipes_.push_back(std::move(recipe));
  return package('I', with_id(static_cast<std::uint8_t>(recipes_.size()), joined(types)));
}

std::string RtdeSession::start(double time) {
  const bool possible = outputs_ || !recipes_.empty();
  if (possible && !started_) due_ = time;
  started_ = possible;
  return accepted('S', possible);
}

std::string RtdeSession::take_data(std::string_view body, RtdeWritten& written) {
  Reader in(body);
  const std::size_t id = in.u8();
  if (id == 0 || id > recipes_.size()) return complaint("no input recipe " + std::to_string(id));
  const std::vector<RtdeInput>& recipe = recipes_[id - 1];
  std::size_t size = 1;
  for (const RtdeInput& field : recipe) size += size_of(field.type);
  if (size != body.size()) {
    return complaint("input recipe " + std::to_string(id) + " has " + std::to_string(size - 1) + " bytes");
  }
  for (const RtdeInput& field : recipe) field.take(in, field.index, written);
  changed_ = true;
  return {};
}

std::string RtdeSession::keep_text(std::string_view body) {
  constexpr std::size_t kMostTexts = 16;
  Reader in(body);
  std::string text;
  if (version_ == 2) {
    text = in.text(in.u8());
    in.text(in.u8());  // who says it
    in.u8();           // the level
  } else {
    in.u8();
    text = in.rest();
  }
  if (!in.at_end()) return complaint("a text that is not of its form");
  if (texts_.size() < kMostTexts) texts_.push_back(std::move(text));
  return {};
}

std::string RtdeSession::complaint(std::string_view text) const {
  constexpr std::uint8_t kError = 1;
  constexpr std::string_view kSource = "RTDE";
  if (version_ == 1) return package('M', Bytes().u8(kError).text(text).str());
  Bytes body;
  body.u8(static_cast<std::uint8_t>(text.size())).text(text);
  body.u8(static_cast<std::uint8_t>(kSource.size())).text(kSource).u8(kError);
  return package('M', body.str());
}

std::string RtdeSession::data(const RtdePicture& picture, double time) {
  if (!started_ || !outputs_ || time < due_) return {};
  due_ = due_ + outputs_->period > time ? due_ + outputs_->period : time + outputs_->period;
  Bytes body;
  if (version_ == 2) body.u8(1);
  for (const RtdeOutput& field : outputs_->fields) field.put(picture, field.index, body);
  return package('U', body.str());
}

}  // namespace trb::virtual_robots::ur
