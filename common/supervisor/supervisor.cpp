#include "common/supervisor/supervisor.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "common/supervisor/process.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/signals.hpp"

namespace trb::supervisor {
namespace {

constexpr Duration kForkAgain = std::chrono::seconds(2);  ///< when a process could not be created
constexpr Duration kReadyCheck = std::chrono::milliseconds(100);
constexpr Duration kLongestWait = std::chrono::seconds(10);
constexpr int kAgain = 75;  ///< EX_TEMPFAIL: the service asks to be started again

/// Waits for one of the blocked signals; 0 if none came in time.
int wait_signal(Duration wait) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGCHLD}) sigaddset(&set, signal);
  const auto ns = std::max<Duration>(wait, Duration::zero()).count();
  const timespec time{ns / 1'000'000'000, ns % 1'000'000'000};
  const int signal = ::sigtimedwait(&set, nullptr, &time);
  return signal > 0 ? signal : 0;
}

[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments, pid_t parent) {
  die_with_parent(parent);
  ServiceManager::forget();
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  ::perror(program.c_str());
  ::_exit(127);
}

}  // namespace

void block_signals() {
  trb::block_signals();
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &set, nullptr);
}

Supervisor::Supervisor(std::string node_dir, std::vector<ServiceProgram> services,
                       std::function<void(const std::string&)> notify, Duration grace)
    : node_dir_(std::move(node_dir)), notify_(std::move(notify)), grace_(grace) {
  for (ServiceProgram& one : services) add(std::move(one));
}

void Supervisor::add(ServiceProgram service) {
  Child child;
  child.service = std::move(service.service);
  child.program = std::move(service.program);
  child.arguments = service.arguments.empty() ? std::vector{node_dir_} : std::move(service.arguments);
  children_.push_back(std::move(child));
}

bool Supervisor::change(std::vector<ServiceProgram> services) {
  const auto find = [&](const std::string& name) {
    return std::ranges::find(services, name, &ServiceProgram::service);
  };
  for (Child& child : children_) {
    const auto at = find(child.service);
    child.wanted = at != services.end();
    if (child.wanted) child.program = at->program;
    if (child.wanted) services.erase(at);
    if (child.wanted || child.kill_at) continue;
    if (child.pid > 0) ::kill(child.pid, SIGTERM);
    child.kill_at = read_clocks().mono + grace_;
    notify_(child.service + " was taken out, and ends");
  }
  std::erase_if(children_, [](const Child& child) { return !child.wanted && child.pid == 0; });
  signal_all(SIGHUP);
  for (ServiceProgram& one : services) {
    notify_(one.service + " is new, and starts");
    add(std::move(one));
  }
  return !services.empty();
}

int Supervisor::run(const Reload& reload, const WaitsFor& waits_for, Duration patience) {
  Progress progress{read_clocks().mono};
  start_due(read_clocks());
  for (;;) {
    const Now now = read_clocks();
    manager_.keep_alive(now.mono);
    const int signal = wait_signal(until_next(now, progress.ready));
    if (signal == SIGTERM || signal == SIGINT) break;
    auto services = signal == SIGHUP ? reload() : std::nullopt;
    if (services && change(std::move(*services))) progress = {read_clocks().mono};
    const Now after = read_clocks();
    reap(after);
    kill_overdue(after.mono);
    start_due(after);
    if (each_round_) each_round_();
    // It may wait for a router that has to be started again first. Somebody ends or starts: the next round is soon.
    if (signal == 0 && !progress.ready) look(progress, waits_for, patience);
  }
  manager_.stopping();
  end_all();
  return 0;
}

void Supervisor::look(Progress& progress, const WaitsFor& waits_for, Duration patience) {
  const std::string waits = waits_for();
  progress.ready = waits.empty();
  manager_.waits(waits);
  if (progress.ready) {
    manager_.ready();
    return notify_("ready");
  }
  if (progress.late || read_clocks().mono - progress.since < patience) return;
  progress.late = true;
  manager_.ready();
  notify_("still waits: " + waits);
}

Duration Supervisor::until_next(Now now, bool ready) const {
  Duration wait = ready ? kLongestWait : kReadyCheck;
  if (const auto alive = manager_.next()) wait = std::min(wait, *alive - now.mono);
  for (const Child& child : children_) {
    if (child.pid == 0) wait = std::min(wait, child.start_at - now.mono);
    if (child.kill_at) wait = std::min(wait, *child.kill_at - now.mono);
  }
  return wait;
}

void Supervisor::start_due(Now now) {
  const pid_t self = ::getpid();
  for (Child& child : children_) {
    if (child.pid != 0 || now.mono < child.start_at) continue;
    const pid_t pid = ::fork();
    if (pid == 0) become(child.program, child.arguments, self);
    child.pid = pid > 0 ? pid : 0;
    child.started = now.mono;
    if (pid < 0) child.start_at = now.mono + kForkAgain;
  }
}

void Supervisor::reap(Now now) {
  int status = 0;
  for (pid_t pid = ::waitpid(-1, &status, WNOHANG); pid > 0; pid = ::waitpid(-1, &status, WNOHANG)) {
    for (Child& child : children_) {
      if (child.pid == pid) ended(child, status, now);
    }
  }
  std::erase_if(children_, [](const Child& child) { return !child.wanted && child.pid == 0; });
}

void Supervisor::kill_overdue(MonotonicTime now) {
  for (Child& child : children_) {
    if (!child.kill_at || now < *child.kill_at || child.pid == 0) continue;
    ::kill(child.pid, SIGKILL);
    child.kill_at = now + grace_;
    notify_(child.service + " does not end, and is killed");
  }
}

void Supervisor::ended(Child& child, int status, Now now) {
  child.pid = 0;
  child.kill_at.reset();
  if (!child.wanted) return;
  const bool asked = WIFEXITED(status) && WEXITSTATUS(status) == kAgain;
  child.start_at = now.mono + child.delay.after_end(asked, now.mono - child.started);
  const std::string how = WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                              : "status " + std::to_string(WEXITSTATUS(status));
  notify_(child.service + (asked ? " starts again with the new files" : " ended (" + how + "), starting it again"));
}

void Supervisor::signal_all(int signal) const {
  for (const Child& child : children_) {
    if (child.pid > 0) ::kill(child.pid, signal);
  }
}

void Supervisor::end_all() {
  signal_all(SIGTERM);
  const auto any_left = [this] {
    int status = 0;
    for (Child& child : children_) {
      if (child.pid > 0 && ::waitpid(child.pid, &status, WNOHANG) == child.pid) child.pid = 0;
    }
    return std::any_of(children_.begin(), children_.end(), [](const Child& child) { return child.pid > 0; });
  };
  const auto wait_for_ends = [&] {
    const MonotonicTime end = read_clocks().mono + grace_;
    while (any_left() && read_clocks().mono < end) wait_signal(std::chrono::milliseconds(20));
  };
  wait_for_ends();
  signal_all(SIGKILL);
  // Whoever has waited for this process takes the services for gone, too: their ports, their files.
  wait_for_ends();
}

}  // namespace trb::supervisor
