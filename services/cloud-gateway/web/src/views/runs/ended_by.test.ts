import { expect, it } from 'vitest';
import { Problem } from '../../lib/api/problem';
import type { Schemas } from '../../lib/api/types';
import { endedBy, readEnder, wasEnded } from './ended_by';

const record = (kind: string, content: Record<string, unknown>) => ({ kind, content }) as Schemas['ProofRecord'];

it('finds who ended a run, and why: the first order', () => {
  const records = [
    record('run_start', { by: 'cloud' }), record('run_abort', { by: 'ur3', reason: 'task failed', time: 9 }),
    record('run_abort', { by: 'cloud', reason: 'by olga: shift ends', time: 7 }),
  ];
  expect(endedBy(records)).toEqual({ node: 'cloud', reason: 'by olga: shift ends', time: 7 });
});

it('says nothing where there is no order', () => {
  expect(endedBy([record('run_pause', { by: 'cloud' })])).toBeNull();
  expect(endedBy([record('run_abort', {})])).toEqual({ node: '', reason: '', time: 0 });
  expect([wasEnded('ABORTED'), wasEnded('ABORTING'), wasEnded('FINISHED')]).toEqual([true, true, false]);
});

/** Answers in turn; the last one again and again. */
function asked(...answers: (Schemas['ProofRecord'][] | Error)[]) {
  const waits: number[] = [];
  let count = 0;
  const get = () => {
    const answer = answers[Math.min(count++, answers.length - 1)]!;
    return answer instanceof Error ? Promise.reject(answer) : Promise.resolve(answer);
  };
  return { waits, count: () => count, ender: () => readEnder(get, (ms) => Promise.resolve(void waits.push(ms))) };
}

it('asks again who ended it while the scheduler does not answer', async () => {
  const silent = new Problem(503, 'x', 'no answer');
  const later = asked(silent, new Problem(0, 'x', 'the gateway cannot be reached'), [record('run_abort', { by: 'cloud' })]);
  expect((await later.ender())?.node).toBe('cloud');
  expect(later.waits).toEqual([2000, 2000]);
  const never = asked(silent);
  expect(await never.ender()).toBeNull();
  expect(never.count()).toBe(5);
});

it('does not ask again for records that are not there', async () => {
  const gone = asked(new Problem(404, 'x', 'made room'));
  expect(await gone.ender()).toBeNull();
  expect([gone.count(), gone.waits]).toEqual([1, []]);
});
