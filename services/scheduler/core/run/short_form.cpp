#include "services/scheduler/core/run/short_form.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/varint.hpp"
#include "proto/body.hpp"

namespace trb::scheduler {
namespace {

constexpr unsigned kOutcome = 0x0f, kGoesOn = 0x10, kHasText = 0x20, kIsLater = 0x40, kHasDuration = 0x80;
constexpr std::size_t kSignatureSize = 64;

Error malformed() {
  return fail(Errc::malformed, "short_form: malformed or cut");
}

// ---- which tasks

std::vector<std::uint64_t> turns_of(const std::vector<bool>& tasks) {
  std::vector<std::uint64_t> out;
  bool last = false;
  std::uint64_t length = 0;
  for (const bool is : tasks) {
    if (is != last) out.push_back(std::exchange(length, 0));
    last = is;
    ++length;
  }
  if (last) out.push_back(length);
  return out;
}

/// Takes the bitmap into the form if it becomes shorter; else it stays where it is.
void put_turns(Bytes& out, Blob& bitmap, std::size_t tasks) {
  const auto is = from_bitmap(bitmap.bytes, tasks);
  const auto turns = is ? turns_of(*is) : std::vector<std::uint64_t>{};
  Bytes text;
  put_varint(text, turns.size());
  for (const std::uint64_t length : turns) put_varint(text, length);
  if (turns.empty() || text.size() > bitmap.bytes.size() + 1) return put_varint(out, 0);
  out += text;
  bitmap.bytes.clear();
}

Status read_turns(VarintReader& from, Blob& bitmap, std::size_t tasks) {
  const std::uint64_t count = from.number();
  if (!from.ok() || count > tasks) return malformed();
  if (count == 0) return Done{};
  std::vector<bool> out;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t length = from.number();
    if (!from.ok() || length > tasks - out.size()) return malformed();
    out.insert(out.end(), length, i % 2 == 1);
  }
  bitmap.bytes = to_bitmap(out);
  return Done{};
}

// ---- a result

double to_seconds(std::int64_t ns) {
  return static_cast<double>(ns) / 1e9;
}

/// What the duration is more than the time by the clock; nullopt: it would not come back the same.
std::optional<std::int64_t> excess_of(const TaskResult& result, std::int64_t lasted) {
  constexpr double kMost = 1e6;  // seconds, of which a double counts every nanosecond
  if (!(std::abs(result.duration_s) < kMost) || std::abs(to_seconds(lasted)) > kMost) return std::nullopt;
  const std::int64_t ns = std::llround(result.duration_s * 1e9);
  if (std::bit_cast<std::uint64_t>(to_seconds(ns)) != std::bit_cast<std::uint64_t>(result.duration_s))
    return std::nullopt;
  return ns - lasted;
}

/// Differences wrap around: clocks may say anything.
std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

void put_text(Bytes& out, const std::string& text) {
  put_varint(out, text.size());
  out += text;
}

void put_duration(Bytes& out, const TaskResult& result, const std::optional<std::int64_t>& excess) {
  if (excess) return put_signed_varint(out, *excess);
  const auto bits = std::bit_cast<std::uint64_t>(result.duration_s);
  for (unsigned i = 0; i < 8; ++i) out += static_cast<char>(bits >> (8 * i));
}

Bytes write_result(const TaskResult& result, const Bytes& signature, TaskIndex task, std::size_t robot,
                   const RunDefinition& definition) {
  const std::int64_t lasted = difference(result.ended, result.started);
  const auto excess = excess_of(result, lasted);
  const bool has_text = !result.reason.empty() || !result.data.empty();
  const bool is_later = result.key.attempt != 1 || result.epoch != 1;
  Bytes out;
  put_varint(out, task);
  put_varint(out, robot);
  out += static_cast<char>(static_cast<unsigned>(result.outcome) | (result.goes_on ? kGoesOn : 0) |
                           (has_text ? kHasText : 0) | (is_later ? kIsLater : 0) | (excess ? 0 : kHasDuration));
  if (is_later) put_varint(out, result.key.attempt);
  if (is_later) put_varint(out, result.epoch);
  if (has_text) put_text(out, result.reason);
  if (has_text) put_text(out, result.data);
  put_signed_varint(out, difference(result.started, definition.start().created));
  put_signed_varint(out, lasted);
  put_duration(out, result, excess);
  return out + signature;
}

Status read_names(VarintReader& from, const RunDefinition& definition, TaskResult& out) {
  const std::uint64_t task = from.number();
  const std::uint64_t robot = from.number();
  if (!from.ok()) return malformed();
  const auto& members = definition.start().members;
  if (task >= definition.tasks().size()) return fail(Errc::bad_value, "short_form: no such task");
  if (robot >= members.size()) return fail(Errc::bad_value, "short_form: no such robot");
  out.key = {definition.id(), definition.tasks()[task].id, 1, 1};
  out.digest = definition.start().digest;
  out.robot = members[robot].id;
  return Done{};
}

void read_times(VarintReader& from, bool has_duration, const RunDefinition& definition, TaskResult& out) {
  out.started = sum(definition.start().created, from.signed_number());
  const std::int64_t lasted = from.signed_number();
  out.ended = sum(out.started, lasted);
  if (!has_duration) {
    out.duration_s = to_seconds(sum(lasted, from.signed_number()));
    return;
  }
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < 8; ++i) bits |= std::uint64_t{from.byte()} << (8 * i);
  out.duration_s = std::bit_cast<double>(bits);
}

Result<SignedRecord> read_result(VarintReader& from, const RunDefinition& definition) {
  TaskResult out;
  if (Status names = read_names(from, definition, out); !names) return names.error();
  const unsigned bits = from.byte();
  if ((bits & kOutcome) > static_cast<unsigned>(TaskOutcome::released)) {
    return fail(Errc::bad_value, "short_form: no such outcome");
  }
  out.outcome = static_cast<TaskOutcome>(bits & kOutcome);
  out.goes_on = (bits & kGoesOn) != 0;
  if ((bits & kIsLater) != 0) {
    const std::uint64_t attempt = from.number();
    const std::uint64_t epoch = from.number();
    if (attempt > UINT32_MAX || epoch > UINT32_MAX) return malformed();
    out.key.attempt = static_cast<std::uint32_t>(attempt);
    out.epoch = static_cast<std::uint32_t>(epoch);
  }
  if ((bits & kHasText) != 0) out.reason = from.bytes(from.number());
  if ((bits & kHasText) != 0) out.data = from.bytes(from.number());
  read_times(from, (bits & kHasDuration) != 0, definition, out);
  const BytesView signature = from.bytes(kSignatureSize);
  if (!from.ok() || !std::isfinite(out.duration_s)) return malformed();
  return SignedRecord{std::string(kSignedResult), out.robot, {encode(out)}, {Bytes(signature)}};
}

std::optional<Bytes> short_result(const SignedRecord& record, const RunDefinition& definition) {
  const auto result = decode<TaskResult>(record.payload.bytes);
  if (!result) return std::nullopt;
  const auto task = definition.index_of(result->key.task);
  const auto& members = definition.start().members;
  const auto robot = std::ranges::find(members, result->robot, &Member::id);
  if (!task || robot == members.end()) return std::nullopt;
  Bytes out = write_result(*result, record.signature.bytes, *task, static_cast<std::size_t>(robot - members.begin()),
                           definition);
  VarintReader reader(out);
  const auto again = read_result(reader, definition);
  if (!again || !(*again == record) || !reader.at_end()) return std::nullopt;
  return out;
}

void put_results(Bytes& out, std::vector<SignedRecord>& results, const RunDefinition& definition) {
  std::erase_if(results, [&](const SignedRecord& record) {
    const auto is = short_result(record, definition);
    if (is) out += *is;
    return is.has_value();
  });
}

Status read_results(VarintReader& from, std::vector<SignedRecord>& results, const RunDefinition& definition) {
  while (!from.at_end()) {
    auto record = read_result(from, definition);
    if (!record) return record.error();
    if (results.size() >= kMaxTasks) return malformed();
    results.push_back(std::move(*record));
  }
  return Done{};
}

}  // namespace

BytesView tag_of(const Blob& short_form) {
  return BytesView(short_form.bytes).substr(0, RunDefinition::kTagSize);
}

void shorten(Baton& baton, const RunDefinition& definition) {
  Bytes& out = baton.short_form.bytes;
  out = definition.tag();
  put_varint(out, baton.epoch);
  put_turns(out, baton.final_tasks, definition.tasks().size());
  put_turns(out, baton.skipped_tasks, definition.tasks().size());
  put_results(out, baton.results, definition);
  baton.run.clear();
  baton.digest.bytes.clear();
  baton.epoch = 1;
}

void shorten(Results& results, const RunDefinition& definition) {
  results.short_form.bytes = definition.tag();
  put_results(results.short_form.bytes, results.results, definition);
  results.run.clear();
}

Result<Baton> lengthened(Baton baton, const RunDefinition& definition) {
  const Bytes form = std::exchange(baton.short_form.bytes, {});
  VarintReader from(form);
  from.bytes(RunDefinition::kTagSize);
  baton.run = definition.id();
  baton.digest = definition.start().digest;
  const std::uint64_t epoch = from.number();
  if (!from.ok() || epoch > UINT32_MAX) return malformed();
  baton.epoch = static_cast<std::uint32_t>(epoch);
  const std::size_t tasks = definition.tasks().size();
  if (Status read = read_turns(from, baton.final_tasks, tasks); !read) return read.error();
  if (Status read = read_turns(from, baton.skipped_tasks, tasks); !read) return read.error();
  if (Status read = read_results(from, baton.results, definition); !read) return read.error();
  return baton;
}

Result<Results> lengthened(Results results, const RunDefinition& definition) {
  const Bytes form = std::exchange(results.short_form.bytes, {});
  VarintReader from(form);
  from.bytes(RunDefinition::kTagSize);
  results.run = definition.id();
  if (Status read = read_results(from, results.results, definition); !read) return read.error();
  return results;
}

}  // namespace trb::scheduler
