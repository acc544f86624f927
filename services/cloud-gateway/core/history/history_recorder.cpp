#include "services/cloud-gateway/core/history/history_recorder.hpp"

#include <algorithm>

#include "proto/value.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxRecordedTasks = 200;
constexpr std::size_t kMaxRecordedRuns = 16;

std::string quoted(std::string_view text) {
  return dump_json(trb::Value{cut_utf8(text, HistoryRecorder::kMaxText)});
}

/// A robot may send anything: what is no JSON, or is too long, is kept as a text.
std::string json_of(const std::string& sent) {
  const auto parsed = sent.size() <= HistoryRecorder::kMaxText ? parse_json(sent) : Result<trb::Value>(Error{});
  return parsed ? dump_json(*parsed) : quoted(sent);
}

HistoryEntry entry(const std::string& node, HistoryKind kind, std::string about, std::string value,
                   std::string_view detail, Now now) {
  return {now.utc, node, "", kind, std::move(about), std::move(value), cut_utf8(detail, HistoryRecorder::kMaxText)};
}

template <class Row>
Row content_of(const RowContent& content) {
  const Row* row = std::get_if<Row>(&content);
  return row == nullptr ? Row{} : *row;
}

/// Calls `visit` with the items of `all` that have no same one in `others`.
template <class Item, class Same, class Visit>
void each_new(const std::vector<Item>& all, const std::vector<Item>& others, Same same, Visit visit) {
  for (const Item& one : all) {
    if (std::ranges::none_of(others, [&](const Item& other) { return same(one, other); })) visit(one);
  }
}

bool is_same(const RobotRowFault& a, const RobotRowFault& b) {
  return a.capability == b.capability && a.severity == b.severity && a.text == b.text;
}

bool is_same_use(const OutOfUse& a, const OutOfUse& b) {
  return a.capability == b.capability && a.retired == b.retired && a.text == b.text;
}

bool is_over(RunState state) {
  return state == RunState::finished || state == RunState::aborted || state == RunState::expired;
}

}  // namespace

void HistoryRecorder::changed(const Row& row, const RowContent& before, Now now) {
  if (const auto* node = std::get_if<NodeRow>(&row.content)) return on_node(row, *node, before, now);
  if (const auto* robot = std::get_if<RobotRow>(&row.content))
    return on_robot(row, *robot, content_of<RobotRow>(before), now);
  if (const auto* run = std::get_if<RunView>(&row.content)) return on_run(*run, before, now);
  if (const auto* reading = std::get_if<SensorReading>(&row.content)) return on_reading(row, *reading, now);
  if (row.is_removed() && row.key.kind == RowKind::robot) forget(row.key.node);
}

void HistoryRecorder::on_node(const Row& row, const NodeRow& node, const RowContent& before, Now now) {
  if (content_of<NodeRow>(before).state == node.state) return;
  add(entry(row.key.node, HistoryKind::node, "", quoted(node.state), node.reason, now), now);
}

void HistoryRecorder::on_robot(const Row& row, const RobotRow& robot, const RobotRow& before, Now now) {
  const std::string& id = row.key.node;
  if (robot.connection != before.connection || robot.detail != before.detail)
    add_within_share(entry(id, HistoryKind::connection, "", quoted(robot.connection), robot.detail, now), now);
  if (robot.fenced != before.fenced)
    add_within_share(entry(id, HistoryKind::fence, "", robot.fenced ? "true" : "false", "", now), now);
  if (robot.control != before.control)
    add_within_share(entry(id, HistoryKind::control, "", quoted(robot.control), "", now), now);
  on_faults(row, robot, before, now);
  on_use(row, robot, before, now);
  on_values(row, robot, before, now);
}

void HistoryRecorder::on_faults(const Row& row, const RobotRow& robot, const RobotRow& before, Now now) {
  const auto note = [&](HistoryKind kind) {
    return [this, &row, kind, now](const RobotRowFault& one) {
      add_within_share(entry(row.key.node, kind, one.capability, quoted(one.text), name_of(one.severity), now), now);
    };
  };
  each_new(before.faults, robot.faults, is_same, note(HistoryKind::fault_ended));
  each_new(robot.faults, before.faults, is_same, note(HistoryKind::fault));
}

void HistoryRecorder::on_use(const Row& row, const RobotRow& robot, const RobotRow& before, Now now) {
  const auto note = [&](HistoryKind kind) {
    return [this, &row, kind, now](const OutOfUse& one) {
      add_within_share(entry(row.key.node, kind, one.capability, quoted(one.text), one.by, now), now);
    };
  };
  each_new(before.out_of_use, robot.out_of_use, is_same_use, note(HistoryKind::in_use));
  each_new(robot.out_of_use, before.out_of_use, is_same_use, note(HistoryKind::out_of_use));
}

void HistoryRecorder::on_values(const Row& row, const RobotRow& robot, const RobotRow& before, Now now) {
  const auto same = [](const RobotValue& a, const RobotValue& b) { return a.name == b.name && a.value == b.value; };
  each_new(robot.values, before.values, same, [&](const RobotValue& one) {
    HistoryEntry entry_of =
        entry(row.key.node, HistoryKind::value, cut_utf8(one.name, 64), json_of(one.value), "", now);
    const ValueKey key{row.key.node, one.name};
    const auto [at, is_first] = values_.try_emplace(key);
    if (is_first || now.mono - at->second.recorded >= kValue) {
      at->second = {now.mono, std::nullopt};
      return add(std::move(entry_of), now);
    }
    if (!at->second.waiting) due_.emplace(at->second.recorded + kValue, key);
    at->second.waiting = std::move(entry_of);
  });
}

/// Of a run that was not seen before only what goes on: the rest was recorded, or happened before this gateway's start.
void HistoryRecorder::on_run(const RunView& run, const RowContent& before, Now now) {
  const auto* former = std::get_if<RunView>(&before);
  for (const TaskView& task : run.tasks) {
    const auto same = [&](const TaskView& one) {
      return one.id == task.id && one.state == task.state && one.robot == task.robot && one.attempt == task.attempt;
    };
    const bool is_known =
        former != nullptr ? std::ranges::any_of(former->tasks, same) : task.state != TaskState::running;
    if (is_known || task.robot.empty()) continue;
    add_within_share(
        entry(task.robot, HistoryKind::task, run.run + "/" + task.id, quoted(name_of(task.state)), task.skill, now),
        now);
  }
}

void HistoryRecorder::on_reading(const Row& row, const SensorReading& reading, Now now) {
  HistoryEntry out = entry(row.key.node, HistoryKind::reading, reading.unit, "", reading.quality, now);
  out.sensor = row.key.name;
  out.value = reading.is_text ? quoted(reading.text) : dump_json(trb::Value{reading.number});
  add_within_share(std::move(out), now);
}

void HistoryRecorder::forget(const std::string& robot) {
  std::erase_if(due_, [&](const auto& one) { return one.second.first == robot; });
  values_.erase(values_.lower_bound({robot, ""}), values_.lower_bound({robot + '\0', ""}));
}

/// Texts may change with every message, readings too. Values have a pace of their own, and the router limits how often
/// a node comes and goes.
void HistoryRecorder::add_within_share(HistoryEntry entry, Now now) {
  if (shares_.size() == kMaxShares && !shares_.contains(entry.node)) shares_.clear();
  WriteShare& share = shares_[entry.node].of(entry.kind);
  share.take(now.utc) ? add(std::move(entry), now) : leave_out(entry.node);
}

void HistoryRecorder::add(HistoryEntry entry, Now now) {
  std::size_t& of_node = waiting_of_[entry.node];
  if (of_node >= kMaxWaiting - waiting_.size()) return leave_out(entry.node);
  ++of_node;
  if (!since_) since_ = now.mono;
  waiting_.push_back(std::move(entry));
}

void HistoryRecorder::tick(Now now) {
  while (!due_.empty() && due_.begin()->first <= now.mono) {
    Value& value = values_[due_.begin()->second];
    due_.erase(due_.begin());
    value.recorded = now.mono;
    if (value.waiting) add(*std::exchange(value.waiting, std::nullopt), now);
  }
}

std::optional<MonotonicTime> HistoryRecorder::next_deadline() const {
  std::optional<MonotonicTime> out;
  if (since_) out = *since_ + kFlush;
  return due_.empty() ? out : earlier(out, due_.begin()->first);
}

std::vector<HistoryEntry> HistoryRecorder::take() {
  since_.reset();
  waiting_of_.clear();
  return std::exchange(waiting_, {});
}

void HistoryRecorder::leave_out(const std::string& node) {
  count_lost(1);
  ++left_out_[node];
}

std::set<std::string> recorded_runs(const RowBook& book) {
  std::set<std::string> out;
  book.each(RowKind::run, [&](const Row& row) {
    const auto& run = std::get<RunSummary>(row.content);
    if (!is_over(run.state) && run.tasks <= kMaxRecordedTasks && out.size() < kMaxRecordedRuns) out.insert(run.run);
  });
  return out;
}

}  // namespace trb::gateway
