import { describe, expect, it } from 'vitest';
import { barsOf, compareRows, inIntervalsOf, makespanOf, peakOf, phaseRows, seriesOf, timesOf, underWay, waitRows, withoutUpkeep, type Answer } from './plan_result';

const PHASES = ['boot', 'identification', 'devices', 'task', 'forward', 'sensor', 'fail', 'upkeep'] as const;
const count = (messages: number) => ({ messages, bytes: messages * 50, between_computers: { messages: messages / 2, bytes: messages * 25 } });

function answer(more: Partial<Answer> = {}): Answer {
  return {
    seconds: 9.5, messages: 36, bytes: 1800, between_computers: { messages: 18, bytes: 900 },
    phases: Object.fromEntries(PHASES.map((phase, i) => [phase, count(i + 1)])) as Answer['phases'],
    over_time: { interval_s: 1, messages: [9, 0, 0, 20, 0, 0, 7, 0, 0, 0, 0, 0], bytes: [450, 0, 0, 1000, 0, 0, 350, 0, 0, 0, 0, 0] },
    model: { phases: { boot: 16, identification: 15, devices: 2, task: 36, forward: 8, sensor: 0, fail: 2 }, messages: 79 },
    tasks: [{ id: 't0', robot: 'r0', begin_s: 1, end_s: 4 }, { id: 't1', robot: 'r1', begin_s: 4 }, { id: 't1', robot: 'r0', begin_s: 6, end_s: 9 }],
    tasks_not_listed: 0, sendings: [], sendings_not_listed: 0, happenings: [], ...more,
  };
}
const world = { state: 'FINISHED', over_everywhere: true, tasks_done: 2, makespan_s: 8, linked_s: 0.5, submitted_s: 1, events: 5, broken: [] };

describe('the result of a simulation', () => {
  it('has each phase beside its equation; upkeep has none', () => {
    const rows = phaseRows(answer());
    expect(rows.map((one) => one.phase)).toEqual([...PHASES]);
    expect(rows[3]).toEqual({ phase: 'task', messages: 4, bytes: 200, model: 36, betweenMessages: 2, betweenBytes: 100 });
    expect(rows[7]!.model).toBeNull();
    expect(withoutUpkeep(answer(), 'messages')).toBe(28);
  });

  it('is cut where it ended', () => {
    expect(seriesOf(answer(), 'messages')).toHaveLength(10);
    expect(timesOf(3, 2)).toEqual([0, 2, 4]);
    expect(peakOf(seriesOf(answer(), 'messages'), 1)).toEqual({ at: 3, value: 20 });
    expect(peakOf([], 1)).toEqual({ at: 0, value: 0 });
  });

  it('puts a series into longer intervals', () => {
    expect(inIntervalsOf([1, 2, 3, 4, 5], 1, 2)).toEqual([3, 7, 5]);
    expect(inIntervalsOf([1, 2], 2, 1)).toEqual([1, 2]);
    expect(inIntervalsOf([1, 1, 1, 1], 0.1, 0.2)).toEqual([2, 2]);
  });

  it('draws attempts from the submission on; one that was given up lasts until then', () => {
    const tasks = [{ id: 't0', robot: 'r0', begin_s: 1, end_s: 4 }, { id: 't1', robot: 'r1', begin_s: 4, failed_s: 5.5 }, { id: 't1', robot: 'r0', begin_s: 6, end_s: 9 }];
    const bars = barsOf(answer({ world, tasks, happenings: [{ at_s: 8, kind: 'fail', node: 'r1' }] }));
    expect(bars.map((bar) => [bar.task, bar.robot, bar.state, bar.start, bar.end])).toEqual(
      [['t0', 'r0', 'FINISHED', 0, 3], ['t1', 'r1', 'FAILED', 3, 4.5], ['t1', 'r0', 'FINISHED', 5, 8]]);
  });

  it('leaves an attempt open that was under way as all ended, also if its node was killed: the robot works on', () => {
    const open = answer({ world, happenings: [{ at_s: 5, kind: 'kill', node: 'r1' }] });
    expect(barsOf(open)[1]).toMatchObject({ state: 'RUNNING', start: 3, end: null });
    expect([underWay(open), underWay(answer())]).toEqual([1, 0]);
  });

  it('knows of the paper\'s protocol that an attempt failed, not when', () => {
    expect(barsOf(answer())[1]).toMatchObject({ state: 'FAILED', start: 4, end: null });
  });

  it('says how long the tasks took', () => {
    expect(makespanOf(answer())).toBe(8);
    expect(makespanOf(answer({ world }))).toBe(8);
    expect(makespanOf(answer({ world: { ...world, tasks_done: 0, makespan_s: 0 } }))).toBeNull();
    expect(makespanOf(answer({ world: { ...world, state: 'OPEN', tasks_done: 1, makespan_s: 3 } }))).toBeNull();
    expect(makespanOf(answer({ tasks_not_listed: 7 }))).toBe(9.5);
  });

  it('stands beside another one, row by row', () => {
    const rows = compareRows(answer(), answer({ messages: 40 }));
    expect(rows.find((row) => row.what === 'messages')).toEqual({ what: 'messages', isPhase: false, a: 36, b: 40 });
    expect(rows.filter((row) => row.isPhase).map((row) => row.what)).toEqual([...PHASES]);
  });

  it('says what each task of a scenario waited for, in the timeline\'s time', () => {
    const waits = [{ task: 't0', waited_for: '', robot_busy: false, critical: true }, { task: 't1', waited_for: 't0', robot_busy: true, critical: false }];
    const rows = waitRows(answer({ world, waits }));
    const told = { hasFailed: false, isTold: true, failed: null, otherRun: null, more: 0 };
    expect(rows[0]).toEqual({ ...told, task: 't0', robot: 'r0', begin: 0, end: 3, holder: null, busy: null, isCritical: true });
    expect(rows[2]).toEqual({ ...told, task: 't1', robot: 'r0', begin: 5, end: 8, holder: 't0', busy: 'r0', isCritical: false });
    expect(waitRows(answer())).toEqual([]);
    expect(waitRows(answer({ tasks: [], waits: [{ task: 'gone', waited_for: '', robot_busy: false, critical: true }] }))).toEqual([]);
  });

  it('shows attempts that failed or have no end, too: what they waited for is not told', () => {
    const tasks = [
      { id: 't0', robot: 'r1', begin_s: 1, failed_s: 4 }, { id: 't0', robot: 'r2', begin_s: 5, failed_s: 6 }, { id: 't0', robot: 'r0', begin_s: 8, end_s: 11 },
      { id: 't1', robot: 'r0', begin_s: 12 },
    ];
    const waits = [{ task: 't0', waited_for: 't0', robot_busy: false, critical: true, tried_again: true, more_s: 2 }];
    const rows = waitRows(answer({ world, tasks, waits }));
    expect(rows.map((row) => [row.task, row.robot, row.end, row.hasFailed, row.isTold, row.failed])).toEqual([
      ['t0', 'r1', 3, true, false, null], ['t0', 'r2', 5, true, false, null], ['t0', 'r0', 10, false, true, 'r2'], ['t1', 'r0', null, false, false, null]]);
  });

  it('says how long a task waited for what is no task\'s end; a hand-over is none', () => {
    const wait = (task: string, more_s: number) => ({ task, waited_for: '', robot_busy: false, critical: true, tried_again: false, more_s });
    const tasks = [{ id: 't0', robot: 'r0', begin_s: 1, end_s: 4 }, { id: 't1', robot: 'r0', begin_s: 46, end_s: 50 }];
    expect(waitRows(answer({ world, tasks, waits: [wait('t0', 0.012), wait('t1', 42)] })).map((row) => row.more)).toEqual([0, 42]);
  });

  it('counts the attempts that the waits are of: of a task never done its last one that failed, of one done twice both', () => {
    const tasks = [
      { id: 't0', robot: 'r0', begin_s: 1, end_s: 4 }, { id: 't1', robot: 'r1', begin_s: 4, failed_s: 5 }, { id: 't0', robot: 'r2', begin_s: 4.5, end_s: 6 },
      { id: 't1', robot: 'r0', begin_s: 6, failed_s: 8 }, { id: 't2', robot: 'r2', begin_s: 7 },
    ];
    const wait = (task: string, waited_for: string, robot_busy: boolean, critical: boolean) => ({ task, waited_for, robot_busy, critical });
    const twice = answer({ world, tasks, waits: [wait('t0', '', false, true), wait('t0', 't0', false, false), wait('t1', 't0', true, true)] });
    expect(waitRows(twice).map((row) => [row.task, row.robot, row.begin, row.end, row.hasFailed, row.busy, row.isCritical])).toEqual([
      ['t0', 'r0', 0, 3, false, null, true], ['t1', 'r1', 3, 4, true, null, false], ['t0', 'r2', 3.5, 5, false, null, false],
      ['t1', 'r0', 5, 7, true, 'r0', true], ['t2', 'r2', 6, null, false, null, false]]);
    expect(barsOf(twice).map((bar) => bar.isCritical)).toEqual([true, false, false, true, false]);
  });

  it('marks the critical path in the timeline: the attempt that was done', () => {
    const waits = [{ task: 't1', waited_for: '', robot_busy: false, critical: true }];
    expect(barsOf(answer({ world, waits })).map((bar) => bar.isCritical)).toEqual([false, false, true]);
    expect(barsOf(answer({ world })).some((bar) => bar.isCritical)).toBe(false);
  });
});
