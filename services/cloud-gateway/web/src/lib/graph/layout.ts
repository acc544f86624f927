/**
 * Where the tasks of a scenario are drawn: a column for each step, a row for each task of it. A task stands one column
 * right of the last task that it waits for (longest path). Within a column, tasks stand near those that they wait for
 * (barycentre, Sugiyama 1981), so that few lines cross.
 */
export interface Placed {
  column: number;
  row: number;
}

const SWEEPS = 4;

/** `after[i]`: whom task i waits for. What points nowhere is left out; what waits in a circle stands where it is found. */
export function layered(after: readonly (readonly number[])[]): Placed[] {
  const columns = columnsOf(after);
  const byColumn: number[][] = [];
  columns.forEach((column, task) => (byColumn[column] ??= []).push(task));
  const rows = new Array<number>(after.length).fill(0);
  for (const tasks of byColumn) tasks?.forEach((task, row) => (rows[task] = row));
  const before = after.map((list, task) => list.filter((one) => one !== task && one >= 0 && one < after.length));
  const next: number[][] = after.map(() => []);
  before.forEach((list, task) => list.forEach((one) => next[one]!.push(task)));
  for (let sweep = 0; sweep < SWEEPS; ++sweep) {
    const isDown = sweep % 2 === 0;
    const order = isDown ? byColumn : [...byColumn].reverse();
    for (const tasks of order) if (tasks) arrange(tasks, isDown ? before : next, rows);
  }
  return columns.map((column, task) => ({ column, row: rows[task]! }));
}

/** Whom each task waits for, without those that another one of them waits for already: fewer lines say the same. */
export function withoutImplied(after: readonly (readonly number[])[]): number[][] {
  const reached = after.map(() => new Set<number>());
  const order = columnsOf(after).map((column, task) => ({ column, task })).sort((a, b) => a.column - b.column);
  for (const { task } of order) {
    for (const one of after[task]!) {
      reached[one]?.forEach((far) => reached[task]!.add(far));
      reached[task]!.add(one);
    }
  }
  return after.map((list, task) => list.filter((one) => !list.some((other) => other !== one && other !== task && reached[other]?.has(one) && !reached[one]?.has(other))));
}

function columnsOf(after: readonly (readonly number[])[]): number[] {
  const columns = new Array<number>(after.length).fill(0);
  // At most one round for each task; a circle ends there.
  for (let round = 0; round < after.length; ++round) {
    let isMoved = false;
    after.forEach((list, task) => {
      const column = list.reduce((most, one) => Math.max(most, (columns[one] ?? -1) + 1), 0);
      if (column > columns[task]! && column < after.length) {
        columns[task] = column;
        isMoved = true;
      }
    });
    if (!isMoved) break;
  }
  return columns;
}

function arrange(tasks: number[], near: readonly number[][], rows: number[]): void {
  const middle = new Map(tasks.map((task) => [task, middleOf(near[task]!, rows) ?? rows[task]!]));
  tasks.sort((a, b) => middle.get(a)! - middle.get(b)! || rows[a]! - rows[b]!);
  tasks.forEach((task, row) => (rows[task] = row));
}

function middleOf(tasks: readonly number[], rows: number[]): number | null {
  return tasks.length === 0 ? null : tasks.reduce((sum, task) => sum + rows[task]!, 0) / tasks.length;
}
