import { describe, expect, it } from 'vitest';
import { newBeside } from './beside_wish';
import { newFault } from './fault_wish';
import { newLink } from './link_wish';
import { errorsOf } from './plan_errors';
import { FIRST, type Wish } from './plan_job';

const say = (wrong: { why: string }) => wrong.why;
const wish = (more: Partial<Wish>): Wish => ({ ...FIRST, ...more });
const refused = (pointer: string) => [{ pointer, detail: 'is bad', hint: 'mend it' }];
const NODES = ['cloud', 'r0', 'r1', 'r2', 'r3', 'r4'];

describe('what is wrong with a wish', () => {
  it('stands beside its field', () => {
    expect(errorsOf(FIRST, NODES, [], true, say)).toEqual({ faults: [], link: {}, sensors: [], beside: [], relays: '', rest: [], isGood: true });
    const all = errorsOf(wish({ more: [newFault('r9')], link: { ...newLink('own'), texts: { ...newLink('own').texts, loss: 'x' } }, relays: ['r9'] }), NODES, [], true, say);
    expect(all).toEqual({ faults: [{ node: 'node' }], link: { loss: 'between' }, sensors: [], beside: [], relays: 'node', rest: [], isGood: false });
  });

  it('is of a scenario at the same time, by its own fields', () => {
    const one = wish({ beside: [newBeside(), { ...newBeside(), scenario: { name: 'n', tasks: [] } }] });
    expect(errorsOf(one, NODES, refused('/beside/1/scenario/tasks'), false, say)).toMatchObject({ beside: [{ scenario: 'scenario' }, { scenario: 'is bad; mend it' }], isGood: false });
    expect(errorsOf(one, NODES, refused('/beside/1/after'), false, say).beside[1]).toEqual({ after: 'is bad; mend it' });
    expect(errorsOf(one, NODES, refused('/beside'), false, say).rest).toEqual(['is bad; mend it']);
  });

  it('comes from the gateway, too, whose count has the slider\'s faults first', () => {
    const one = wish({ faults: 2, faultKind: 'kill', more: [newFault('r0')] });
    expect(errorsOf(one, NODES, refused('/faults/4/at'), true, say).faults).toEqual([{ at: 'is bad; mend it' }]);
    expect(errorsOf(one, NODES, refused('/faults/0/at'), false, say).faults).toEqual([{ at: 'is bad; mend it' }]);
    expect(errorsOf(one, NODES, refused('/faults/1/at'), true, say).rest).toEqual(['is bad; mend it']);
    expect(errorsOf(one, NODES, refused('/scenario'), true, say)).toMatchObject({ rest: ['is bad; mend it'], isGood: true });
    expect(errorsOf(one, NODES, [...refused('/scenario'), ...refused('/scenario')], true, say).rest).toHaveLength(1);
    expect(errorsOf(one, NODES, refused('/sensor_values/3/unit'), true, say).rest).toHaveLength(1);
  });
});
