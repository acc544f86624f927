#include "services/simulator/counting/task_text.hpp"

namespace trb::counting {

std::string task_json(const Plan& plan, std::size_t task) {
  return "{\"id\":\"t" + std::to_string(task) + "\",\"robot\":\"r" + std::to_string(plan.tasks[task].robot) +
         "\",\"skill\":\"work\"}";
}

TaskText::TaskText(const Plan& plan) : tails_(plan.tasks.size()) {
  std::uint64_t size = 1;  // "[", and of each task its text with a comma or "]"
  for (std::size_t i = plan.tasks.size(); i-- > 0;) {
    size += task_json(plan, i).size() + 1;
    tails_[i] = size;
  }
}

}  // namespace trb::counting
