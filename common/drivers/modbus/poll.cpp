#include "common/drivers/modbus/poll.hpp"

#include <algorithm>

#include "common/drivers/modbus/exception.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

std::string json_of(const ModbusPlace& place, double number) {
  if (place.type == ModbusType::boolean) return number == 0 ? "false" : "true";
  return number_text(number);
}

}  // namespace

ModbusPoll::ModbusPoll(const ModbusPlaces& polled, const ModbusPlace& probe, Duration period) : period_(period) {
  std::vector<Item> items;
  for (const auto& [name, place] : polled) items.push_back({name, place});
  std::ranges::stable_sort(items, {}, [](const Item& item) { return std::pair(item.place.kind, item.place.address); });
  probes_ = items.empty();
  if (probes_) items.push_back({"", probe});
  for (Item& item : items) {
    if (blocks_.empty() || !continues(blocks_.back(), item.place)) blocks_.emplace_back();
    Block& block = blocks_.back();
    const std::uint16_t first = block.items.empty() ? item.place.address : block.items.front().place.address;
    const auto end = static_cast<std::uint16_t>(item.place.address - first + item.place.size());
    block.count = std::max(block.count, end);
    block.items.push_back(std::move(item));
  }
  whole_ = blocks_;
}

/// Only adjacent or overlapping values: the device may not have the registers between others.
bool ModbusPoll::continues(const Block& block, const ModbusPlace& place) {
  const ModbusPlace& first = block.items.front().place;
  const int begin = place.address - first.address;
  return place.kind == first.kind && begin <= block.count && begin + place.size() <= kMostModbusRegisters;
}

void ModbusPoll::restart(Now now) {
  drop_values();
  blocks_ = whole_;
  at_ = 0;
  due_ = now.mono;
}

ModbusCall ModbusPoll::call() const {
  const Block& block = blocks_[at_];
  const ModbusPlace& first = block.items.front().place;
  return {false, first.kind, first.address, block.count, {}};
}

ModbusPoll::Changes ModbusPoll::on_answer(const ModbusAnswer& answer, Now now) {
  Changes changes;
  const Block& block = blocks_[at_];
  if (modbus_blames_place(answer.exception) && block.items.size() > 1) {
    split(block);  // one of them is faulty: each is read alone while the connection lasts
    return changes;
  }
  if (!probes_) take(block, answer, now, changes);
  advance(now);
  return changes;
}

void ModbusPoll::split(Block block) {
  std::vector<Block> singles;
  for (Item& item : block.items) singles.push_back({item.place.size(), {item}});
  blocks_.erase(blocks_.begin() + static_cast<std::ptrdiff_t>(at_));
  blocks_.insert(blocks_.begin() + static_cast<std::ptrdiff_t>(at_), singles.begin(), singles.end());
}

void ModbusPoll::take(const Block& block, const ModbusAnswer& answer, Now now, Changes& changes) {
  const std::uint16_t first = block.items.front().place.address;
  const bool busy = modbus_busy(answer.exception) && is_busy_briefly(now);
  if (answer.exception == 0) busy_since_.reset();
  for (const Item& item : block.items) {
    const std::string meant = item.name + " (" + to_text(item.place) + ")";
    if (answer.exception != 0) {
      const Error why = modbus_exception(answer.exception, meant);
      if (busy) {
        lose_quietly(item.name, why);
      } else {
        lose(item.name, why, changes, modbus_exception_text(answer.exception));
      }
      continue;
    }
    const auto begin = static_cast<std::size_t>(item.place.address - first);
    std::vector<std::uint16_t> words;
    for (std::size_t i = begin; i < begin + item.place.size() && i < answer.words.size(); ++i) {
      words.push_back(answer.words[i]);
    }
    const auto number = modbus_number(item.place, words);
    if (!number) {
      lose(item.name, fail(Errc::robot_error, item.name + ": " + number.error().what, number.error().hint), changes);
      continue;
    }
    keep(item.name, {{*number}, json_of(item.place, *number), now.mono}, changes);
  }
}

/// Such a device is well again soon: no fault for each time that it is busy.
bool ModbusPoll::is_busy_briefly(Now now) {
  constexpr Duration kBriefly = std::chrono::seconds(3);
  if (!busy_since_) busy_since_ = now.mono;
  return now.mono - *busy_since_ < kBriefly;
}

void ModbusPoll::advance(Now now) {
  if (++at_ < blocks_.size()) return;
  at_ = 0;
  due_ = std::max(due_ + period_, now.mono);
}

}  // namespace trb::drivers
