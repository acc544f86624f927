/** What one word a person sees for a robot: the worst of what its row says comes first. */
import type { Live, RobotContent, Row, Severity } from '../api/types';

export type RobotState =
  | 'notHeard' | 'refused' | 'failed' | 'stopped' | 'broken' | 'offline' | 'retired' | 'late' | 'limited' | 'atWork'
  | 'ready' | 'unknown';

/** Worst first: also the order of the table by state. */
export const stateOrder: RobotState[] = [
  'failed', 'stopped', 'notHeard', 'refused', 'broken', 'offline', 'limited', 'late', 'retired', 'unknown', 'atWork', 'ready',
];

const severityOrder: Severity[] = ['FATAL', 'CRITICAL', 'URGENT', 'WARNING'];

export function worst(severities: Severity[]): Severity | null {
  return severityOrder.find((one) => severities.includes(one)) ?? null;
}

function stateOfLive(live: Live): RobotState | null {
  if (live === 'not_heard') return 'notHeard';
  if (live === 'refused') return 'refused';
  return live === 'late' ? 'late' : null;
}

function stateOfConnection(connection: string): RobotState | null {
  if (connection === 'ONLINE') return null;
  if (connection === 'OFFLINE') return 'offline';
  return connection === '' ? 'unknown' : 'broken';
}

function stateOfUse(robot: RobotContent): RobotState | null {
  if (robot.out_of_use.some((one) => one.retired)) return 'retired';
  if (robot.out_of_use.some((one) => one.capability === '')) return 'failed';
  return robot.out_of_use.length > 0 || robot.faults.length > 0 ? 'limited' : null;
}

export function robotState(row: Row<RobotContent>): RobotState {
  const robot = row.content;
  const told = stateOfLive(row.live);
  if (told === 'notHeard' || told === 'refused') return told;
  const use = stateOfUse(robot);
  if (use === 'failed') return use;
  if (robot.fenced) return 'stopped';
  return stateOfConnection(robot.connection) ?? use ?? told ?? (robot.control === '' ? 'ready' : 'atWork');
}

/** Of its faults and of what keeps it out of use. */
export function robotSeverity(robot: RobotContent): Severity | null {
  return worst([...robot.faults, ...robot.out_of_use.filter((one) => !one.retired)].map((one) => one.severity));
}
