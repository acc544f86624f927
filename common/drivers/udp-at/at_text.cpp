#include "common/drivers/udp-at/at_text.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

/// The message's data as one value and as a list of values.
struct Data {
  Value whole;
  Value::List items;
};

Value value_of(BytesView text) {
  auto json = parse_json(text);
  return json ? std::move(*json) : Value{std::string(text)};
}

Data read_data(BytesView data) {
  Data out{value_of(data), {}};
  if (out.whole.is_list()) {
    out.items = out.whole.list();
  } else if (!out.whole.is_text() || data.starts_with('"')) {
    out.items = {out.whole};
  } else {
    while (!data.empty()) {
      const std::size_t end = std::min(data.find(' '), data.size());
      if (end > 0) out.items.push_back(value_of(data.substr(0, end)));
      data.remove_prefix(std::min(end + 1, data.size()));
    }
  }
  return out;
}

Result<Value> value_for(const AtArgument& argument, const Data& data) {
  if (argument.item == AtArgument::kLiteral) return argument.literal;
  if (argument.item == AtArgument::kWhole) return data.whole;
  const auto item = static_cast<std::size_t>(argument.item);
  if (item < data.items.size()) return data.items[item];
  return fail(Errc::bad_value,
              "needs item " + std::to_string(item) + " of the data, which has " + std::to_string(data.items.size()),
              "give a JSON list with at least " + std::to_string(item + 1) + " items");
}

Error named(const AtLine& line, const Error& error) {
  return fail(error.code, line.name + ": the data " + error.what, error.hint);
}

Result<AtOrder> fill(const AtLine& line, const Data& data) {
  AtOrder order{line.action, line.name, {}, 0};
  for (const AtArgument& argument : line.arguments) {
    const auto value = value_for(argument, data);
    if (!value) return named(line, value.error());
    const auto literal = at_literal(argument.type, *value);
    if (!literal) return named(line, literal.error());
    order.arguments += (order.arguments.empty() ? "" : ",") + *literal;
  }
  for (const AtArgument& argument : line.duration) {
    const auto value = value_for(argument, data);
    if (!value) return named(line, value.error());
    const auto seconds = at_seconds(*value);
    if (!seconds) return named(line, seconds.error());
    order.duration_s = *seconds;
  }
  return order;
}

}  // namespace

Result<std::vector<AtOrder>> fill_at_lines(const std::vector<AtLine>& lines, BytesView data) {
  const Data read = read_data(data);
  std::vector<AtOrder> orders;
  for (const AtLine& line : lines) {
    auto order = fill(line, read);
    if (!order) return order.error();
    orders.push_back(std::move(*order));
  }
  return orders;
}

std::string at_line(std::string_view name, std::uint32_t sequence, std::string_view arguments) {
  std::string line = "AT*" + std::string(name) + "=" + std::to_string(sequence);
  if (!arguments.empty()) line.append(",").append(arguments);
  return line + "\r";
}

}  // namespace trb::drivers
