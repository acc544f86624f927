import { describe, expect, it } from 'vitest';
import { lateFaults, lateSensors, playedOf, standOf } from './plan_end';
import type { Answer } from './plan_result';

type World = NonNullable<Answer['world']>;
const over: World = { state: 'FINISHED', over_everywhere: true, tasks_done: 2, makespan_s: 8, linked_s: 0.5, submitted_s: 6, events: 5, broken: [] };
const answer = (world?: World): Answer => ({ seconds: 306, ...(world === undefined ? {} : { world }) }) as Answer;
const open = (more: Partial<World>) => standOf(answer({ ...over, state: 'OPEN', cut_off: true, alerts: [], at_work: 0, open_at: ['r0'], off: [], ...more }));

describe('the end of a simulated run', () => {
  it('is none of the paper\'s protocol, and not told of a run that is over', () => {
    expect([standOf(answer()), standOf(answer(over)), standOf(answer({ ...over, state: 'ABORTED' }))]).toEqual([null, null, null]);
  });

  it('says what a run that is not over everywhere waits for: its nodes, if it has its end, a person, or nothing', () => {
    const alert = { robot: 'r0', cause: 'robot_fault', text: '', tasks: ['t0'] };
    expect(open({ alerts: [alert], stands_still_s: 290 })).toBe('waits');
    expect(open({ state: 'FINISHED', finished_at_cloud: true, stands_still_s: 290 })).toBe('kept');
    expect(open({ finished_at_cloud: false, stands_still_s: 290 })).toBe('still');
    expect(open({ finished_at_cloud: false, at_work: 1 })).toBe('open');
    expect(standOf(answer({ ...over, state: 'OPEN' }))).toBe('open');
  });

  it('names the faults that were not reached, as the job has them', () => {
    const late = answer({ ...over, not_reached: [{ fault: 1, at: 400 }, { fault: 7, at: 500 }] });
    const faults = [{ at: 2, kind: 'fail' as const, node: 'r0' }, { at: 400, kind: 'repair' as const, node: 'r0' }];
    expect(lateFaults(late, { faults })).toEqual([{ at: 400, place: 1, fault: faults[1] }, { at: 500, place: 7, fault: null }]);
    expect([lateFaults(answer(over), { faults }), lateFaults(answer(), {})]).toEqual([[], []]);
  });

  it('names the sensors that were to tell something later', () => {
    const late = answer({ ...over, steps_not_reached: [{ sensor: 1, at: 40, steps: 2 }, { sensor: 3, at: 50, steps: 1 }] });
    const sensor_values = [{ node: 'a', name: 'x', value: 1 }, { node: 'belt', name: 'load', steps: [{ at: 0, value: 1 }, { at: 40, value: 2 }, { at: 50, value: 3 }] }];
    expect(lateSensors(late, { sensor_values })).toEqual([{ at: 40, place: 1, name: 'load, belt' }, { at: 50, place: 3, name: '' }]);
    expect(lateSensors(answer(over), {})).toEqual([]);
  });

  it('counts what was played from the submission', () => {
    expect([playedOf(answer(over)), playedOf(answer())]).toEqual([300, 306]);
  });
});
