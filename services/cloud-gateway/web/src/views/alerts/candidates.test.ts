import { expect, it } from 'vitest';
import type { Alert } from '../../lib/api/types';
import { candidatesOf, choiceOf, whoOf, type Proposal } from './candidates';

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
