import { describe, expect, it } from 'vitest';
import type { RunDetail, TaskView } from '../../lib/api/types';
import { barsOf, clock, differences, marksOf, spanOf } from './timeline';

const AT = 1_000_000_000_000;
const at = (seconds: number) => AT + seconds * 1e9;
const task = (id: string, more: Partial<TaskView> = {}): TaskView =>
  ({ id, robot: 'ur3', state: 'FINISHED', after: [], started: 0, ended: 0, ...more }) as TaskView;
const run = (...tasks: TaskView[]) => ({ created: AT, tasks }) as RunDetail;

describe('the timeline of a run', () => {
  it('tells when a task could begin, began and ended', () => {
    const bars = barsOf(run(task('a', { started: at(1), ended: at(4) }), task('b', { after: [0], started: at(6), ended: at(7) })));
    expect(bars[0]).toMatchObject({ ready: 0, start: 1, end: 4 });
    expect(bars[1]).toMatchObject({ ready: 4, start: 6, end: 7 });
  });

  it('does not guess when a task can begin whose predecessor goes on', () => {
    expect(barsOf(run(task('a', { started: at(1), state: 'RUNNING' }), task('b', { after: [0] })))[1]!.ready).toBeNull();
  });

  it('does not call a task ready whose predecessor has failed', () => {
    const failed = task('a', { started: at(1), ended: at(2), state: 'FAILED' });
    expect(barsOf(run(failed, task('b', { after: [0] })))[1]!.ready).toBeNull();
  });

  it('does not wait for what was left out', () => {
    expect(barsOf(run(task('a', { state: 'SKIPPED' }), task('b', { after: [0] })))[1]!.ready).toBe(0);
  });

  it('begins no task before its run, whatever a clock says', () => {
    expect(barsOf(run(task('a', { started: at(-3), ended: at(2) })))[0]!.start).toBe(0);
  });

  it('lasts until now while it is under way', () => {
    const bars = barsOf(run(task('a', { started: at(1) })));
    expect(spanOf(bars, 30)).toBe(30);
    expect(spanOf(bars, null)).toBe(1);
  });

  it('has marks at whole times, and not too many', () => {
    expect(marksOf(31, 8)).toEqual([0, 5, 10, 15, 20, 25, 30]);
    expect(marksOf(600, 5)).toEqual([0, 120, 240, 360, 480, 600]);
    expect(marksOf(9e6, 6).length).toBeLessThanOrEqual(7);
  });

  it('writes times as people read them', () => {
    expect([0.4, 59, 65, 3725].map(clock)).toEqual(['0 s', '59 s', '1:05', '1:02:05']);
  });
});

describe('two runs', () => {
  const a = barsOf(run(task('go', { started: at(0), ended: at(5) }), task('pick', { started: at(5) })));
  const b = barsOf(run(task('go', { started: at(0), ended: at(8) }), task('pick', { started: at(8), ended: at(9) }), task('new')));

  it('are compared task by task', () => expect(differences(a, b).map((one) => one.task)).toEqual(['go', 'pick', 'new']));
  it('tell how much longer the second took', () => expect(differences(a, b)[0]!.longer).toBe(3));
  it('tell nothing of what did not end in both', () => {
    expect(differences(a, b)[1]!.longer).toBeNull();
    expect(differences(a, b)[2]).toMatchObject({ a: undefined, longer: null });
  });
});
