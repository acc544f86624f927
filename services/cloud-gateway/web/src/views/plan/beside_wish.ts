/** Other scenarios at the same time on the same robots, as a person chooses them. */
import type { Schemas } from '../../lib/api/types';
import type { Scenario } from '../../lib/scenario/scenario_model';
import { numberIn, textOfNumber, wrongNumber, type Wrong } from './numbers';

export type JobBeside = Schemas['SimulationBesideJob'];
export type BesideField = 'scenario' | 'after';

export interface BesideWish {
  /** Of the stored scenario; empty: none is chosen yet, or it is that of the job before. */
  id: string;
  /** Nothing: it is not chosen, or not read yet. */
  scenario: Scenario | null;
  /** It is started so long after the first one, s; empty: at once. */
  after: string;
}

export const MOST_BESIDE = 9;
const WEEK = 604_800;

export const newBeside = (): BesideWish => ({ id: '', scenario: null, after: '' });

export type BesideWrongs = Partial<Record<BesideField, Wrong | { why: 'scenario' }>>;

export function wrongsOfBeside(wish: BesideWish): BesideWrongs {
  const after = wrongNumber(wish.after, { min: 0, max: WEEK });
  return { ...(wish.scenario === null ? { scenario: { why: 'scenario' } as const } : {}), ...(after === null ? {} : { after }) };
}

/** Of a wish that is not wrong. */
export function besideOf({ scenario, after }: BesideWish): JobBeside {
  const seconds = numberIn(after);
  return { scenario: scenario as unknown as JobBeside['scenario'], ...(seconds === undefined ? {} : { after: seconds }) };
}

export function besideWishOf({ scenario, after }: JobBeside): BesideWish {
  return { id: '', scenario: scenario as unknown as Scenario, after: textOfNumber(after) };
}

/** Of the gateway's word on /beside/N/FIELD. */
export function placeOfBeside(pointer: string): { wish: number; field: BesideField } | null {
  const found = /^\/beside\/(\d+)(?:\/(\w+))?/.exec(pointer);
  if (found === null) return null;
  return { wish: Number(found[1]), field: found[2] === 'after' ? 'after' : 'scenario' };
}
