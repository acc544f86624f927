/** What a simulation has found, as rows, series and bars. */
import type { Schemas } from '../../lib/api/types';
import type { Bar } from '../runs/timeline';

export type Answer = Schemas['SimulationAnswer'];
type Attempt = Answer['tasks'][number];
type Wait = Schemas['SimulationWait'];
export type Counted = 'messages' | 'bytes';

export interface PhaseRow {
  phase: string;
  messages: number;
  bytes: number;
  /** By Equation 12; nothing: it has no term for it, or several runs were simulated. */
  model: number | null;
  betweenMessages: number;
  betweenBytes: number;
}

export function phaseRows(answer: Answer): PhaseRow[] {
  const model: Record<string, number> = answer.model?.phases ?? {};
  return Object.entries(answer.phases).map(([phase, of]) => ({
    phase, messages: of.messages, bytes: of.bytes, model: model[phase] ?? null,
    betweenMessages: of.between_computers.messages, betweenBytes: of.between_computers.bytes,
  }));
}

/** All of a fleet's messages but upkeep, which Equation 12 does not know. */
export function withoutUpkeep(answer: Answer, of: Counted): number {
  return answer[of] - answer.phases.upkeep[of];
}

/** Per interval, up to the end: what a simulation might have taken longer is left out. */
export function seriesOf(answer: Answer, of: Counted): number[] {
  return answer.over_time[of].slice(0, Math.floor(answer.seconds / answer.over_time.interval_s) + 1);
}

/** The intervals' beginnings, s; of several series those of the longest, all with the same interval. */
export function timesOf(count: number, interval: number): number[] {
  return Array.from({ length: count }, (_, i) => i * interval);
}

/** Two series of different intervals in one: each in the longer interval. */
export function inIntervalsOf(values: number[], interval: number, wanted: number): number[] {
  if (wanted <= interval) return values;
  const out: number[] = [];
  values.forEach((value, i) => {
    const at = Math.floor((i * interval) / wanted + 1e-9);
    out[at] = (out[at] ?? 0) + value;
  });
  return out;
}

/** The interval in which most of it is. */
export function peakOf(values: number[], interval: number): { at: number; value: number } {
  const value = Math.max(0, ...values);
  return { at: Math.max(0, values.indexOf(value)) * interval, value };
}

/**
 * Attempts as bars, in s since the run's submission.
 *
 * | An attempt has             | State    | End                  |
 * |----------------------------|----------|----------------------|
 * | `end_s`                    | FINISHED | then                 |
 * | `failed_s`                 | FAILED   | then                 |
 * | neither, in a world        | RUNNING  | none: it was under way as the time was up; a robot works on without its node |
 * | neither, by the paper      | FAILED   | not known: its robot was replaced |
 */
export function barsOf(answer: Answer): Bar[] {
  const from = answer.world?.submitted_s ?? 0;
  const waits = waitsByAttempt(answer);
  return answer.tasks.map((task) => {
    const end = task.end_s ?? task.failed_s;
    return {
      task: task.id, robot: task.robot, state: stateOf(task, answer.world !== undefined), ready: null,
      start: Math.max(0, task.begin_s - from), end: end === undefined ? null : Math.max(0, end - from), isCritical: waits.get(task)?.critical ?? false,
    };
  });
}

function stateOf(task: Attempt, isWorld: boolean): Bar['state'] {
  if (task.end_s !== undefined) return 'FINISHED';
  return task.failed_s === undefined && isWorld ? 'RUNNING' : 'FAILED';
}

/** Tasks that were under way as the simulated time was up. */
export function underWay(answer: Answer): number {
  return new Set(barsOf(answer).filter((bar) => bar.state === 'RUNNING').map((bar) => bar.task)).size;
}

/**
 * Which attempt a wait is of. Those that were done have one each, and of a task that never was its last one that has
 * failed; several of one task follow each other by their begin.
 */
function waitsByAttempt(answer: Answer): Map<Attempt, Wait> {
  const waits = new Map<string, Wait[]>();
  for (const wait of answer.waits ?? []) waits.set(wait.task, [...(waits.get(wait.task) ?? []), wait]);
  const out = new Map<Attempt, Wait>();
  for (const [id, of] of waits) {
    const attempts = answer.tasks.filter((task) => task.id === id);
    const done = attempts.filter((task) => task.end_s !== undefined).sort((a, b) => a.begin_s - b.begin_s);
    const counted = done.length > 0 ? done : attempts.filter((task) => task.failed_s !== undefined).slice(-1);
    counted.forEach((task, i) => {
      if (of[i] !== undefined) out.set(task, of[i]);
    });
  }
  return out;
}

/** An attempt at a task, and what held it up. */
export interface WaitRow {
  task: string;
  robot: string;
  begin: number;
  /** Nothing: it was still under way. */
  end: number | null;
  hasFailed: boolean;
  /** Another attempt at the task counts: what this one waited for is not told. */
  isTold: boolean;
  /** The task whose end it waited for last; nothing: it waited for none. */
  holder: string | null;
  /** The robot, if it had to do the holder first; nothing: the holder comes before the task. */
  busy: string | null;
  /** Another run that kept the robot, from 1; nothing: the holder is of this one. */
  otherRun: number | null;
  /** The robot that failed at this same task, if it waited for that. */
  failed: string | null;
  /** So long after that it waited for what is no task's end, s; 0: for no longer than a hand-over takes. */
  more: number;
  isCritical: boolean;
}

/** A hand-over is shorter. */
const SHOWN_S = 0.5;

/** In s since the run's submission, as the timeline, by their begin; nothing of a simulation without a scenario. */
export function waitRows(answer: Answer): WaitRow[] {
  if (answer.waits === undefined) return [];
  const from = answer.world?.submitted_s ?? 0;
  const waits = waitsByAttempt(answer);
  const attempts = answer.tasks.filter((task) => waits.has(task) || task.end_s === undefined).sort((a, b) => a.begin_s - b.begin_s);
  return attempts.map((task) => {
    const wait = waits.get(task);
    const end = task.end_s ?? task.failed_s;
    const more = wait?.more_s ?? 0;
    return {
      task: task.id, robot: task.robot, begin: Math.max(0, task.begin_s - from), end: end === undefined ? null : Math.max(0, end - from),
      hasFailed: task.end_s === undefined && task.failed_s !== undefined, isTold: wait !== undefined, holder: wait?.waited_for || null,
      busy: wait?.robot_busy ? task.robot : null, otherRun: wait?.waited_for_run === undefined ? null : wait.waited_for_run + 1, failed: wait?.tried_again ? robotBefore(answer, task) : null, more: more < SHOWN_S ? 0 : more,
      isCritical: wait?.critical ?? false,
    };
  });
}

/** Who failed last at the same task before this attempt. */
function robotBefore(answer: Answer, attempt: Attempt): string | null {
  const failed = answer.tasks.filter((task) => task.id === attempt.id && task !== attempt && (task.failed_s ?? Infinity) <= attempt.begin_s);
  return failed.sort((a, b) => a.failed_s! - b.failed_s!).at(-1)?.robot ?? null;
}

export interface CompareRow {
  /** A phase, or a key of the page's words. */
  what: string;
  isPhase: boolean;
  a: number | null;
  b: number | null;
}

export function compareRows(a: Answer, b: Answer): CompareRow[] {
  const row = (what: string, of: (answer: Answer) => number | null): CompareRow => ({ what, isPhase: false, a: of(a), b: of(b) });
  const inB = new Map(phaseRows(b).map((one) => [one.phase, one]));
  return [
    row('makespan', makespanOf),
    row('messages', (answer) => answer.messages),
    row('bytes', (answer) => answer.bytes),
    row('betweenMessages', (answer) => answer.between_computers.messages),
    row('betweenBytes', (answer) => answer.between_computers.bytes),
    row('equation12', (answer) => answer.model?.messages ?? null),
    ...phaseRows(a).map((one) => ({ what: one.phase, isPhase: true, a: one.messages, b: inB.get(one.phase)?.messages ?? null })),
  ];
}

/** From the first task's begin to the last one's end, s; of several runs of all; nothing: not all were done. */
export function makespanOf(answer: Answer): number | null {
  if (answer.beside !== undefined && answer.beside.length > 0) return makespanOfAll([answer.world!, ...answer.beside], [answer.tasks, ...answer.beside.map((one) => one.tasks)].flat());
  if (answer.world) return answer.world.state === 'FINISHED' && answer.world.tasks_done > 0 ? answer.world.makespan_s : null;
  return answer.tasks_not_listed > 0 ? answer.seconds : lastEnd(answer) - (answer.tasks[0]?.begin_s ?? 0);
}

function makespanOfAll(runs: { state: string }[], tasks: Attempt[]): number | null {
  if (runs.some((run) => run.state !== 'FINISHED') || tasks.length === 0) return null;
  return Math.max(...tasks.map((task) => task.end_s ?? 0)) - Math.min(...tasks.map((task) => task.begin_s));
}

function lastEnd(answer: Answer): number {
  return answer.tasks.reduce((last, task) => Math.max(last, task.end_s ?? 0), 0);
}
