#include "services/simulator/job/trace.hpp"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "common/base/files.hpp"
#include "services/simulator/job/answer.hpp"

namespace trb::simulator {
namespace {

/// What plays it again; that it writes a trace, or plays its runs alone, too, is no part of it.
Value played_job(const std::string& text) {
  const auto json = parse_json(text, kJobLimits);
  Value::Object out;
  if (!json || !json->is_object()) return Value{out};
  for (const auto& [key, value] : json->object()) {
    if (key != "trace" && key != "until_event" && key != "alone") out.emplace_back(key, value);
  }
  return Value{std::move(out)};
}

Error too_long() {
  return fail(Errc::too_large, "trace: over " + std::to_string(kMaxTraced) + " messages",
              "trace a fleet with at most " + std::to_string(kMaxTraced));
}

/// "t3", with several runs "t3 of run 1".
std::string work_text(const world::World& world, const AttemptKey& key) {
  const world::WorldRun* run = world.runs().size() > 1 ? world.find_run(key.run) : nullptr;
  return key.task + (run == nullptr ? "" : " of run " + std::to_string(run->index));
}

std::string robot_text(const world::World& world, const world::Node& node, const world::Robot& robot) {
  std::string out = robot.is_broken() ? "broken"
                    : robot.works()   ? "works on " + work_text(world, node.order().key)
                                      : "idle";
  if (robot.battery()) out += ", " + std::to_string(static_cast<int>(robot.battery()->percent)) + " %";
  return out;
}

std::string run_text(const world::World& world, const world::Node& node, const world::WorldRun& run) {
  if (world.is_open_at(node, run.id)) return "OPEN";
  const auto record = node.disk().archive.record(run.id);
  return record ? std::string(name_of(record->view.state)) : "";
}

/// The other runs, in their order.
Value beside_value(const world::World& world, const world::Node& node) {
  Value::List out;
  for (const world::WorldRun& run : world.runs()) {
    if (run.index > 0) out.push_back(Value{run_text(world, node, run)});
  }
  return Value{std::move(out)};
}

Value node_value(const world::World& world, const std::string& id, world::Node& node) {
  Value::Object out{{"id", Value{id}},
                    {"up", Value{node.is_up()}},
                    {"links", Value{static_cast<std::int64_t>(node.linked())}},
                    {"records", Value{static_cast<std::int64_t>(node.disk().journal.records().size())}},
                    {"run", Value{run_text(world, node, world.runs().front())}}};
  if (world.runs().size() > 1) out.emplace_back("beside", beside_value(world, node));
  if (const world::Robot* robot = node.robot()) out.emplace_back("robot", Value{robot_text(world, node, *robot)});
  return Value{std::move(out)};
}

}  // namespace

Trace::Trace(const std::string& job_text, std::uint64_t most)
    : most_(most), text_(dump_json(Value{Value::Object{{"job", played_job(job_text)}}}) + "\n") {}

void Trace::on(const world::World& world, const world::Sending& sending, CostPhase phase) {
  if (++count_ > most_) return;
  Value line = trace_value(sending, phase);
  auto& members = std::get<Value::Object>(line.is);
  if (const auto run = world.message_run()) members.emplace_back("run", Value{static_cast<std::int64_t>(*run)});
  members.emplace_back("event", Value{static_cast<std::int64_t>(world.event())});
  members.emplace_back("digest", Value{digest_text(world.meter().digest())});
  text_ += dump_json(line) + "\n";
}

Status Trace::write(const std::string& path) {
  if (is_too_long()) return too_long();
  text_ += dump_json(Value{
               Value::Object{{"complete", Value{true}}, {"messages", Value{static_cast<std::int64_t>(count_)}}}}) +
           "\n";
  return write_whole(path, text_);
}

Status check_traced(std::uint64_t messages) {
  return messages <= kMaxTraced ? Status(Done{}) : too_long();
}

Status check_place(const std::string& path) {
  std::error_code problem;
  const std::filesystem::file_type type = std::filesystem::symlink_status(path, problem).type();
  if (type == std::filesystem::file_type::directory) return fail(Errc::io_error, path + ": is a folder", "name a file");
  // The whole file takes the place of what has its name.
  if (type == std::filesystem::file_type::symlink)
    return fail(Errc::io_error, path + ": is a link", "name the file that it leads to");
  const bool is_other = type != std::filesystem::file_type::regular && type != std::filesystem::file_type::not_found &&
                        type != std::filesystem::file_type::none;  // none: it may not be looked at
  if (is_other) return fail(Errc::io_error, path + ": is no file, but a device, pipe or socket", "name a file");
  const std::string folder = std::filesystem::path(path).parent_path().string();
  if (::access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) == 0) return Done{};
  return fail(Errc::io_error, path + ": cannot be written: " + std::generic_category().message(errno),
              "name a file in a folder that you may write to");
}

Status write_whole(const std::string& path, BytesView text) {
  sigset_t held, before;
  sigemptyset(&held);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, signal);
  sigprocmask(SIG_BLOCK, &held, &before);
  Status written = write_file(path, text, 0644);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  return written;
}

std::string digest_text(std::uint64_t digest) {
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(digest));
  return out;
}

Value state_value(const world::World& world) {
  Value::List nodes;
  for (const auto& [id, node] : world.nodes()) nodes.push_back(node_value(world, id, *node));
  return Value{Value::Object{{"event", Value{static_cast<std::int64_t>(world.event())}},
                             {"at_s", Value{world.seconds_passed()}},
                             {"messages", Value{static_cast<std::int64_t>(world.meter().tally().all().messages)}},
                             {"digest", Value{digest_text(world.meter().digest())}},
                             {"nodes", Value{std::move(nodes)}}}};
}

}  // namespace trb::simulator
