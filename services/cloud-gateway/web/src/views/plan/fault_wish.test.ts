import { describe, expect, it } from 'vitest';
import { faultsOf, newFault, placeOfFault, wishesOf, wrongsOf, type FaultWish } from './fault_wish';

const NODES = ['cloud', 'r0', 'r1'];
const wish = (more: Partial<FaultWish>): FaultWish => ({ ...newFault('r0'), ...more });

describe('a wished fault', () => {
  it('is a fault of the job, and its end another one', () => {
    expect(faultsOf(wish({ numbers: { at: '5' } }))).toEqual([{ kind: 'fail', node: 'r0', at: 5 }]);
    expect(faultsOf(wish({ kind: 'kill', numbers: { at: '5', lasts: '2,5' } }))).toEqual(
      [{ kind: 'kill', node: 'r0', at: 5 }, { kind: 'start', node: 'r0', at: 7.5 }]);
    expect(faultsOf(wish({ kind: 'cut', other: 'r1', way: 'there', numbers: { lasts: '4' } }))).toEqual(
      [{ kind: 'cut', node: 'r0', other: 'r1', way: 'there' }, { kind: 'heal', node: 'r0', other: 'r1', way: 'there', at: 4 }]);
    expect(faultsOf(wish({ kind: 'partition', nodes: ['r0'], numbers: { at: '1', lasts: '1' } }))).toEqual(
      [{ kind: 'partition', nodes: ['r0'], at: 1 }, { kind: 'heal', nodes: ['r0'], at: 2 }]);
    expect(faultsOf(wish({ kind: 'rate', node: '', numbers: { at: '5', between_s: '60' } }))).toEqual([{ kind: 'rate', between_s: 60 }]);
    expect(faultsOf(wish({ kind: 'clock', is1970: true, numbers: {} }))).toEqual([{ kind: 'clock', node: 'r0', is_1970: true }]);
  });

  it('comes back from a job as it was', () => {
    const all = [
      wish({ kind: 'kill', numbers: { at: '5', lasts: '2.5' } }), wish({ kind: 'cut', other: 'r1', way: 'back', numbers: { at: '1', lasts: '1' } }),
      wish({ kind: 'partition', node: '', nodes: ['r0'], numbers: { at: '1', lasts: '3' } }), wish({ kind: 'battery', numbers: { percent: '20', per_second: '1' } }),
      wish({ kind: 'rate', node: '', numbers: { between_s: '60', repair_s: '5' } }), wish({ kind: 'disk', numbers: { commit_s: '0.5' } }),
    ];
    const jobs = all.flatMap(faultsOf);
    expect(wishesOf(jobs).flatMap(faultsOf)).toEqual(jobs);
    expect(wishesOf(jobs)).toHaveLength(all.length);
  });

  it('says by its field what is wrong', () => {
    expect(wrongsOf(wish({}), NODES)).toEqual({});
    expect(wrongsOf(wish({ numbers: {} }), NODES)).toEqual({ at: { why: 'missing' } });
    expect(wrongsOf(wish({ kind: 'cut', numbers: {} }), NODES)).toEqual({});
    expect(wrongsOf(wish({ node: 'cloud' }), NODES)).toEqual({ node: { why: 'node' } });
    expect(wrongsOf(wish({ kind: 'kill', node: 'r9' }), NODES)).toEqual({ node: { why: 'node' } });
    expect(wrongsOf(wish({ kind: 'cut', other: 'r0' }), NODES)).toEqual({ other: { why: 'same' } });
    expect(wrongsOf(wish({ kind: 'partition', nodes: NODES }), NODES)).toEqual({ nodes: { why: 'side' } });
    expect(wrongsOf(wish({ kind: 'clock' }), NODES)).toEqual({ ahead_s: { why: 'clock' } });
    expect(wrongsOf(wish({ kind: 'clock', numbers: { drift_ppm: '1.5' } }), NODES)).toEqual({ drift_ppm: { why: 'whole', min: -100_000, max: 100_000 } });
    expect(wrongsOf(wish({ kind: 'battery', numbers: { percent: '101' } }), NODES)).toEqual(
      { percent: { why: 'between', min: 0, max: 100 }, per_second: { why: 'missing' } });
    expect(wrongsOf(wish({ kind: 'rate', node: '', numbers: { between_s: '60' } }), NODES)).toEqual({});
  });

  it('is found by the gateway\'s pointer, its end by how long it lasts', () => {
    const all = [wish({ kind: 'kill', numbers: { at: '5', lasts: '2' } }), wish({ kind: 'disk', numbers: { commit_s: '70' } })];
    expect(placeOfFault('/faults/1/at', all)).toEqual({ wish: 0, field: 'lasts' });
    expect(placeOfFault('/faults/2/commit_s', all)).toEqual({ wish: 1, field: 'commit_s' });
    expect(placeOfFault('/faults/0', all)).toEqual({ wish: 0, field: 'node' });
    expect(placeOfFault('/faults/9/at', all)).toBeNull();
    expect(placeOfFault('/link/loss', all)).toBeNull();
  });
});
