/** The word that a robot stands still. */
import type { TaskView } from '../../lib/api/types';

/** Whom somebody sees stand still: the robot of this attempt, and no other one. */
export interface Seen { task: string; robot: string; attempt: number }

export const seenOf = ({ id, robot, attempt }: TaskView): Seen => ({ task: id, robot, attempt });

export function isStill(seen: Seen, task: TaskView): boolean {
  return seen.task === task.id && seen.robot === task.robot && seen.attempt === task.attempt;
}
