import { describe, expect, it } from 'vitest';
import { lateFaults, standOf } from './plan_end';
import { compareRows, makespanOf, phaseRows, waitRows, type Answer } from './plan_result';
import { allBars, runsOf, taskOfRun } from './plan_runs';

const wait = { waited_for: '', robot_busy: false, critical: false };
/** Of two runs with a task "go" each, which one robot does; the first one is submitted at 10 s. */
function answer(more: Partial<Answer> = {}): Answer {
  return {
    seconds: 90, messages: 9, bytes: 90, between_computers: { messages: 4, bytes: 40 }, over_time: { interval_s: 1, messages: [], bytes: [] },
    phases: {} as Answer['phases'],
    world: { scenario: 'one', state: 'FINISHED', over_everywhere: true, tasks_done: 1, makespan_s: 3, linked_s: 0.5, submitted_s: 10, events: 5, broken: [], not_reached: [{ fault: 0, at: 99 }] },
    tasks: [{ id: 'go', robot: 'a', begin_s: 11, end_s: 14 }], tasks_not_listed: 0, waits: [{ ...wait, task: 'go' }], alone_s: 3,
    sendings: [], sendings_not_listed: 0, happenings: [],
    beside: [{
      scenario: 'two', after_s: 0.5, state: 'FINISHED', over_everywhere: true, tasks_done: 1, makespan_s: 4, alone_s: 4, submitted_s: 10.5, broken: [],
      tasks: [{ id: 'go', robot: 'a', begin_s: 14, end_s: 18 }], tasks_not_listed: 0,
      waits: [{ ...wait, task: 'go', waited_for: 'go', robot_busy: true, waited_for_run: 0, kept_s: 3 }],
    }],
    ...more,
  };
}

describe('runs at the same time', () => {
  it('are told each, with what it took alone and how long others kept its robots', () => {
    const told = runsOf(answer()).map(({ answer: _, ...run }) => run);
    expect(told).toEqual([
      { number: 1, name: 'one', submitted: 0, makespan: 3, alone: 3, kept: { seconds: 0, tasks: 0 } },
      { number: 2, name: 'two', submitted: 0.5, makespan: 4, alone: 4, kept: { seconds: 3, tasks: 1 } },
    ]);
    const { beside: _, ...single } = answer();
    expect(runsOf(single)).toEqual([]);
  });

  it('have no makespan before they are finished, and none was submitted behind the end', () => {
    const [other] = answer().beside!;
    const late = answer({ beside: [{ ...other!, state: 'OPEN', submitted_s: 0, alone_s: null, cut_off: true, at_work: 0 }] });
    expect(runsOf(late)[1]).toMatchObject({ submitted: null, makespan: null, alone: null });
    expect(runsOf(late).map((run) => standOf(run.answer))).toEqual([null, 'open']);
    expect([makespanOf(answer()), makespanOf(late)]).toEqual([7, null]);
  });

  it('keep what is of all runs with the first one', () => {
    expect(runsOf(answer()).map((run) => lateFaults(run.answer, {}).length)).toEqual([1, 0]);
    expect(runsOf(answer()).every((run) => runsOf(run.answer).length === 0)).toBe(true);
  });

  it('count their times from the first one\'s submission, and name the run that kept a robot', () => {
    const [first, second] = runsOf(answer()).map((run) => waitRows(run.answer)[0]!);
    expect([first!.begin, first!.otherRun, second!.begin, second!.otherRun, second!.holder]).toEqual([1, null, 4, 1, 'go']);
  });

  it('stand in one timeline, each task with its run', () => {
    expect(allBars(answer()).map((bar) => [bar.task, bar.start, bar.end])).toEqual([[taskOfRun(1, 'go'), 1, 4], [taskOfRun(2, 'go'), 4, 8]]);
  });

  it('have no equations beside them', () => {
    const phases = { task: { messages: 2, bytes: 3, between_computers: { messages: 1, bytes: 1 } } } as unknown as Answer['phases'];
    expect(phaseRows(answer({ phases }))[0]!.model).toBeNull();
    expect(compareRows(answer(), answer()).find((row) => row.what === 'equation12')).toMatchObject({ a: null, b: null });
  });
});
