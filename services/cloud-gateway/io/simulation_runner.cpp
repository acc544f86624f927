#include "services/cloud-gateway/io/simulation_runner.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <csignal>
#include <utility>

#include "common/log/log.hpp"
#include "common/security/keys.hpp"
#include "common/service/service.hpp"
#include "proto/value.hpp"
#include "services/cloud-gateway/io/simulator_program.hpp"

namespace trb::gateway {
namespace {

using boost::system::error_code;
using Descriptor = boost::asio::posix::stream_descriptor;

constexpr std::size_t kMaxLine = 256;

std::optional<SimulationProgress> progress_in(const std::string& line) {
  const auto json = parse_json(line);
  if (!json || !json->is_object()) return std::nullopt;
  const Value* seconds = json->find("seconds");
  const Value* done = json->find("tasks_done");
  if (seconds == nullptr || !seconds->is_number() || done == nullptr || !done->is_integer()) return std::nullopt;
  return SimulationProgress{seconds->number(), static_cast<std::uint64_t>(std::max<std::int64_t>(done->integer(), 0))};
}

}  // namespace

/// Outlives its runner in the handlers that wait for it.
struct SimulationRunner::Program {
  Program(SimulationRunner& of, const SimulatorProgram& started)
      : runner(&of),
        pid(started.pid),
        exit(of.loop_, started.exit),
        answer(of.loop_, started.answer),
        progress(of.loop_, started.progress) {}

  SimulationRunner* runner;  ///< nullptr: the gateway ends
  pid_t pid;
  Descriptor exit, answer, progress;
  std::array<char, 65536> read{};
  std::array<char, 1024> told{};
  std::string text, line;
  bool is_read = false;   ///< its answer, to the end
  bool is_ended = false;  ///< the process: it still has to be waited for
};

SimulationRunner::SimulationRunner(boost::asio::io_context& loop) : loop_(loop), desk_(random_bytes) {}

void SimulationRunner::stop() {
  is_stopped_ = true;
  if (program_ == nullptr) return;
  program_->runner = nullptr;
  kill(program_->pid, SIGKILL);
  waitpid(program_->pid, nullptr, 0);
  for (Descriptor* one : {&program_->exit, &program_->answer, &program_->progress}) one->close();
  program_.reset();
}

Result<const Simulation*> SimulationRunner::add(SimulationJob job, std::string by, Now now) {
  auto added = desk_.add(std::move(job), std::move(by), now);
  if (!added) return added;
  const std::string id = (*added)->id;
  obey(now);
  return desk_.find(id);
}

Result<const Simulation*> SimulationRunner::remove(const std::string& id, Now now) {
  auto removed = desk_.remove(id, now);
  obey(now);
  if (!removed || *removed == nullptr) return removed;
  return desk_.find(id);
}

void SimulationRunner::tick(Now now) {
  desk_.tick(now);
  obey(now);
}

void SimulationRunner::obey(Now now) {
  if (is_stopped_) return;
  while (const auto order = desk_.take_order(now)) {
    if (order->kind == SimulationOrder::Kind::start) start(order->job);
    // It is this process's child, and not waited for yet: the number is nobody else's.
    if (order->kind == SimulationOrder::Kind::end && program_ != nullptr) kill(program_->pid, SIGKILL);
  }
}

void SimulationRunner::start(const std::string& job) {
  const auto started = start_simulator(job);
  if (!started) {
    log_event(Level::error, "simulation_not_started", started.error().text());
    return desk_.on_gone(started.error(), trb::now());
  }
  program_ = std::make_shared<Program>(*this, *started);
  read_answer(program_);
  read_progress(program_);
  wait(program_);
}

void SimulationRunner::read_answer(const std::shared_ptr<Program>& program) {
  program->answer.async_read_some(boost::asio::buffer(program->read), [program](error_code error, std::size_t size) {
    SimulationRunner* runner = program->runner;
    if (runner == nullptr) return;
    if (error) {
      program->is_read = true;
      return runner->end_if_over(*program);
    }
    if (program->text.size() + size <= kMaxSimulationAnswer) {
      program->text.append(program->read.data(), size);
    } else {
      runner->desk_.on_too_large(trb::now());
      runner->obey(trb::now());
    }
    read_answer(program);
  });
}

/// A line that is none of progress is dropped, and so is what is too long for one.
void SimulationRunner::read_progress(const std::shared_ptr<Program>& program) {
  program->progress.async_read_some(boost::asio::buffer(program->told), [program](error_code error, std::size_t size) {
    if (program->runner == nullptr || error) return;
    for (const char byte : std::string_view(program->told.data(), size)) {
      if (byte != '\n') {
        if (program->line.size() < kMaxLine) program->line += byte;
        continue;
      }
      if (const auto told = progress_in(std::exchange(program->line, {}))) program->runner->desk_.on_progress(*told);
    }
    read_progress(program);
  });
}

void SimulationRunner::wait(const std::shared_ptr<Program>& program) {
  program->exit.async_wait(Descriptor::wait_read, [program](error_code error) {
    if (program->runner == nullptr || error) return;
    program->is_ended = true;
    program->runner->end_if_over(*program);
  });
}

/// Its answer is whole once both its end was read and the process has ended.
void SimulationRunner::end_if_over(Program& program) {
  if (!program.is_read || !program.is_ended) return;
  int status = 0;
  const bool is_known = waitpid(program.pid, &status, WNOHANG) == program.pid;
  const bool is_good = is_known && WIFEXITED(status) && WEXITSTATUS(status) == 0 && !program.text.empty();
  auto answer =
      is_good ? Result<Bytes>(std::move(program.text)) : Result<Bytes>(simulator_failure(status, program.text));
  program.progress.close();
  program_.reset();
  desk_.on_gone(std::move(answer), trb::now());
  obey(trb::now());
}

}  // namespace trb::gateway
