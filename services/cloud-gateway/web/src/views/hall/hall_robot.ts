import type { RobotContent, Row } from '../../lib/api/types';
import type { Pose } from '../../lib/fleet/pose';
import type { RobotState } from '../../lib/fleet/robot_state';
import type { RobotTask } from '../../lib/fleet/tasks.svelte';

/** A robot as the hall shows it. */
export interface HallRobot {
  id: string;
  row: Row<RobotContent>;
  state: RobotState;
  pose: Pose | null;
  charge: number | null;
  task: RobotTask | undefined;
}
