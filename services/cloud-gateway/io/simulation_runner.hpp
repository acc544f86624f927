// Carries out the orders of SimulationDesk: the program that plays a simulation, on the gateway's loop.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "common/base/time.hpp"
#include "services/cloud-gateway/core/simulations/simulation_desk.hpp"

namespace trb::gateway {

class SimulationRunner {
 public:
  /// `loop` must outlive this.
  explicit SimulationRunner(boost::asio::io_context& loop);
  SimulationRunner(const SimulationRunner&) = delete;
  SimulationRunner& operator=(const SimulationRunner&) = delete;
  ~SimulationRunner() { stop(); }
  /// Ends the program that plays, and starts none any more.
  void stop();

  [[nodiscard]] const SimulationDesk& desk() const { return desk_; }
  Result<const Simulation*> add(SimulationJob job, std::string by, Now now);
  Result<const Simulation*> remove(const std::string& id, Now now);
  void tick(Now now);

 private:
  struct Program;
  void obey(Now now);
  void start(const std::string& job);
  static void read_answer(const std::shared_ptr<Program>& program);
  static void read_progress(const std::shared_ptr<Program>& program);
  static void wait(const std::shared_ptr<Program>& program);
  void end_if_over(Program& program);

  boost::asio::io_context& loop_;
  SimulationDesk desk_;
  std::shared_ptr<Program> program_;
  bool is_stopped_ = false;
};

}  // namespace trb::gateway
