/** What counts how much: shares that people move, judgments that they make, and where another robot becomes the first. */
import type { Schemas } from '../../lib/api/types';

export type Weight = Schemas['WeighedCriterion'];
export type Flip = Schemas['WeightFlip'];
export type Judgments = [string, string, number][];

/** Over it the judgments contradict each other (Saaty). */
export const MOST_CR = 0.1;

/** Saaty's scale in both directions: from 9 times less to 9 times more. */
export const STEPS: number[] = [...[9, 8, 7, 6, 5, 4, 3, 2].map((n) => 1 / n), 1, 2, 3, 4, 5, 6, 7, 8, 9];

export function stepText(value: number): string {
  return value >= 1 ? String(Math.round(value)) : `1/${Math.round(1 / value)}`;
}

/**
 * One criterion gets this share of all; the others keep their ratio, as a flip point assumes. If all of them counted
 * nothing, they have the ratio that they have in `otherwise`.
 */
export function moved(weights: Weight[], criterion: string, share: number, otherwise: Weight[]): Weight[] {
  const others = (of: Weight[]) => of.filter((one) => one.criterion !== criterion);
  const sumOf = (of: Weight[]) => others(of).reduce((sum, one) => sum + one.weight, 0);
  const from = [weights, otherwise].find((of) => sumOf(of) > 0);
  const count = Math.max(1, weights.length - 1);
  return weights.map((one) => {
    if (one.criterion === criterion) return { criterion, weight: share };
    const part = from ? (from.find((other) => other.criterion === one.criterion)?.weight ?? 0) / sumOf(from) : 1 / count;
    return { criterion: one.criterion, weight: (1 - share) * part };
  });
}

/** Shares of all, of weights that an alert's proposals name. */
export function weightsOf(proposals: Schemas['Proposal'][]): Weight[] {
  const first = proposals[0];
  if (first === undefined) return [];
  const robot = first.parts[0]?.robot;
  return first.parts.filter((part) => part.robot === robot).map(({ criterion, weight }) => ({ criterion, weight }));
}

/** Upper triangle by row: how many times as much a row's criterion counts as a column's. Rounded to Saaty's scale. */
export function judgmentsOf(weights: Weight[]): Judgments {
  return pairsOf(weights.map((one) => one.criterion)).map(([a, b]) => [a, b, nearestStep(weightOf(weights, a), weightOf(weights, b))]);
}

export function judged(judgments: Judgments, a: string, b: string): number {
  if (a === b) return 1;
  const direct = judgments.find((one) => one[0] === a && one[1] === b);
  if (direct) return direct[2];
  const other = judgments.find((one) => one[0] === b && one[1] === a);
  return other ? 1 / other[2] : 1;
}

export function withJudgment(judgments: Judgments, a: string, b: string, times: number): Judgments {
  return judgments.map((one) => (one[0] === a && one[1] === b ? [a, b, times] : one));
}

export interface FlipText {
  criterion: string;
  weight: number;
  winner: string;
  /** Over it another one is first; else below it. */
  isOver: boolean;
}

/** The nearest flip points of each criterion: one on each side of its present weight. */
export function nearestFlips(flips: Flip[], weights: Weight[]): FlipText[] {
  return weights.flatMap(({ criterion, weight }) => {
    const own = flips.filter((flip) => flip.criterion === criterion);
    const below = own.filter((flip) => flip.weight <= weight).sort((a, b) => b.weight - a.weight)[0];
    const over = own.filter((flip) => flip.weight > weight).sort((a, b) => a.weight - b.weight)[0];
    return [
      ...(below ? [{ ...below, isOver: false }] : []),
      ...(over ? [{ ...over, isOver: true }] : []),
    ];
  });
}

/** What a robot's name takes of a slider, as a share of its length. */
const NAME = 0.25;

/**
 * On which side of its tick stands the name of each of the flip points of one criterion; none: there is no room. The names of two points away from each
 * other, but for one that would lie beside the slider.
 */
export function namePlaces(flips: FlipText[]): ('left' | 'right' | 'none')[] {
  const sides = flips.map(({ weight, isOver }) => (isOver ? (weight > 1 - NAME ? 'left' : 'right') : weight < NAME ? 'right' : 'left'));
  const [one, other] = flips;
  if (one === undefined || other === undefined) return sides;
  const near = Math.abs(other.weight - one.weight);
  const room = (sides[0] === 'right' ? NAME : 0) + (sides[1] === 'left' ? NAME : 0);
  if (near >= room) return sides;
  return flips.map(({ isOver }, i) => (isOver === (sides[i] === 'left') ? 'none' : sides[i]!));
}

function pairsOf(names: string[]): [string, string][] {
  return names.flatMap((a, i) => names.slice(i + 1).map((b): [string, string] => [a, b]));
}

function weightOf(weights: Weight[], criterion: string): number {
  return weights.find((one) => one.criterion === criterion)?.weight ?? 0;
}

function nearestStep(a: number, b: number): number {
  if (a <= 0 && b <= 0) return 1;
  if (b <= 0) return 9;
  if (a <= 0) return 1 / 9;
  const far = (step: number) => Math.abs(Math.log(step) - Math.log(a / b));
  return STEPS.reduce((best, step) => (far(step) < far(best) ? step : best), 1);
}
