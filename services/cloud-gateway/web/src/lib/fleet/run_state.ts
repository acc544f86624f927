/** How tasks and runs look, and what may be ordered in which state. */
import type { RobotContent, Row, RunDetail, RunSummary, TaskView } from '../api/types';
import type { Look } from '../ui/shapes';

export type TaskState = TaskView['state'];
export type RunState = RunDetail['state'];
export type RunOrder = 'pause' | 'resume' | 'abort';
export type TaskOrder = 'move' | 'retry' | 'skip';

const HELD = 'a person: held by ';
const CIRCLE = 'M12 3a9 9 0 1 0 0 18 9 9 0 1 0 0-18z';
const CHECK = 'M4 13 10 19 21 5';
const BARS = 'M8 4v16M16 4v16';
const CROSS = 'M5 5 19 19M19 5 5 19';
const ARROW = 'M4 12h16M14 6l6 6-6 6';

export const taskLooks: Record<TaskState, Look> = {
  WAITING: { path: CIRCLE, tone: 'calm', isFilled: false },
  INITIALIZING: { path: ARROW, tone: 'calm', isFilled: false },
  RUNNING: { path: CIRCLE, tone: 'calm', isFilled: true },
  PAUSED: { path: BARS, tone: 'stopped', isFilled: false },
  RETRIABLE: { path: 'M12 1 23 12 12 23 1 12z', tone: 'urgent', isFilled: true },
  FINISHED: { path: CHECK, tone: 'calm', isFilled: false },
  FAILED: { path: 'M3 3h18v18H3z', tone: 'critical', isFilled: true },
  SKIPPED: { path: 'M4 12h16', tone: 'stale', isFilled: false },
};

/** Nobody holds it: it waits for a person's decision. */
const WAITS: Look = { path: CIRCLE, tone: 'urgent', isFilled: false };

export const runLooks: Record<RunState, Look> = {
  RUNNING: taskLooks.RUNNING,
  PAUSED: taskLooks.PAUSED,
  ABORTING: { path: CROSS, tone: 'urgent', isFilled: false },
  FINISHED: taskLooks.FINISHED,
  ABORTED: { path: CROSS, tone: 'stale', isFilled: false },
  EXPIRED: { path: CROSS, tone: 'warning', isFilled: false },
};

/** A run as its badge shows it. Its summary does not say who holds it, but what it waits for does: "a person: held by ...". */
export function runBadge(run: Pick<RunSummary, 'state' | 'waits_for'> & { paused_by?: string }): { look: Look; word: string } {
  const isHeld = run.paused_by ? true : run.waits_for === '' || run.waits_for.startsWith(HELD);
  const waits = run.state === 'PAUSED' && !isHeld;
  return waits ? { look: WAITS, word: 'waits' } : { look: runLooks[run.state], word: run.state };
}

/** What a person may do about what a run waits for. */
export interface Help {
  /** Tasks that somebody has to decide on: they failed or were broken off. */
  tasks: string[];
  /** Robots of open tasks that are stopped until they are released. */
  stopped: string[];
}

export function helpOf(run: RunDetail, robots: Row<RobotContent>[]): Help {
  if (run.state !== 'RUNNING' && run.state !== 'PAUSED') return { tasks: [], stopped: [] };
  const open = run.tasks.filter((task) => task.state !== 'FINISHED' && task.state !== 'SKIPPED');
  const fenced = new Set(robots.filter((row) => row.content.fenced).map((row) => row.node));
  return {
    tasks: open.filter((task) => task.state === 'FAILED' || task.state === 'RETRIABLE').map((task) => task.id),
    stopped: [...new Set(open.map((task) => task.robot))].filter((robot) => fenced.has(robot)),
  };
}

/** Its word in the section `taskState`. What is RETRIABLE is begun again by nobody but a person; of a run that is over nothing waits. */
export function taskWord(state: TaskState, outcome: TaskView['outcome'] = 'none', run?: RunState): string {
  if (run !== undefined && !isUnderWay(run) && (state === 'WAITING' || state === 'INITIALIZING')) return 'notBegun';
  return state === 'RETRIABLE' && outcome === 'interrupted' ? 'interrupted' : state;
}

export function isUnderWay(state: RunState): boolean {
  return state === 'RUNNING' || state === 'PAUSED' || state === 'ABORTING';
}

/** The orders that make sense for a run; the gateway has the last word. */
export function runOrders(run: RunDetail): RunOrder[] {
  if (!isUnderWay(run.state)) return [];
  if (run.state === 'ABORTING') return ['abort']; // said again to who did not receive it
  return run.paused_by === '' ? ['pause', 'abort'] : ['resume', 'abort'];
}

/** The orders that make sense for a task. One that is over stays as it is. */
export function taskOrders(run: RunDetail, task: TaskView): TaskOrder[] {
  if (!isUnderWay(run.state) || run.state === 'ABORTING') return [];
  if (task.state === 'FINISHED' || task.state === 'SKIPPED') return [];
  return task.state === 'FAILED' || task.state === 'RETRIABLE' ? ['retry', 'move', 'skip'] : ['move', 'skip'];
}

/** Eight digits tell runs apart for a person; the whole id is shown where it is needed. */
export function shortId(id: string): string {
  return id.slice(0, 8);
}
