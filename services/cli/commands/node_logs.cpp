#include "services/cli/commands/node_logs.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "common/base/descriptor.hpp"
#include "common/base/files.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;

/// True for the file that a service writes to now, not one that it has left: "router.log", not "router.1.log".
bool is_current_log(const std::string& name) {
  return name.ends_with(".log") && name.find('.') == name.size() - 4;
}

/// True if it is asked for. What trb up --detach has said is not asked for by itself: its lines have no time, and the
/// services' warnings are in both.
bool is_asked(const std::string& name, const std::string& service) {
  return is_current_log(name) && (service.empty() ? name != "up.log" : name == service + ".log");
}

/// By name; each is read to where it was shown.
using Logs = std::map<std::string, std::ifstream>;

Logs open_logs(const std::string& folder, const std::string& service) {
  Logs out;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (is_asked(name, service)) out[name].open(entry.path());
  }
  return out;
}

/// The last lines of all files; of several, in the order of their times, which every line begins with.
std::vector<std::string> last_lines(Logs& logs, std::size_t most) {
  constexpr std::size_t kTime = sizeof "2026-03-01T12:00:00.250Z" - 1;
  std::vector<std::string> lines;
  for (auto& [name, file] : logs) {
    std::deque<std::string> own;
    for (std::string line; std::getline(file, line);) {
      own.push_back(std::move(line));
      if (own.size() > most) own.pop_front();
    }
    lines.insert(lines.end(), own.begin(), own.end());
  }
  if (logs.size() > 1) {
    std::stable_sort(lines.begin(), lines.end(), [](const std::string& a, const std::string& b) {
      return std::string_view(a).substr(0, kTime) < std::string_view(b).substr(0, kTime);
    });
  }
  if (lines.size() > most) lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(most));
  return lines;
}

/// What the terminal or the program gets of a line.
void print_log_line(const Arguments& arguments, const std::string& line) {
  arguments.has("--json") ? print_json(Value{Value::Object{{"line", Value{line}}}}) : print_line(line);
}

void print_new_lines(const Arguments& arguments, std::ifstream& file) {
  file.clear();
  // log/up.log is emptied when it has grown too large.
  const auto before = file.tellg();
  if (file.seekg(0, std::ios::end).tellg() >= before)
    file.seekg(before);
  else
    file.seekg(0);
  for (std::string line; std::getline(file, line);) print_log_line(arguments, line);
}

/// Until output or watch ends. A log that grew too large goes on as a new file of the same name.
int follow(const Arguments& arguments, const std::string& folder, const std::string& service, const Descriptor& watch,
           Logs& logs) {
  alignas(inotify_event) char events[4096];
  while (lost_output().empty()) {
    const ssize_t size = ::read(watch.get(), events, sizeof events);
    if (size <= 0) break;
    for (ssize_t at = 0; at < size;) {
      const auto* event = reinterpret_cast<const inotify_event*>(events + at);
      at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
      const std::string name = event->len == 0 ? "" : event->name;
      if (!is_asked(name, service)) continue;
      std::ifstream& file = logs[name];
      if (file.is_open()) print_new_lines(arguments, file);
      if ((event->mask & (IN_CREATE | IN_MOVED_TO)) == 0) continue;
      file = std::ifstream(folder + "/" + name);
      print_new_lines(arguments, file);
    }
  }
  return kFailed;
}

}  // namespace

int run_logs(const Arguments& arguments) {
  const std::string service = arguments.words.size() > 1 ? arguments.words[1] : "";
  const std::string folder = arguments.words[0] + "/log";
  // Before the files are read: nothing comes between.
  const Descriptor watch(::inotify_init1(IN_CLOEXEC));
  ::inotify_add_watch(watch.get(), folder.c_str(), IN_MODIFY | IN_CREATE | IN_MOVED_TO);
  Logs logs = open_logs(folder, service);
  if (logs.empty() && !service.empty() && file_exists(folder + "/" + service + ".log.1")) {
    return print_error(arguments,
                       fail(Errc::missing,
                            folder + ": no " + service + ".log, but a " + service +
                                ".log.1: something has moved it away, and the service goes on writing there",
                            "keep logrotate away: the services rotate their logs themselves (three files of 10 MB "
                            "each); trb reload " +
                                arguments.words[0] + " begins a new file"));
  }
  if (logs.empty()) {
    return print_error(arguments, fail(Errc::missing, folder + ": no log" + (service.empty() ? "" : " of " + service),
                                       "name a node's folder that was up, and one of its services; trb logs " +
                                           arguments.words[0] + " up shows what trb up --detach has said"));
  }
  const auto most = arguments.number("--lines", 50);
  if (!most) return print_error(arguments, most.error());
  for (const std::string& line : last_lines(logs, static_cast<std::size_t>(*most))) print_log_line(arguments, line);
  return arguments.has("--follow") ? follow(arguments, folder, service, watch, logs) : kGood;
}

}  // namespace trb::cli
