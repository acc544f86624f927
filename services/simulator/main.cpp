// trb-simulator: one simulation, for `trb simulate` and whoever else runs jobs. See README.md.
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <new>
#include <string>
#include <string_view>

#include "services/simulator/counting/play.hpp"
#include "services/simulator/job/alone.hpp"
#include "services/simulator/job/answer.hpp"
#include "services/simulator/job/job.hpp"
#include "services/simulator/job/model_answer.hpp"
#include "services/simulator/job/seen.hpp"
#include "services/simulator/job/task_times.hpp"
#include "services/simulator/job/trace.hpp"
#include "services/simulator/job/world_job.hpp"

namespace trb::simulator {
namespace {

constexpr int kFailed = 1, kWrongUse = 2, kUntold = 3;
constexpr const char* kLineAway = "\r\x1b[K";

/// As `trb --json` prints an error.
int refuse(const Error& error) {
  const Value::Object out{
      {"code", Value{std::string(errc_name(error.code))}}, {"what", Value{error.what}}, {"cure", Value{error.hint}}};
  std::printf("%s\n", dump_json(Value{Value::Object{{"error", Value{out}}}}).c_str());
  return kFailed;
}

/// There is no memory left, and so none for an answer that is put together.
[[noreturn]] void refuse_for_memory() {
  constexpr std::string_view kText =
      R"({"error":{"code":"too_large","what":"the simulation needs more memory than it may have",)"
      R"("cure":"use fewer robots, tasks or faults, sensors that are read less often, or play fewer seconds"}})"
      "\n";
  const bool is_told = ::write(STDOUT_FILENO, kText.data(), kText.size()) > 0;
  ::_exit(is_told ? kFailed : kUntold);
}

Status write_trace(const Job& job, std::uint64_t messages) {
  if (Status few = check_traced(messages); !few) return few;
  Bytes text;
  counting::play(job.plan,
                 [&](const counting::CountedMessage& message) { text += dump_json(trace_value(message)) + "\n"; });
  return write_whole(job.trace, text);
}

int answer(const Value& value) {
  std::printf("%s\n", dump_json(value).c_str());
  const bool is_whole = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return is_whole ? 0 : refuse(fail(Errc::io_error, "standard output", "it was closed, or its disk is full"));
}

/// How far it is, on a terminal: a large fleet takes a minute.
void show_progress(const world::World& world) {
  std::fprintf(stderr, "\r%.0f s of the fleet's time, %zu of %zu tasks done ", world.seconds_passed(),
               world.tasks_done(), world.plan().tasks_in_all());
}

/// The same for a program: a line of JSON on standard error, ten a second at most.
class ProgressLines {
 public:
  void print(double seconds, std::size_t done, std::size_t tasks) {
    const auto now = std::chrono::steady_clock::now();
    if (now - printed_ < kBetween) return;
    printed_ = now;
    std::fprintf(stderr, "{\"seconds\":%.1f,\"tasks_done\":%zu,\"tasks\":%zu}\n", seconds, done, tasks);
  }

 private:
  static constexpr auto kBetween = std::chrono::milliseconds(100);
  std::chrono::steady_clock::time_point printed_;
};

/// The equations say nothing of several runs at once.
void add_to(Value& answer, const Job& job, const TaskTimes& times, const Seen& seen, bool is_of_one_run = true) {
  auto& members = std::get<Value::Object>(answer.is);
  if (is_of_one_run) members.emplace_back("model", model_value(parameters_of(job)));
  members.emplace_back("tasks", times.listed());
  members.emplace_back("tasks_not_listed", Value{static_cast<std::int64_t>(times.not_listed())});
  seen.add_to(members);
}

Value beside_of(const world::World& world, const TaskTimes& times) {
  Value::List out;
  for (const world::WorldRun& run : world.runs()) {
    if (run.index == 0) continue;
    Value::Object one = beside_value(run);
    one.emplace_back("tasks", times.listed(run.index));
    one.emplace_back("tasks_not_listed", Value{static_cast<std::int64_t>(times.not_listed(run.index))});
    out.push_back(Value{std::move(one)});
  }
  return Value{std::move(out)};
}

bool is_watched(bool for_program) {
  return !for_program && ::isatty(STDERR_FILENO) == 1;
}

/// All its runs at once.
Result<Value> play_world(const Job& job, const std::string& text, bool for_program) {
  world::World world(*job.world);
  TaskTimes times;
  times.watch(world);
  ProgressLines lines;
  if (is_watched(for_program)) world.on_second = show_progress;
  if (for_program) {
    world.on_second = [&lines](const world::World& of) {
      lines.print(of.seconds_passed(), of.tasks_done(), of.plan().tasks_in_all());
    };
  }
  Trace trace(text);
  if (!job.trace.empty()) {
    world.meter().trace = [&](const world::Sending& sending, CostPhase phase) {
      trace.on(world, sending, phase);
      if (trace.is_too_long()) world.stop();
    };
  }
  Seen seen;
  seen.watch(world);
  const world::Played played = world.play();
  if (is_watched(for_program)) std::fputs(kLineAway, stderr);
  if (!job.trace.empty()) {
    if (const Status written = trace.write(job.trace); !written) return written.error();
  }
  Value out = answer_value(world.meter().tally(), played.seconds);
  const bool is_of_one_run = world.runs().size() == 1;
  Value of_world = world_value(played);
  if (!is_of_one_run) {
    const std::string& name = world.runs().front().plan.scenario.name;
    std::get<Value::Object>(of_world.is).emplace_back("scenario", Value{name});
  }
  std::get<Value::Object>(out.is).emplace_back("world", std::move(of_world));
  if (played.cut_short) std::get<Value::Object>(out.is).emplace_back("state", state_value(world));
  add_to(out, job, times, seen, is_of_one_run);
  if (!is_of_one_run) std::get<Value::Object>(out.is).emplace_back("beside", beside_of(world, times));
  return out;
}

/// A program is told how far it is of the runs at once alone.
int simulate_world(const Job& job, const std::string& text, bool for_program) {
  auto out = play_world(job, text, for_program);
  if (!out) return refuse(out.error());
  if (job.alone) {
    add_alone(*out, *job.world, is_watched(for_program) ? show_progress : nullptr);
    if (is_watched(for_program)) std::fputs(kLineAway, stderr);
  }
  return answer(*out);
}

int simulate_counting(const Job& job, bool for_program) {
  constexpr std::uint64_t kPrintAt = 1U << 18U;  // messages: some milliseconds
  const double most_s = std::max(job.plan.seconds, job.plan.task_s * static_cast<double>(job.plan.tasks.size()));
  counting::Tally tally(most_s);
  TaskTimes times;
  Seen seen;
  ProgressLines lines;
  std::uint64_t count = 0;
  const double seconds = counting::play(job.plan, [&](const counting::CountedMessage& message) {
    tally(message);
    times.on_message(message);
    seen.on_message(message);
    if (for_program && ++count % kPrintAt == 0) lines.print(message.at_s, times.done(), job.plan.tasks.size());
  });
  if (!job.trace.empty()) {
    const Status written = write_trace(job, tally.all().messages);
    if (!written) return refuse(written.error());
  }
  Value out = answer_value(tally, seconds);
  add_to(out, job, times, seen);
  return answer(out);
}

/// The job, or all of standard input: an argument has at most 128 KiB.
std::string job_text(const std::string& word) {
  if (word != "-") return word;
  std::string out;
  std::array<char, 65536> buffer{};
  for (std::size_t count = 1; count > 0 && out.size() <= kMaxJob;) {  // read_job refuses more
    count = std::fread(buffer.data(), 1, buffer.size(), stdin);
    out.append(buffer.data(), count);
  }
  return out;
}

int simulate(const std::string& text, bool for_program) {
  ConfigFaults faults;
  const Job job = read_job(text, faults);
  if (!faults.empty()) {
    const ConfigFault& first = faults.front();
    return refuse(fail(Errc::bad_value, (first.key.empty() ? "job" : first.key) + ": " + first.what, first.hint));
  }
  if (!job.trace.empty()) {
    if (const Status place = check_place(job.trace); !place) return refuse(place.error());
  }
  return job.world ? simulate_world(job, text, for_program) : simulate_counting(job, for_program);
}

}  // namespace
}  // namespace trb::simulator

int main(int count, char** words) {
  const bool for_program = count == 3 && std::string_view(words[1]) == "--progress";
  if (!for_program && (count != 2 || std::string_view(words[1]) == "--help")) {
    std::fputs(
        "usage: trb-simulator [--progress] JOB\n"
        "Plays one simulation and prints what it has found as JSON; `trb simulate` is for people.\n"
        "JOB: its JSON; - reads it from standard input.\n"
        "--progress: says on standard error how far it is, a line of JSON each.\n"
        "  trb-simulator '{\"robots\": 50, \"tasks\": 100}'\n"
        "  trb-simulator '{\"protocol\": \"talkrobots\", \"robots\": 5, \"tasks\": 9, \"link\": \"wifi\"}'\n",
        count == 2 ? stdout : stderr);
    return count == 2 ? 0 : trb::simulator::kWrongUse;
  }
  std::set_new_handler(trb::simulator::refuse_for_memory);
  return trb::simulator::simulate(trb::simulator::job_text(words[count - 1]), for_program);
}
