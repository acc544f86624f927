#include "common/log/log.hpp"

#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <vector>

#include "common/base/printable.hpp"

namespace trb {
namespace {

constexpr std::size_t kFileSize = 10U * 1024U * 1024U;
constexpr std::size_t kFiles = 3;
constexpr std::size_t kMaxEvents = 256;

spdlog::level::level_enum to_spdlog(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

std::string one_line(std::string_view text) {
  std::string out(text.substr(0, 4096));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return printable(out);  // C1 is left
}

}  // namespace

void open_log(const std::string& service, const std::string& path) {
  std::vector<spdlog::sink_ptr> sinks;
  auto console = std::make_shared<spdlog::sinks::stderr_sink_st>();
  std::string problem;
  if (!path.empty()) {
    // A service whose log cannot be written works nevertheless.
    try {
      sinks.push_back(std::make_shared<spdlog::sinks::rotating_file_sink_st>(path, kFileSize, kFiles - 1));
      console->set_level(spdlog::level::warn);
    } catch (const spdlog::spdlog_ex& fault) {
      problem = fault.what();
    }
  }
  sinks.push_back(console);
  auto logger = std::make_shared<spdlog::logger>(service, sinks.begin(), sinks.end());
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %n %v", spdlog::pattern_time_type::utc);
  logger->set_level(spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  if (!problem.empty()) log_event(Level::warning, "no_log_file", problem);
}

void log_event(Level level, std::string_view event, std::string_view text) {
  spdlog::default_logger_raw()->log(to_spdlog(level), "{} {}", event, one_line(text));
}

bool RateLimit::allow(std::string_view event, MonotonicTime now, std::uint64_t& held_back) {
  held_back = 0;
  auto at = events_.find(event);
  if (at == events_.end()) {
    if (events_.size() >= kMaxEvents) return false;
    at = events_.emplace(std::string(event), State{now, 0}).first;
  }
  State& state = at->second;
  if (now - state.start >= window_) {
    held_back = state.count > burst_ ? state.count - burst_ : 0;
    state = {now, 0};
  }
  return ++state.count <= burst_;
}

void log_limited(RateLimit& limit, MonotonicTime now, Level level, std::string_view event, std::string_view text) {
  std::uint64_t held_back = 0;
  if (!limit.allow(event, now, held_back)) return;
  if (held_back > 0) log_event(level, event, "(" + std::to_string(held_back) + " more such events were not logged)");
  log_event(level, event, text);
}

}  // namespace trb
