import { expect, it } from 'vitest';
import type { Alert } from '../../lib/api/types';
import { candidatesOf, choiceOf, chosenOf, ranked, whoOf, type Proposal } from './candidates';

function proposal(robot: string, contributions: number[], tasks: [string, string][] = [['go', robot]]): Proposal {
  return {
    robot, score: contributions.reduce((a, b) => a + b, 0), merit: 1, note: '',
    tasks: tasks.map(([task, by]) => ({ task, robot: by })),
    parts: contributions.map((contribution, i) => ({ criterion: ['battery', 'distance'][i]!, value: 1, unit: '%', weight: 0.5, contribution, robot })),
  };
}

const near = proposal('near', [0.1, 0.4]);
const full = proposal('full', [0.2, 0.1]);
const shared = proposal('', [0.2], [['go', 'near'], ['grab', 'full']]);

it('draws all bars to one scale, and remembers the places by the weights in force', () => {
  const shown = candidatesOf([full, near], [near, full]);
  expect(shown.map((one) => [one.name, one.placeInForce])).toEqual([['full', 2], ['near', 1]]);
  expect(shown.flatMap((one) => one.bars.map((bar) => bar.length))).toEqual([0.5, 0.25, 0.25, 1]);
  expect(candidatesOf([shared], [])[0]).toMatchObject({ name: 'near + full', placeInForce: null });
});

it('keeps the places of a decided alert by score, and says who was chosen', () => {
  const decided = { verdict: 'accept', proposals: [full, near] } as unknown as Alert; // full was chosen, and put first
  expect(ranked(decided.proposals)).toEqual([near, full]);
  expect(chosenOf(decided)).toBe(full);
  const equal = { ...near, robot: 'abb1' };
  expect(ranked([near, equal])).toEqual([equal, near]);
  const other = { ...proposal('near', []), note: 'override: it is nearer' };
  const overridden = { verdict: 'override', proposals: [other, near, full] } as unknown as Alert;
  expect(ranked(overridden.proposals)).toEqual([near, full, other]);
  expect(chosenOf(overridden)).toBe(other);
  expect(chosenOf({ verdict: 'retry', proposals: [near] } as unknown as Alert)).toBeNull();
});

it('shows no value that nobody has measured', () => {
  const known = (of: Proposal) => candidatesOf([of], [])[0]!.bars.map((bar) => bar.isKnown);
  expect(known(near)).toEqual([true, true]);
  expect(known({ ...near, note: "distance is 30 s old; battery is not known, taken as the others' mean" })).toEqual([false, true]);
  const both: Proposal = { ...shared, parts: [...near.parts, ...full.parts], note: 'near: position is 9 s old; battery is not known; full: distance is not known' };
  expect(known(both)).toEqual([false, true, true, false]);
});

it('accepts who is proposed, overrides with who is not, and takes shared tasks only as the best', () => {
  const alert = { proposals: [near] } as unknown as Alert;
  expect(choiceOf(alert, near)).toEqual({ verdict: 'accept', robot: 'near', shown: [{ task: 'go', robot: 'near' }] });
  expect(choiceOf(alert, full)).toEqual({ verdict: 'override', robot: 'full' });
  expect(choiceOf(alert, shared)).toBeNull();
  expect(choiceOf({ proposals: [shared] } as unknown as Alert, shared)).toEqual({ verdict: 'accept', robot: '', shown: shared.tasks });
});

it('asks for another ranking when others can take over, not when they only change places', () => {
  const alert = (proposals: Proposal[], unfit: Alert['unfit'] = []) => ({ proposals, unfit }) as unknown as Alert;
  expect(whoOf(alert([near, full]))).toBe(whoOf(alert([full, near])));
  expect(whoOf(alert([near], [{ robot: 'full', why: 'it has failed' }]))).not.toBe(whoOf(alert([near, full])));
});
