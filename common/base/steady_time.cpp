#include "common/base/steady_time.hpp"

#include <cstdlib>

namespace trb {
namespace {

bool is_near(std::int64_t a, std::int64_t b) {
  return a > b ? a - b <= SteadyTime::kSlack.count() : b - a <= SteadyTime::kSlack.count();
}

}  // namespace

UtcTime SteadyTime::at(Now now) {
  const std::int64_t offset = now.utc.ns - now.mono.ns;
  if (!offset_) {
    const bool was_short = restored_ && now.utc >= *restored_ - kSlack && now.utc <= *restored_ + kShortStop;
    offset_ = restored_ && !was_short ? restored_->ns - now.mono.ns : offset;
    if (!was_short) first_ = UtcTime{now.mono.ns + *offset_};
  }
  const bool steps = !is_near(offset, *offset_);
  if (steps && (!step_ || !is_near(offset, step_->offset))) {
    step_ = Step{offset, now.mono};
  } else if (!steps || now.mono - step_->since >= kSteady) {
    if (steps) take_over(Duration{offset - *offset_});
    offset_ = offset;
    step_.reset();
  }
  last_ = {now.mono.ns + *offset_};
  return last_;
}

void SteadyTime::take_over(Duration by) {
  taken_ = SteadyStep{first_, last_, by};
  if (first_) first_ = *first_ + by;
}

std::optional<MonotonicTime> SteadyTime::next() const {
  return step_ ? std::optional(step_->since + kSteady) : std::nullopt;
}

}  // namespace trb
