/** A skill as a scenario of one task, for this robot and no other. */
import type { Scenario } from '../../lib/scenario/scenario_model';
import { emptyScenario, freshId } from '../../lib/scenario/scenario_model';

export function oneTask(robot: string, skill: string, data: Record<string, unknown>): Scenario {
  const task = { id: freshId(emptyScenario(), skill), robot, skill, pinned: true };
  return { name: `${skill} ${robot}`.slice(0, 64), tasks: [Object.keys(data).length === 0 ? task : { ...task, data }] };
}
