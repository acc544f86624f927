#include "common/drivers/c3/job.hpp"

#include <algorithm>

#include "common/drivers/c3/krl.hpp"

namespace trb::drivers {

C3Command::C3Command(const std::vector<C3Assignment>& assignments) {
  for (const C3Assignment& one : assignments) {
    assignments_.push_back({one.variable, VendorTemplate(one.value)});
    items_ = std::max(items_, assignments_.back().value.items());
  }
}

Result<std::vector<C3Step>> C3Command::fill(BytesView data) const {
  if (items_ > 0) {
    const auto json = parse_json(data);
    if (json && json->is_list() && json->list().size() != items_) {
      return fail(Errc::bad_value,
                  "the command takes " + std::to_string(items_) + " items, and the data has " +
                      std::to_string(json->list().size()),
                  "give a JSON list of " + std::to_string(items_) + " items");
    }
  }
  std::vector<C3Step> out;
  for (const Assignment& assignment : assignments_) {
    auto value = assignment.value.fill(data, krl_literal);
    if (!value) return value.error();
    out.push_back({assignment.variable, std::move(*value)});
  }
  return out;
}

std::vector<C3Step> C3Command::steps() const {
  auto filled = fill({});
  return filled ? std::move(*filled) : std::vector<C3Step>{};
}

std::vector<C3Step> c3_field_steps(const C3Names& names, const Handover& message, std::int64_t number,
                                   std::size_t chunk_bytes) {
  std::vector<C3Step> steps = {{names.type, krl_field(name_of(message.type))},
                               {names.subtype, krl_field(message.subtype)},
                               {names.source, krl_field(message.source)},
                               {names.size, std::to_string(message.data.size())}};
  const auto chunks = krl_chunks(message.data, chunk_bytes);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    steps.push_back({names.data, chunks[i]});
    if (i + 1 < chunks.size()) steps.push_back({names.chunk, "TRUE", true});
  }
  steps.push_back({names.number, std::to_string(number)});
  steps.push_back({names.command, "TRUE"});
  return steps;
}

}  // namespace trb::drivers
