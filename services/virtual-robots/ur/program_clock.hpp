#pragma once

namespace trb::virtual_robots::ur {

/** The time of programs and of the arm, in seconds: it stands still while the program is paused. */
class ProgramClock {
 public:
  void pause(double now) {
    if (!paused_) paused_at_ = now;
    paused_ = true;
  }
  void resume(double now) {
    if (paused_) held_ += now - paused_at_;
    paused_ = false;
  }

  bool paused() const { return paused_; }
  double at(double now) const { return (paused_ ? paused_at_ : now) - held_; }
  /** The robot's time at which this clock, if it runs, shows `time`. */
  double when(double time) const { return time + held_; }

 private:
  bool paused_ = false;
  double paused_at_ = 0;
  double held_ = 0;
};

}  // namespace trb::virtual_robots::ur
