#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace trb::virtual_robots::mir {

/** In metres and degrees of the map, as on the robot's own web page. */
struct Position {
  double x = 0;
  double y = 0;
  double orientation = 0;
};

/** The values of state_id; a real robot has more. */
enum class State { ready = 3, pause = 4, executing = 5, emergency_stop = 10, error = 12 };

enum class QueueState { pending, executing, done, aborted };
const char* name_of(QueueState state);

struct QueueEntry {
  std::int64_t id = 0;
  std::string mission;  ///< its guid
  QueueState state = QueueState::pending;
  std::string message;
};

struct Mission {
  std::string guid;
  std::string name;
  Position to;
};

struct RobotError {
  int code = 0;
  std::string description;
  bool stops = true;
};

struct RobotSettings {
  std::map<std::string, Position> positions;
  double speed_m_s = 1.1;
  double battery = 87.0;  ///< percent
};

/**
 * A MiR's mission queue and motion: one mission at a time, the oldest first; paused, it stands. It uses
 * neither sockets nor clocks.
 */
class Robot {
 public:
  explicit Robot(RobotSettings settings);

  void advance(double now);
  /** When something changes by itself. */
  std::optional<double> next_deadline() const;

  const std::vector<Mission>& missions() const { return missions_; }
  /** Nothing if there is no such mission. */
  const QueueEntry* queue(const std::string& mission);
  const std::map<std::int64_t, QueueEntry>& entries() const { return entries_; }
  /** All missions that are not over become Aborted. */
  void abort_all();
  bool abort(std::int64_t id);

  State state() const;
  void pause() { paused_ = true; }
  void resume() { paused_ = false; }
  void clear_errors();
  void fail(RobotError error);
  void emergency_stop() { emergency_ = true; }
  void end_emergency() { emergency_ = false; }

  Position position() const { return at_; }
  double battery() const { return battery_; }
  double speed() const { return state() == State::executing ? settings_.speed_m_s : 0; }
  double to_go() const;
  const std::vector<RobotError>& errors() const { return errors_; }
  const QueueEntry* current() const;
  const Mission* mission_of(const QueueEntry& entry) const;

  std::vector<std::string> take_events();

 private:
  void end(QueueState how, const std::string& message);
  void forget_old();

  RobotSettings settings_;
  std::vector<Mission> missions_;
  std::map<std::int64_t, QueueEntry> entries_;
  std::deque<std::int64_t> waiting_;  ///< the first one is under way
  std::int64_t last_id_ = 0;
  Position at_;
  double battery_;
  double last_ = 0;
  bool paused_ = false;
  bool emergency_ = false;
  std::vector<RobotError> errors_;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::mir
