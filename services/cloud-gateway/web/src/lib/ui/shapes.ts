/** A shape for each state, so that no state is told by colour alone. Paths in a square of 24. */
import type { Severity } from '../api/types';
import type { RobotState } from '../fleet/robot_state';

export type Tone = 'calm' | 'stale' | 'stopped' | 'critical' | 'urgent' | 'warning';
export interface Look {
  path: string;
  tone: Tone;
  isFilled: boolean;
}

const CIRCLE = 'M12 3a9 9 0 1 0 0 18 9 9 0 1 0 0-18z';
const OCTAGON = 'M8 2h8l6 6v8l-6 6H8l-6-6V8z';
const SQUARE = 'M3 3h18v18H3z';
const DIAMOND = 'M12 1 23 12 12 23 1 12z';
const TRIANGLE = 'M12 2 23 21H1z';
const CROSS = 'M5 5 19 19M19 5 5 19';
const QUESTION = 'M8 9a4 4 0 1 1 5.5 3.7c-1 .4-1.5 1.2-1.5 2.3M12 18v1.5';
const BAR = 'M4 12h16';
const CLOCK = `${CIRCLE}M12 7v5l4 2`;

export const stateLooks: Record<RobotState, Look> = {
  ready: { path: CIRCLE, tone: 'calm', isFilled: false },
  atWork: { path: CIRCLE, tone: 'calm', isFilled: true },
  stopped: { path: OCTAGON, tone: 'stopped', isFilled: true },
  retired: { path: BAR, tone: 'stale', isFilled: false },
  failed: { path: SQUARE, tone: 'critical', isFilled: true },
  limited: { path: TRIANGLE, tone: 'warning', isFilled: true },
  offline: { path: CROSS, tone: 'urgent', isFilled: false },
  broken: { path: CROSS, tone: 'urgent', isFilled: false },
  late: { path: CLOCK, tone: 'stale', isFilled: false },
  notHeard: { path: QUESTION, tone: 'stale', isFilled: false },
  refused: { path: QUESTION, tone: 'stale', isFilled: false },
  unknown: { path: QUESTION, tone: 'stale', isFilled: false },
};

export const severityLooks: Record<Severity, Look> = {
  FATAL: { path: SQUARE, tone: 'critical', isFilled: true },
  CRITICAL: { path: SQUARE, tone: 'critical', isFilled: true },
  URGENT: { path: DIAMOND, tone: 'urgent', isFilled: true },
  WARNING: { path: TRIANGLE, tone: 'warning', isFilled: true },
};
