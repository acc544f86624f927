/** What is wrong with a robot, each once: a fault that keeps it out of use is told twice, one of the whole robot for each capability, too. */
import type { RobotContent, Severity } from '../../lib/api/types';

export interface ShownFault {
  severity: Severity;
  /** Empty: the whole robot. */
  capability: string;
  text: string;
  since: number | string;
  isRetired: boolean;
  by: string;
}

export function shownFaults(robot: RobotContent): ShownFault[] {
  const all: ShownFault[] = [
    ...robot.out_of_use.map((one) => ({ ...one, isRetired: one.retired })),
    ...robot.faults.map((fault) => ({ ...fault, isRetired: false, by: '' })),
  ];
  return all.filter((one, i) => !all.some((other, at) => at !== i && other.text === one.text && !one.isRetired && !other.isRetired
    && ((at < i && other.capability === one.capability) || (other.capability === '' && one.capability !== ''))));
}
