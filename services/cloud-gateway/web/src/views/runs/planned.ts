/** How a run would go if each skill took as long as in earlier runs: planned beside actual. All times in s since the start. */
import type { RunDetail, TaskView } from '../../lib/api/types';

export interface Planned {
  start: number;
  end: number;
}

/** So many earlier runs are looked at. */
export const LOOKED_AT = 5;

const NS = 1e9;

/** By skill, and by skill and robot: what each took in those runs, s. Of several the median. */
export function timesOf(runs: RunDetail[]): Map<string, number> {
  const took = new Map<string, number[]>();
  for (const task of runs.flatMap((run) => run.tasks)) {
    if (task.state !== 'FINISHED' || task.started === 0 || task.ended <= task.started) continue;
    for (const key of keysOf(task)) took.set(key, [...(took.get(key) ?? []), (task.ended - task.started) / NS]);
  }
  return new Map([...took].map(([key, times]) => [key, median(times)]));
}

/**
 * By task: it begins once its predecessors are done and its robot has done what it had before, and takes as long as its skill
 * did, there or on any robot. A task whose skill is new has no plan, and what follows it neither.
 */
export function planOf(run: RunDetail, times: Map<string, number>): Map<string, Planned> {
  const out = new Map<string, Planned>();
  const free = new Map<string, number>();
  for (let left = new Set(run.tasks); left.size > 0;) {
    const next = earliest(run, left, out, free);
    if (next === null) break;
    const [task, start] = next;
    left.delete(task);
    const took = keysOf(task).map((key) => times.get(key)).find((time) => time !== undefined);
    if (took === undefined) continue;
    out.set(task.id, { start, end: start + took });
    free.set(task.robot, start + took);
  }
  return out;
}

/** Of the tasks whose predecessors have a plan, the one that can begin first; of two, the one that stands first. */
function earliest(run: RunDetail, left: Set<TaskView>, planned: Map<string, Planned>, free: Map<string, number>): [TaskView, number] | null {
  let best: [TaskView, number] | null = null;
  for (const task of left) {
    const before = task.after.map((i) => planned.get(run.tasks[i]?.id ?? ''));
    if (before.some((one) => one === undefined)) continue;
    const start = Math.max(free.get(task.robot) ?? 0, ...before.map((one) => one!.end));
    if (best === null || start < best[1]) best = [task, start];
  }
  return best;
}

function keysOf(task: TaskView): string[] {
  return [`${task.skill} ${task.robot}`, task.skill];
}

function median(values: number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)]!;
}
