#include "services/mode-adapter/core/out_of_use_book.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

constexpr Duration kSaveAgain = std::chrono::seconds(1);

/// Merges several faults of one capability: the worst, with the newest words, since the first.
void join(OutOfUse& shown, const OutOfUse& more) {
  const bool words = more.severity > shown.severity || (more.severity == shown.severity && more.since >= shown.since);
  if (words) {
    shown.text = more.text;
    shown.by = more.by;
  }
  shown.severity = std::max(shown.severity, more.severity);
  shown.since = std::min(shown.since, more.since);
}

}  // namespace

OutOfUseBook::OutOfUseBook(std::vector<Kept> lines, PersistOutOfUse persist) : persist_(std::move(persist)) {
  for (Kept& line : lines) {
    line.said_now = false;
    std::string cause = line.cause;
    lines_.emplace(std::move(cause), std::move(line));
  }
  show();
}

Status OutOfUseBook::add(Kept line, Now now, Outbox& out) {
  Kept& kept = lines_[line.cause];
  const bool is_new = kept.cause.empty();
  const bool other = is_new || kept.what.severity != line.what.severity || kept.what.capability != line.what.capability;
  const bool other_words = kept.what.text != line.what.text || kept.what.by != line.what.by;
  if (!is_new) line.what.since = kept.what.since;
  kept = std::move(line);
  // A robot that reports the same in changing words must not wear out the disk.
  // Nor may who says it again, because it was not on disk, be told that it is.
  if (other || has_failed_ || (other_words && kept.what.retired)) return save(now, out);
  if (other_words && !save_at_) save_at_ = now.mono + kSaveAgain;
  return Done{};
}

std::optional<OutOfUse> OutOfUseBook::end(const std::string& cause, Now now, Outbox& out) {
  const auto found = lines_.find(cause);
  if (found == lines_.end()) return std::nullopt;
  OutOfUse ended = std::move(found->second.what);
  lines_.erase(found);
  (void)save(now, out);  // if a restart restores the line, the robot's first report ends it again
  return ended;
}

Result<std::vector<OutOfUse>> OutOfUseBook::repaired(const std::string& capability, bool robot_online) {
  std::vector<OutOfUse> ended;
  Lines left;
  for (const auto& [cause, line] : lines_) {
    const bool meant = !line.what.retired && (capability.empty() || line.what.capability == capability);
    if (meant && line.said_now && robot_online) {
      return fail(Errc::conflict, "it still says \"" + line.what.text + "\"",
                  "mend it until the robot itself says so no more");
    }
    if (meant) ended.push_back(line.what);
    if (!meant) left.emplace(cause, line);
  }
  if (ended.empty()) {
    const std::string what = capability.empty() ? "the robot" : "'" + capability + "' alone";
    return fail(Errc::conflict, "no fault keeps " + what + " out of use", "see trb robot list");
  }
  if (Status saved = save_without(std::move(left)); !saved) return saved.error();
  return ended;
}

Status OutOfUseBook::returned() {
  Lines left = lines_;
  if (left.erase(kRetired) == 0) return fail(Errc::conflict, "the robot is not retired", "see trb robot list");
  return save_without(std::move(left));
}

const OutOfUse* OutOfUseBook::keeps_out(std::string_view capability) const {
  for (const auto& [cause, line] : lines_) {
    if (line.what.capability.empty() || line.what.capability == capability) return &line.what;
  }
  return nullptr;
}

bool OutOfUseBook::faulty(std::string_view capability) const {
  return std::ranges::any_of(lines_, [&](const auto& line) {
    const OutOfUse& what = line.second.what;
    return !what.retired && (what.capability.empty() || what.capability == capability);
  });
}

void OutOfUseBook::tick(Now now, Outbox& out) {
  if (save_at_ && now.mono >= *save_at_) (void)save(now, out);
}

Status OutOfUseBook::save(Now now, Outbox& out) {
  std::vector<Kept> lines;
  for (const auto& [cause, line] : lines_) lines.push_back(line);
  Status saved = persist_(lines);
  has_failed_ = !saved;
  save_at_ = saved ? std::nullopt : std::optional(now.mono + kSaveAgain);
  if (!saved) out.log(LogLevel::error, "out_of_use_not_saved", saved.error().text());
  show();
  return saved;
}

/// The disk first: what a person was told to be in use must stay in use.
Status OutOfUseBook::save_without(Lines left) {
  std::vector<Kept> lines;
  for (const auto& [cause, line] : left) lines.push_back(line);
  if (Status saved = persist_(lines); !saved) return saved;
  lines_ = std::move(left);
  has_failed_ = false;
  save_at_.reset();
  show();
  return Done{};
}

void OutOfUseBook::show() {
  shown_.clear();
  for (const auto& [cause, line] : lines_) {
    const OutOfUse& what = line.what;
    const auto same = std::ranges::find_if(
        shown_, [&](const OutOfUse& one) { return one.capability == what.capability && one.retired == what.retired; });
    if (same == shown_.end()) {
      if (shown_.size() < kMaxOutOfUse) shown_.push_back(what);
    } else {
      join(*same, what);
    }
  }
  std::ranges::sort(shown_, [](const OutOfUse& a, const OutOfUse& b) {
    return std::pair(a.retired, a.capability) < std::pair(b.retired, b.capability);
  });
}

}  // namespace trb::adapter
