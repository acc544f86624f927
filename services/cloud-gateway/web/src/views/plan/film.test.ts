import { describe, expect, it } from 'vitest';
import type { Simulation } from './plan_job';
import type { Answer } from './plan_result';
import { changesOf, filmOf, pointAt, sceneAt, standsOf } from './film';

const answer = (more: Partial<Answer> = {}): Answer => ({
  seconds: 30, messages: 0, bytes: 0, between_computers: { messages: 0, bytes: 0 }, over_time: { interval_s: 1, messages: [], bytes: [] },
  phases: {} as Answer['phases'], model: {} as NonNullable<Answer['model']>,
  world: { state: 'FINISHED', over_everywhere: true, tasks_done: 2, makespan_s: 8, linked_s: 0.5, submitted_s: 10, events: 5, broken: [] },
  tasks: [{ id: 'go', robot: 'a', begin_s: 11, end_s: 14 }, { id: 'pick', robot: 'b', begin_s: 15, failed_s: 16 }, { id: 'pick', robot: 'a', begin_s: 18, end_s: 20 }],
  tasks_not_listed: 0, sendings_not_listed: 0,
  sendings: [{ at_s: 14, phase: 'forward', from: 'a', to: 'b' }, { at_s: 14.5, phase: 'task', from: 'a', to: 'cloud' }],
  happenings: [{ at_s: 16, kind: 'fail', node: 'b' }, { at_s: 17, kind: 'cut', node: 'b', other: 'a', way: 'there' }, { at_s: 19, kind: 'heal', node: 'b', other: 'a' }],
  ...more,
});
const one = {
  robots: 2, tasks: 2, job: { scenario: { tasks: [{ id: 'go', data: { place: 'dock' } }, { id: 'pick' }] } },
} as unknown as Simulation;
const film = (more: Partial<Answer> = {}) => filmOf(one, answer(more));
const seen = (time: number) => Object.fromEntries(sceneAt(film(), time).actors.map((actor) => [actor.id, `${actor.state} ${actor.task ?? ''}`.trim()]));

describe('the film of a simulated run', () => {
  it('counts from the submission, as the timeline', () => {
    expect(film().end).toBe(13);
    expect(film().sendings.map((sent) => sent.at_s)).toEqual([4, 4.5]);
    expect(film().nodes).toEqual(['cloud', 'a', 'b']);
    expect(changesOf(film())).toEqual([1, 4, 5, 6, 7, 8, 9, 10]);
  });

  it('goes on to where the simulation was cut off, if something was under way', () => {
    const world = { ...answer().world!, state: 'OPEN', cut_off: true };
    const [go, pick] = answer().tasks;
    expect(film({ world, tasks: [go!, { id: 'pick', robot: 'b', begin_s: 15 }] }).end).toBe(20);
    expect(film({ world, tasks: [go!, pick!], happenings: [] }).end).toBe(9);
    expect(film({ world, tasks: [go!, pick!], happenings: [{ at_s: 18, kind: 'kill', node: 'b' }] }).end).toBe(11);
  });

  it('lets who has failed stand where he was, and who was cut off be on his way to the end', () => {
    const places = new Map([['dock', { x: 6, y: 0 }]]);
    const at = (task: Answer['tasks'][number], time: number, isCalm = false) => pointAt(film({ tasks: [task] }), 'a', { x: 0, y: 0 }, places, time, isCalm).x;
    const failed = { id: 'go', robot: 'a', begin_s: 11, failed_s: 15 };
    expect([2, 4.9, 5, 9].map((time) => at(failed, time))).toEqual([0, 0, 0, 0]);
    const open = { id: 'go', robot: 'a', begin_s: 11 };
    expect([1, 10.5, 20].map((time) => at(open, time))).toEqual([0, 3, 6]);
    expect([10.5, 20].map((time) => at(open, time, true))).toEqual([0, 0]);
  });

  it('ends an attempt of the paper when the next one begins: when it failed is not known', () => {
    const { world: _, ...paper } = answer({ tasks: [{ id: 'pick', robot: 'b', begin_s: 15 }, { id: 'pick', robot: 'a', begin_s: 18, end_s: 20 }], happenings: [] });
    const of = filmOf(one, paper);
    const at = (time: number) => sceneAt(of, time).actors.map((actor) => actor.task);
    expect([at(16), at(19), at(21)]).toEqual([[null, null, 'pick'], [null, 'pick', null], [null, null, null]]);
  });

  it('has the tasks of all runs at the same time, each with its run, and where they lead to', () => {
    const both = { ...one, job: { ...one.job, beside: [{ scenario: { tasks: [{ id: 'go', data: { place: 'shelf' } }] } }] } } as unknown as Simulation;
    const [tasks, beside] = [[{ id: 'go', robot: 'a', begin_s: 11, end_s: 14 }], [{ id: 'go', robot: 'a', begin_s: 14, end_s: 17 }]];
    const of = filmOf(both, answer({ tasks, happenings: [], beside: [{ state: 'FINISHED', submitted_s: 10, tasks: beside }] as unknown as NonNullable<Answer['beside']> }));
    expect(of.tasks).toEqual(['1: go', '1: pick', '2: go']);
    expect([...of.goals]).toEqual([['1: go', 'dock'], ['2: go', 'shelf']]);
    expect([2, 5].map((time) => sceneAt(of, time).actors.find((actor) => actor.id === 'a')!.task)).toEqual(['1: go', '2: go']);
  });

  it('shows who works on what, and who is broken', () => {
    expect(seen(0)).toEqual({ cloud: 'ready', a: 'ready', b: 'ready' });
    expect(seen(2)).toEqual({ cloud: 'ready', a: 'atWork go', b: 'ready' });
    expect(seen(5.5)).toEqual({ cloud: 'ready', a: 'ready', b: 'atWork pick' });
    expect(seen(9)).toEqual({ cloud: 'ready', a: 'atWork pick', b: 'failed' });
  });

  it('lets tasks move through their states', () => {
    const stages = (time: number) => [...sceneAt(film(), time).stages.values()];
    expect(stages(0)).toEqual(['WAITING', 'WAITING']);
    expect(stages(2)).toEqual(['RUNNING', 'WAITING']);
    expect(stages(6)).toEqual(['FINISHED', 'FAILED']);
    expect(stages(9)).toEqual(['FINISHED', 'RUNNING']);
    expect(stages(13)).toEqual(['FINISHED', 'FINISHED']);
  });

  it('lets a baton fly, and shows where nothing arrives until it is healed', () => {
    expect(sceneAt(film(), 4.3).flights).toEqual([{ from: 'a', to: 'b', phase: 'forward', part: expect.closeTo(0.5) }]);
    expect(sceneAt(film(), 3.9).flights).toEqual([]);
    expect(sceneAt(film(), 8).cuts).toEqual([['a', 'b']]);
    expect(sceneAt(film(), 9).cuts).toEqual([]);
    expect(sceneAt(film({ happenings: [{ at_s: 0, kind: 'partition', nodes: ['a', 'cloud'] }] }), 1).cuts).toEqual([['a', 'b'], ['b', 'cloud']]);
    expect(sceneAt(film({ happenings: [{ at_s: 0, kind: 'kill', node: 'cloud' }] }), 1).actors[0]!.state).toBe('offline');
  });

  it('has every node of a fleet without names, and where they stand', () => {
    const counted = filmOf({ robots: 3, tasks: 2, job: {} } as unknown as Simulation, answer({ tasks: [], sendings: [], happenings: [] }));
    expect(counted.nodes).toEqual(['cloud', 'r0', 'r1', 'r2']);
    expect(counted.tasks).toEqual(['t0', 't1']);
    const box = { west: 0, south: 0, east: 10, north: 10 };
    const stands = standsOf(counted.nodes, new Map([['r1', { x: 1, y: 2 }]]), box);
    expect(stands.get('r1')).toEqual({ x: 1, y: 2 });
    for (const { x, y } of stands.values()) expect(x >= 0 && x <= 10 && y >= 0 && y <= 10).toBe(true);
    expect(new Set([...stands.values()].map(({ x, y }) => `${x} ${y}`)).size).toBe(4);
  });

  it('lets a robot drive to the place of its task, or be there at its end', () => {
    const places = new Map([['dock', { x: 6, y: 0 }]]);
    const at = (time: number, isCalm = false) => pointAt(film(), 'a', { x: 0, y: 0 }, places, time, isCalm).x;
    expect([at(0), at(2.5), at(4), at(12)]).toEqual([0, 3, 6, 6]);
    expect([at(2.5, true), at(4, true)]).toEqual([0, 6]);
  });
});
