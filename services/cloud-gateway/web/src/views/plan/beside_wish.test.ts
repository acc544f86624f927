import { describe, expect, it } from 'vitest';
import { besideOf, besideWishOf, newBeside, placeOfBeside, wrongsOfBeside } from './beside_wish';

const scenario = { name: 'second', tasks: [{ id: 'go', robot: 'a', skill: 's' }] };

describe('a scenario at the same time', () => {
  it('is started at once, or so many seconds later', () => {
    expect(besideOf({ ...newBeside(), scenario })).toEqual({ scenario });
    expect(besideOf({ ...newBeside(), scenario, after: '2,5' })).toEqual({ scenario, after: 2.5 });
  });

  it('comes back from a job as it was', () => {
    for (const job of [besideOf({ ...newBeside(), scenario }), besideOf({ ...newBeside(), scenario, after: '20' })]) expect(besideOf(besideWishOf(job))).toEqual(job);
  });

  it('says by its field what is wrong', () => {
    expect(wrongsOfBeside({ ...newBeside(), scenario, after: '604800' })).toEqual({});
    expect(wrongsOfBeside({ ...newBeside(), after: '-1' })).toEqual({ scenario: { why: 'scenario' }, after: { why: 'between', min: 0, max: 604_800 } });
    expect(placeOfBeside('/beside/2/after')).toEqual({ wish: 2, field: 'after' });
    expect(placeOfBeside('/beside/0/scenario/tasks/1/robot')).toEqual({ wish: 0, field: 'scenario' });
    expect([placeOfBeside('/beside'), placeOfBeside('/faults/0')]).toEqual([null, null]);
  });
});
