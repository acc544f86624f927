#include "services/cli/commands/played_run.hpp"

#include "services/cli/commands/model_terms.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxNamed = 5;

std::string names_of(const Value::List& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < kMaxNamed; ++i) out += (i == 0 ? "" : ", ") + names[i].text();
  return names.size() > kMaxNamed ? out + " and " + std::to_string(names.size() - kMaxNamed) + " more" : out;
}

void print_alert(const Value& alert) {
  const Value::List& tasks = alert.find("tasks")->list();
  std::string text = "An alert waits for a person, and in a simulation nobody decides: " + alert.find("robot")->text() +
                     " (" + alert.find("cause")->text();
  if (!alert.find("text")->text().empty()) text += ": " + alert.find("text")->text();
  print_line(text + ")" + (tasks.empty() ? "" : ", task " + names_of(tasks)));
}

void print_open(const Value& world) {
  const Value* alerts = world.find("alerts");
  if (alerts == nullptr) return;  // it was not cut off
  for (const Value& alert : alerts->list()) print_alert(alert);
  const Value* still_s = world.find("stands_still_s");
  if (still_s != nullptr) {
    const Value::List& off = world.find("off")->list();
    print_line("It stands still: nothing has moved for " + shown_number(still_s->number()) +
               " s, and nothing planned is to come; it is not over at " + names_of(world.find("open_at")->list()) +
               (off.empty() ? "" : "; off: " + names_of(off)));
  }
  const bool goes_on = still_s == nullptr && alerts->list().empty();
  if (goes_on || world.find("at_work")->integer() > 0)
    print_line("It was cut off before its end: --seconds plays more of it");
}

}  // namespace

void print_run_end(const Value& answer) {
  const Value& world = *answer.find("world");
  print_open(world);
  for (const Value& broken : world.find("broken")->list()) print_line("BROKEN: " + broken.text());
}

int exit_code_of(const Value& answer) {
  const Value& world = *answer.find("world");
  return world.find("state")->text() == "FINISHED" && world.find("broken")->list().empty() ? kGood : kFailed;
}

}  // namespace trb::cli
