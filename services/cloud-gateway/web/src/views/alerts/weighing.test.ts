import { expect, it } from 'vitest';
import { judged, judgmentsOf, moved, namePlaces, nearestFlips, STEPS, stepText, weightsOf, withJudgment, type Weight } from './weighing';

const of = (battery: number, distance: number, availability: number): Weight[] => [
  { criterion: 'battery', weight: battery }, { criterion: 'distance', weight: distance }, { criterion: 'availability', weight: availability },
];
const round = (weights: Weight[]) => weights.map((one) => Math.round(one.weight * 100));

it('moves one share, and the others keep their ratio', () => {
  expect(round(moved(of(0.25, 0.5, 0.25), 'distance', 0.8, of(1, 1, 1)))).toEqual([10, 80, 10]);
});

it('finds the old ratio again after one criterion counted alone', () => {
  const inForce = of(0.3, 0.5, 0.2);
  const alone = moved(inForce, 'distance', 1, inForce);
  expect(round(alone)).toEqual([0, 100, 0]);
  expect(round(moved(alone, 'distance', 0.5, inForce))).toEqual([30, 50, 20]);
  expect(round(moved(of(0, 1, 0), 'distance', 0.5, of(0, 1, 0)))).toEqual([25, 50, 25]);
});

it('starts the judgments where the weights are, on the scale from 1/9 to 9', () => {
  expect(judgmentsOf(of(0.3, 0.54, 0.16)).map((one) => stepText(one[2]))).toEqual(['1/2', '2', '3']);
  expect(judgmentsOf(of(1, 0, 0)).map((one) => stepText(one[2]))).toEqual(['9', '9', '1']);
  expect(STEPS.map(stepText)).toContain('1/9');
});

it('implies the other direction of a judgment', () => {
  const judgments = withJudgment(judgmentsOf(of(1, 1, 1)), 'battery', 'distance', 4);
  expect([judged(judgments, 'battery', 'distance'), judged(judgments, 'distance', 'battery'), judged(judgments, 'battery', 'battery')]).toEqual([4, 0.25, 1]);
});

it('names the nearest flip point on each side', () => {
  const flip = (weight: number, winner: string) => ({ criterion: 'distance', weight, winner });
  const found = nearestFlips([flip(0.1, 'abb1'), flip(0.25, 'pioneer1'), flip(0.7, 'turtlebot'), flip(0.9, 'drone')], of(0.3, 0.5, 0.2));
  expect(found.map((one) => [one.winner, one.isOver])).toEqual([['pioneer1', false], ['turtlebot', true]]);
});

it('puts the names of two flip points where neither lies over the other, nor beside the slider', () => {
  const flips = (...weights: [number, boolean][]) => weights.map(([weight, isOver]) => ({ criterion: 'distance', weight, winner: 'r', isOver }));
  expect(namePlaces(flips([0.5, false], [0.6, true]))).toEqual(['left', 'right']);
  expect(namePlaces(flips([0.4, true]))).toEqual(['right']);
  expect(namePlaces(flips([0.1, false]))).toEqual(['right']);
  expect(namePlaces(flips([0.9, true]))).toEqual(['left']);
  expect(namePlaces(flips([0.1, false], [0.2, true]))).toEqual(['none', 'right']);
  expect(namePlaces(flips([0.8, false], [0.9, true]))).toEqual(['left', 'none']);
  expect(namePlaces(flips([0.1, false], [0.9, true]))).toEqual(['right', 'left']);
});

it('reads the weights in force from the best proposal, once if several robots share it', () => {
  const part = (robot: string, criterion: string, weight: number) => ({ criterion, value: 1, unit: '', weight, contribution: 0, robot });
  const shared = { robot: '', tasks: [], score: 1, merit: 1, note: '', parts: [part('a', 'battery', 0.4), part('a', 'distance', 0.6), part('b', 'battery', 0.4)] };
  expect(weightsOf([shared])).toEqual([{ criterion: 'battery', weight: 0.4 }, { criterion: 'distance', weight: 0.6 }]);
  expect(weightsOf([])).toEqual([]);
});
