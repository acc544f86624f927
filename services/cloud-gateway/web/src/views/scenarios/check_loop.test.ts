import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { Problem, silence } from '../../lib/api/problem';
import type { Scenario } from '../../lib/scenario/scenario_model';
import { CheckLoop, type Checked } from './check_loop';

const GOOD: Checked = { good: true, faults: [], without_spare: [] };
const scenario = (name: string): Scenario => ({ name, tasks: [] });

let asked: string[];
let shown: [Checked | undefined, string][];
let answers: (() => Promise<Checked>)[];
let loop: CheckLoop;

beforeEach(() => {
  vi.useFakeTimers();
  asked = [];
  shown = [];
  answers = [];
  loop = new CheckLoop(
    (one) => (asked.push(one.name), (answers.shift() ?? (() => Promise.resolve(GOOD)))()),
    (check, why) => shown.push([check, why]),
  );
});
afterEach(() => void vi.useRealTimers());

const fails = (problem: Problem) => () => Promise.reject(problem);

it('asks once for what was drawn in one go', async () => {
  loop.want(scenario('a'));
  await vi.advanceTimersByTimeAsync(300);
  loop.want(scenario('b'));
  await vi.advanceTimersByTimeAsync(10_000);
  expect(asked).toEqual(['b']);
  expect(shown).toEqual([[GOOD, '']]);
});

it('asks again after a failure, which it shows, until there is an answer', async () => {
  answers = [fails(silence('unreachable', 'the gateway cannot be reached')), fails(new Problem(503, 'no_answer', 'no answer')), () => Promise.resolve(GOOD)];
  loop.want(scenario('a'));
  await vi.advanceTimersByTimeAsync(10_000);
  expect(asked).toEqual(['a', 'a', 'a']);
  expect(shown).toEqual([[undefined, 'the gateway cannot be reached'], [undefined, 'no answer'], [GOOD, '']]);
});

it('shows the faults of a refusal, which would be refused again', async () => {
  const fault = { pointer: '/tasks/0', detail: 'no', hint: '' };
  answers = [fails(new Problem(422, 'faults', 'one', [fault])), fails(new Problem(403, 'forbidden', 'not you'))];
  loop.want(scenario('a'));
  await vi.advanceTimersByTimeAsync(10_000);
  loop.want(scenario('b'));
  await vi.advanceTimersByTimeAsync(10_000);
  expect(asked).toEqual(['a', 'b']);
  expect(shown).toEqual([
    [{ good: false, faults: [{ ...fault, warning: false }], without_spare: [] }, ''],
    [undefined, 'not you'],
  ]);
});

it('asks for the same again when robots come and go, however often they do', async () => {
  const same = scenario('a');
  for (let i = 0; i < 30; i++) {
    loop.want(same);
    await vi.advanceTimersByTimeAsync(100);
  }
  expect(asked.length).toBeGreaterThan(4);
  expect(asked.length).toBeLessThan(9);
});

it('shows nothing of what it was stopped for', async () => {
  let answer = (_: Checked) => {};
  answers = [() => new Promise((done) => (answer = done))];
  loop.want(scenario('a'));
  await vi.advanceTimersByTimeAsync(500);
  loop.stop();
  answer(GOOD);
  await vi.advanceTimersByTimeAsync(10_000);
  expect([asked, shown]).toEqual([['a'], []]);
});
