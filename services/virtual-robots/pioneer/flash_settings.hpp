#pragma once

namespace trb::virtual_robots::pioneer {

/**
 * Settings that CONFIG tells and commands change, with the usual values of a P3-DX. They change nothing of the motion:
 * its wheels are ideal.
 */
struct FlashSettings {
  /** Of a servo. */
  struct Gains {
    int proportional = 0;
    int derivative = 0;
    int integral = 0;
  };
  int encoder_ticks_mm = 128;
  int encoder_revolution = 16'570;  ///< the wheels' difference in a half turn, eighths of ticks
  int stall_pwm = 200;
  int stall_ms = 200;
  Gains turn{40, 20, 0};
  Gains drive{40, 30, 0};

  /** ROTKP to TRANSKI, REVCOUNT, TICKSMM. False: the command is none of these. */
  bool take(int command, int value);
};

}  // namespace trb::virtual_robots::pioneer
