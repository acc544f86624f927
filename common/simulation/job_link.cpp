#include "common/simulation/job_link.hpp"

namespace trb::simulation {
namespace {

constexpr Range kDelay{0, 10};  // seconds
constexpr Range kLoss{0, 0.5};  // a part of all packets
constexpr double kMillion = 1e6;
constexpr std::int64_t kLeastBytes = 100, kMostBytes = 100'000'000'000;

LinkKind by_name(ObjectReader& reader) {
  std::vector<std::string> names;
  names.reserve(kLinkKinds.size());
  for (const LinkKind& kind : kLinkKinds) names.push_back(kind.name);
  return kLinkKinds[reader.choice("link", Need::optional, names).value_or(0)];
}

void read_measured(const ObjectReader& reader, const Value::List& list, LinkKind& out) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].is_number() && kDelay.holds(list[i].number())) {
      out.measured.push_back(seconds(list[i].number()));
      continue;
    }
    return reader.faults().add(reader.path("delays_s") + "[" + std::to_string(i) + "]", "is no delay",
                               "write seconds, from 0 to 10");
  }
  if (list.empty()) reader.faults().add(reader.path("delays_s"), "there is none", "write at least one");
}

void read_delay(ObjectReader& reader, LinkKind& out) {
  const Value::List* measured = reader.list("delays_s", Need::optional, kMaxMeasured);
  if (measured != nullptr) return read_measured(reader, *measured, out);
  const double mean_s = reader.number("delay_s", Need::required, kDelay).value_or(0);
  out.delay = seconds(mean_s);
  out.deviation = seconds(reader.number("deviation_s", Need::optional, {0, mean_s}).value_or(0));
}

/// In millionths.
std::uint32_t read_loss(ObjectReader& reader) {
  const double loss = reader.number("loss", Need::optional, kLoss).value_or(0);
  const auto millionths = static_cast<std::uint32_t>(kMillion * loss);
  if (loss > 0 && millionths == 0)
    reader.faults().add(reader.path("loss"), "is less than one packet in a million", "use 0, or 0.000001 or more");
  return millionths;
}

}  // namespace

LinkKind read_link(ObjectReader& of) {
  const Value* json = of.value("link", Need::optional);
  if (json == nullptr || !json->is_object()) return by_name(of);
  ObjectReader reader(*json, "link", of.faults());
  LinkKind out;
  read_delay(reader, out);
  out.loss = read_loss(reader);
  out.bytes_a_second =
      static_cast<std::uint64_t>(reader.integer("bytes_a_second", Need::optional, kLeastBytes, kMostBytes)
                                     .value_or(static_cast<std::int64_t>(out.bytes_a_second)));
  reader.refuse_unknown_keys();
  return out;
}

}  // namespace trb::simulation
