/** A run in time: when each task could begin, began and ended. All times in s since the run was made. */
import type { RunDetail, TaskView } from '../../lib/api/types';

export interface Bar {
  task: string;
  robot: string;
  state: TaskView['state'];
  outcome?: TaskView['outcome'];
  /** When its last predecessor was done; nothing: not all are. */
  ready: number | null;
  start: number | null;
  /** Nothing: it goes on, or has not begun. */
  end: number | null;
  /** The run is shorter only if one of these is. */
  isCritical?: boolean;
}

const NS = 1e9;

export function barsOf(run: RunDetail): Bar[] {
  const since = (time: number) => (time === 0 ? null : Math.max(0, (time - run.created) / NS));
  return run.tasks.map((task) => ({
    task: task.id, robot: task.robot, state: task.state, outcome: task.outcome, ready: readyOf(run, task, since),
    start: since(task.started), end: since(task.ended),
  }));
}

function readyOf(run: RunDetail, task: TaskView, since: (time: number) => number | null): number | null {
  const before = task.after.map((i) => run.tasks[i]).filter((one) => one !== undefined);
  if (before.length === 0) return 0;
  if (before.some((one) => one.state !== 'FINISHED' && one.state !== 'SKIPPED')) return null;
  return Math.max(0, ...before.map((one) => since(one.ended) ?? 0));
}

/** The length of the whole timeline: up to now while it is under way. */
export function spanOf(bars: Bar[], now: number | null): number {
  return Math.max(1, now ?? 0, ...bars.map((bar) => Math.max(bar.start ?? 0, bar.end ?? 0)));
}

const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200, 86400];

/** Where the axis has its marks: at most `most`, at whole seconds, minutes or hours. */
export function marksOf(span: number, most: number): number[] {
  const step = STEPS.find((one) => span / one <= most) ?? Math.ceil(span / most / 86400) * 86400;
  return Array.from({ length: Math.floor(span / step) + 1 }, (_, i) => i * step);
}

/** 5 s, 2:05, 1:02:05. */
export function clock(seconds: number): string {
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  const two = (value: number) => String(value).padStart(2, '0');
  const minutes = Math.floor(whole / 60);
  if (minutes < 60) return `${minutes}:${two(whole % 60)}`;
  return `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(whole % 60)}`;
}

export interface Difference {
  task: string;
  a: Bar | undefined;
  b: Bar | undefined;
  /** How much longer it took in b, s; nothing: it did not end in both. */
  longer: number | null;
}

/** Two runs task by task, in the order of a; tasks that only b has come last. */
export function differences(a: Bar[], b: Bar[]): Difference[] {
  const inB = new Map(b.map((bar) => [bar.task, bar]));
  const inA = new Set(a.map((bar) => bar.task));
  const both = a.map((bar) => differenceOf(bar.task, bar, inB.get(bar.task)));
  return [...both, ...b.filter((bar) => !inA.has(bar.task)).map((bar) => differenceOf(bar.task, undefined, bar))];
}

function differenceOf(task: string, a: Bar | undefined, b: Bar | undefined): Difference {
  const tookA = tookOf(a);
  const tookB = tookOf(b);
  return { task, a, b, longer: tookA === null || tookB === null ? null : tookB - tookA };
}

/** How long it took, s; nothing: it has not ended. */
export function tookOf(bar: Bar | undefined): number | null {
  return bar?.start == null || bar.end === null ? null : bar.end - bar.start;
}
