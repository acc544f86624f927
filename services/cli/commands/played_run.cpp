#include "services/cli/commands/played_run.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "services/cli/commands/model_terms.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxNamed = 5;
constexpr std::size_t kMaxHappenings = 20;

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
  const bool is_finished = world.find("finished_at_cloud")->boolean();
  if (is_finished) print_line("The cloud has its end, it is FINISHED; nodes keep a run for a minute more");
  const bool goes_on = !is_finished && still_s == nullptr && alerts->list().empty();
  if (goes_on || world.find("at_work")->integer() > 0)
    print_line("It was cut off before its end: --seconds plays more of it");
}

void print_links(const Value& world) {
  if (world.find("all_linked")->boolean()) return;
  print_line("Not all links were up: after " + shown_number(world.find("linked_s")->number()) +
             " s they were waited for no longer, and the run was submitted without them");
}

std::string text_at(const Value& of, const char* key) {
  const Value* found = of.find(key);
  return found == nullptr ? "" : found->text();
}

/// "r1", "r1 - r2, what r1 sends", "r0, r1".
std::string place_text(const Value& happening) {
  const std::string node = text_at(happening, "node"), other = text_at(happening, "other"),
                    way = text_at(happening, "way");
  const Value* nodes = happening.find("nodes");
  std::string out = nodes == nullptr ? node : names_of(nodes->list());
  if (!other.empty()) out += " - " + other;
  if (way == "there") out += ", what " + node + " sends";
  if (way == "back") out += ", what " + node + " is sent";
  return out;
}

/// In the time that --faults has: since the submission. What is so from the world's start is before that.
std::string since_text(double at_s, double submitted_s) {
  if (at_s < submitted_s || submitted_s == 0) return "from the start";
  return shown_number(std::round((at_s - submitted_s) * 1e3) / 1e3) + " s";
}

void print_happenings(const Value& answer) {
  const Value::List& happenings = answer.find("happenings")->list();
  if (happenings.empty()) return;
  const double submitted_s = answer.find("world")->find("submitted_s")->number();
  std::vector<std::vector<std::string>> rows{{"AT", "HAPPENED", "WHERE"}};
  for (std::size_t i = 0; i < std::min(happenings.size(), kMaxHappenings); ++i) {
    const Value& one = happenings[i];
    rows.push_back({since_text(one.find("at_s")->number(), submitted_s), one.find("kind")->text(), place_text(one)});
  }
  print_line("\nWhat went wrong and was mended, in seconds since the run's submission:");
  print(format_table(rows));
  if (happenings.size() > kMaxHappenings)
    print_line("and " + std::to_string(happenings.size() - kMaxHappenings) + " more: --json lists them");
}

std::string late_text(const Value& sensor) {
  const std::int64_t more = sensor.find("steps")->integer() - 1;
  return "sensor_values[" + std::to_string(sensor.find("sensor")->integer()) + "], what it tells from " +
         shown_number(sensor.find("at")->number()) + " s on" +
         (more == 0 ? "" : ", and " + std::to_string(more) + " later");
}

/// Whether there was one.
bool print_steps_not_reached(const Value& world) {
  const Value* sensors = world.find("steps_not_reached");
  if (sensors == nullptr) return false;
  const Value::List& list = sensors->list();
  for (std::size_t i = 0; i < std::min(list.size(), kMaxNamed); ++i) print_line("Not reached: " + late_text(list[i]));
  if (list.size() > kMaxNamed)
    print_line("Not reached: steps of " + std::to_string(list.size() - kMaxNamed) + " more of the sensors");
  return true;
}

void print_not_reached(const Value& world, double end_s) {
  const Value::List& faults = world.find("not_reached")->list();
  for (std::size_t i = 0; i < std::min(faults.size(), kMaxNamed); ++i) {
    print_line("Not reached: faults[" + std::to_string(faults[i].find("fault")->integer()) + "] at " +
               shown_number(faults[i].find("at")->number()) + " s");
  }
  if (faults.size() > kMaxNamed)
    print_line("Not reached: " + std::to_string(faults.size() - kMaxNamed) + " more of the faults");
  const bool is_late = print_steps_not_reached(world) || !faults.empty();
  const double submitted_s = world.find("submitted_s")->number();
  if (is_late && submitted_s > 0)
    print_line("What was played ends " + shown_number(end_s - submitted_s) + " s after the run's submission");
}

void print_broken(const Value& run) {
  for (const Value& broken : run.find("broken")->list()) print_line("BROKEN: " + broken.text());
}

/// What there is to say of the runs beside the first one: by their number.
void print_beside(const Value& answer) {
  const Value* beside = answer.find("beside");
  for (std::size_t i = 0; beside != nullptr && i < beside->list().size(); ++i) {
    const Value& run = beside->list()[i];
    if (run.find("alerts") == nullptr && run.find("broken")->list().empty()) continue;
    print_line("Run " + std::to_string(i + 2) + ":");
    print_open(run);
    print_broken(run);
  }
}

bool is_good(const Value& run) {
  return run.find("state")->text() == "FINISHED" && run.find("broken")->list().empty();
}

}  // namespace

void print_run_end(const Value& answer) {
  const Value& world = *answer.find("world");
  print_links(world);
  print_open(world);
  print_not_reached(world, answer.find("seconds")->number());
  print_broken(world);
  print_beside(answer);
  print_happenings(answer);
}

int exit_code_of(const Value& answer) {
  const Value* beside = answer.find("beside");
  const bool all_good =
      is_good(*answer.find("world")) && (beside == nullptr || std::ranges::all_of(beside->list(), is_good));
  return all_good ? kGood : kFailed;
}

}  // namespace trb::cli
