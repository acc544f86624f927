import { describe, expect, it } from 'vitest';
import { newFault } from './fault_wish';
import { newLink } from './link_wish';
import { faultCount, FIRST, jobOf, jobOfScenario, jobOfTry, mostFaults, wishOf, within, type Job, type Wish } from './plan_job';
import { newSensor } from './sensor_wish';

const wish = (more: Partial<Wish>): Wish => ({ ...FIRST, ...more });

describe('a wish as a job', () => {
  it('has the keys of its protocol alone', () => {
    expect(jobOf(FIRST)).toEqual({ protocol: 'talkrobots', robots: 5, tasks: 9, task_seconds: 3, link: 'wifi', seed: 1, faults: [] });
    expect(jobOf(wish({ protocol: 'paper', sensors: 1, interpreted: 5, faults: 2 }))).toEqual(
      { protocol: 'paper', robots: 5, tasks: 9, task_seconds: 3, interpreted: 5, sensors: 1, rate: 1, faulty: 2 });
  });

  it('lets robots break in the middle of their first task', () => {
    expect(jobOf(wish({ faults: 2 })).faults).toEqual([{ at: 4.5, kind: 'fail', node: 'r1' }, { at: 7.5, kind: 'fail', node: 'r2' }]);
  });

  it('lets who was cut off or killed come back', () => {
    expect(jobOf(wish({ faults: 1, faultKind: 'cut' })).faults!.map((one) => [one.kind, one.at])).toEqual([['cut', 4.5], ['heal', 14.5]]);
    expect(jobOf(wish({ faults: 1, faultKind: 'kill' })).faults!.map((one) => one.kind)).toEqual(['kill', 'start']);
  });

  it('keeps within what may be asked for', () => {
    expect(within(wish({ robots: 900, tasks: 900, faults: 60 }))).toMatchObject({ robots: 40, tasks: 200, faults: 39 });
    expect(within(wish({ protocol: 'paper', robots: 900, tasks: 3, faults: 60 }))).toMatchObject({ robots: 900, tasks: 3, faults: 3 });
    expect(within(wish({ seed: NaN })).seed).toBe(1);
    expect(within(wish({ seed: -4 })).seed).toBe(0);
    expect(within(wish({ robots: 2, interpreted: 5 })).interpreted).toBe(2);
    expect(mostFaults(wish({ robots: 1 }))).toBe(0);
  });

  it('never has more faults than the gateway takes', () => {
    expect(jobOf(wish({ robots: 40, faults: 39, faultKind: 'kill' })).faults!.length).toBeLessThanOrEqual(100);
  });

  it('counts the robots that something happens to', () => {
    expect(faultCount(jobOf(wish({ faults: 3, faultKind: 'kill' })))).toBe(3);
    expect(faultCount(jobOf(wish({ protocol: 'paper', faults: 2 })))).toBe(2);
    expect(faultCount({ robots: 1, tasks: 1 })).toBe(0);
  });

  it('has more that goes wrong behind what the slider says, a network and relays', () => {
    const job = jobOf(wish({ faults: 1, more: [{ ...newFault('r0'), kind: 'battery', numbers: { percent: '9', per_second: '1' } }], link: newLink('own'), relays: ['cloud'] }));
    expect(job.faults).toEqual([{ at: 4.5, kind: 'fail', node: 'r1' }, { kind: 'battery', node: 'r0', percent: 9, per_second: 1 }]);
    expect(job.link).toEqual({ delay_s: 0.02, deviation_s: 0.005 });
    expect(job.relays).toEqual(['cloud']);
    expect(faultCount(job)).toBe(2);
  });

  it('comes back from a job, to be simulated again', () => {
    for (const one of [wish({ robots: 7, seed: 3, link: newLink('own'), relays: ['r1'], more: [newFault('r2')] }), wish({ protocol: 'paper', sensors: 2, faults: 1 })]) {
      expect(jobOf(wishOf(jobOf(one)))).toEqual(jobOf(one));
    }
  });

  it('plays a scenario with faults, sensors and the times of before', () => {
    const scenario = { name: 'n', tasks: [{ id: 'go', robot: 'a', skill: 's' }] };
    const told = { ...newSensor('a'), name: 'load', texts: { ...newSensor('a').texts, value: '3' } };
    expect(jobOfTry(scenario, wish({ faults: 2, more: [newFault('a')], sensorValues: [told] }), { s: 2 })).toEqual({
      protocol: 'talkrobots', scenario, task_seconds: 3, link: 'wifi', seed: 1, faults: [{ at: 5, kind: 'fail', node: 'a' }],
      sensor_values: [{ node: 'a', name: 'load', value: 3 }], times: { s: 2 },
    });
  });

  it('plays other scenarios at the same time, and they come back from the job', () => {
    const scenario = { name: 'n', tasks: [{ id: 'go', robot: 'a', skill: 's' }] };
    const other = { ...scenario, name: 'other' };
    const job = jobOfTry(scenario, wish({ beside: [{ id: '1', scenario: other, after: '20' }, { id: '2', scenario, after: '' }] }), undefined);
    expect(job.beside).toEqual([{ scenario: other, after: 20 }, { scenario }]);
    expect(jobOfTry(scenario, wishOf(job as unknown as Job), undefined).beside).toEqual(job.beside);
    expect(jobOfTry(scenario, FIRST, undefined)).not.toHaveProperty('beside');
  });

  it('takes a scenario as it is drawn, without a number of robots or tasks', () => {
    const scenario = { name: 'n', tasks: [{ id: 'go', robot: 'a', skill: 's' }] };
    expect(jobOfScenario(scenario)).toEqual({ protocol: 'talkrobots', scenario, link: 'wifi', seed: 1 });
  });
});
