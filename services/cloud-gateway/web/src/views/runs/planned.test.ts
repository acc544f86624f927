import { describe, expect, it } from 'vitest';
import type { RunDetail, TaskView } from '../../lib/api/types';
import { planOf, timesOf } from './planned';

const AT = 1_000_000_000_000;
const at = (seconds: number) => AT + seconds * 1e9;
const task = (id: string, robot: string, skill: string, more: Partial<TaskView> = {}): TaskView =>
  ({ id, robot, skill, state: 'WAITING', after: [], started: 0, ended: 0, ...more }) as unknown as TaskView;
const did = (robot: string, skill: string, took: number): TaskView =>
  task('x', robot, skill, { state: 'FINISHED', started: at(1), ended: at(1 + took) } as Partial<TaskView>);
const run = (...tasks: TaskView[]) => ({ created: AT, tasks }) as RunDetail;

describe('the plan of a run', () => {
  const times = timesOf([run(did('cart', 'go', 4), did('cart', 'go', 6), did('cart', 'go', 5)), run(did('arm', 'pick', 2))]);

  it('takes the median of what a skill took on that robot', () => {
    expect(times.get('go cart')).toBe(5);
    expect(times.get('pick')).toBe(2);
  });

  it('counts what was done alone', () => {
    expect(timesOf([run({ ...did('cart', 'go', 9), state: 'FAILED' } as TaskView, task('y', 'cart', 'go'))]).size).toBe(0);
  });

  it('begins a task behind its predecessors, and where its robot is free', () => {
    const plan = planOf(run(task('a', 'cart', 'go'), task('b', 'arm', 'pick', { after: [0] }), task('c', 'cart', 'go')), times);
    expect(plan.get('a')).toEqual({ start: 0, end: 5 });
    expect(plan.get('b')).toEqual({ start: 5, end: 7 });
    expect(plan.get('c')).toEqual({ start: 5, end: 10 });
  });

  it('takes what the skill took on another robot, if it was never done on this one', () => {
    expect(planOf(run(task('a', 'cart2', 'go')), times).get('a')).toEqual({ start: 0, end: 5 });
  });

  it('plans nothing for a skill that was never done, and nothing behind it', () => {
    const plan = planOf(run(task('a', 'cart', 'dance'), task('b', 'arm', 'pick', { after: [0] }), task('c', 'arm', 'pick')), times);
    expect([...plan.keys()]).toEqual(['c']);
  });

  it('ends, whatever the tasks name before them', () => {
    expect(planOf(run(task('a', 'cart', 'go', { after: [0] }), task('b', 'cart', 'go', { after: [7] })), times).size).toBe(0);
  });
});
