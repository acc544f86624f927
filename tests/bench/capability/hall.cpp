#include "tests/bench/capability/hall.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace trb::bench {
namespace {

using resilience::HallPoint;
using resilience::Measures;
using resilience::RobotNumber;
using resilience::Scored;
using resilience::Weights;

/// xorshift64*: the same numbers everywhere.
class Dice {
 public:
  std::uint32_t below(std::uint32_t bound) {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    return static_cast<std::uint32_t>((state_ * 0x2545F4914F6CDD1DULL) >> 33U) % bound;
  }

 private:
  std::uint64_t state_ = 88172645463325252ULL;
};

Skills some_skills(Dice& dice) {
  std::vector<std::uint32_t> out;
  while (out.size() < kAsked) {
    const std::uint32_t skill = dice.below(kSkills);
    if (std::find(out.begin(), out.end(), skill) == out.end()) out.push_back(skill);
  }
  Skills skills{};
  std::copy(out.begin(), out.end(), skills.begin());
  return skills;
}

double way(const Measures& of, HallPoint place) {
  const double east = of.x - place.x;
  const double north = of.y - place.y;
  return resilience::kWayStart + std::sqrt(east * east + north * north);
}

}  // namespace

std::vector<std::string> words_of(const Skills& skills) {
  std::vector<std::string> out;
  for (const std::uint32_t skill : skills) out.push_back(resilience::skill_word("s" + std::to_string(skill)));
  out.emplace_back(resilience::kFitWord);
  return out;
}

Hall::Hall(std::size_t robots, std::size_t models) : robots_(robots) {
  Dice dice;
  for (std::size_t i = 0; i < models; ++i) models_.push_back(some_skills(dice));
  for (std::size_t i = 0; i < robots; ++i) {
    robots_[i].skills = mask_of(skills_of(i));
    robots_[i].measures = {dice.below(1001) / 10.0, dice.below(10'000) / 100.0, dice.below(10'000) / 100.0,
                           100.0 / (1 + dice.below(4))};
  }
}

Hall::Mask Hall::mask_of(const Skills& skills) {
  Mask mask{};
  for (const std::uint32_t skill : skills) mask[skill / 64] |= std::uint64_t{1} << (skill % 64);
  return mask;
}

bool Hall::has(const Robot& robot, const Mask& asked) {
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) missing |= asked[i] & ~robot.skills[i];
  return missing == 0 && robot.fit;
}

std::unique_ptr<resilience::FleetIndex> Hall::index() const {
  auto index = std::make_unique<resilience::FleetIndex>();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const RobotNumber number = *index->add("r" + std::to_string(i));
    index->set_words(number, words_of(skills_of(i)));
    index->set_measures(number, robots_[i].measures);
  }
  return index;
}

void Hall::loop(const Skills& asked, std::vector<RobotNumber>& out) const {
  out.clear();
  const Mask mask = mask_of(asked);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (has(robots_[i], mask)) out.push_back(static_cast<RobotNumber>(i));
  }
}

std::vector<Scored> Hall::ten_best(const Skills& asked, const Weights& weights, HallPoint place,
                                   std::size_t most) const {
  const Mask mask = mask_of(asked);
  double charges = 0, nearness = 0, availabilities = 0;
  for (const Robot& robot : robots_) {
    if (!has(robot, mask)) continue;
    charges += robot.measures.charge;
    nearness += 1 / way(robot.measures, place);
    availabilities += robot.measures.availability;
  }
  resilience::BestScored best(most);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (!has(robots_[i], mask)) continue;
    const Measures& of = robots_[i].measures;
    best.add({static_cast<RobotNumber>(i), weights.charge * of.charge / charges +
                                               weights.distance / way(of, place) / nearness +
                                               weights.availability * of.availability / availabilities});
  }
  return best.take();
}

}  // namespace trb::bench
