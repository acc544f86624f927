/** Numbers as somebody types them, and what is wrong with them. */
import { numberIn } from '../../lib/scenario/values';

export { numberIn };

export interface Bounds {
  min: number;
  max: number;
  /** It may be left out, without it. */
  isNeeded?: boolean;
  isWhole?: boolean;
}

export type Wrong = { why: 'missing' } | { why: 'between' | 'whole'; min: number; max: number };

export function wrongNumber(text: string | undefined, { min, max, isNeeded = false, isWhole = false }: Bounds): Wrong | null {
  if ((text ?? '').trim() === '') return isNeeded ? { why: 'missing' } : null;
  const value = numberIn(text);
  if (value === undefined || value < min || value > max) return { why: 'between', min, max };
  return isWhole && !Number.isInteger(value) ? { why: 'whole', min, max } : null;
}

/** What a job says, as a field shows it. */
export const textOfNumber = (value: number | undefined): string => (value === undefined ? '' : String(value));

/** Without what is not there. */
export function present<Of extends object>(of: Of): { [Key in keyof Of]: Exclude<Of[Key], undefined> } {
  return Object.fromEntries(Object.entries(of).filter(([, value]) => value !== undefined)) as { [Key in keyof Of]: Exclude<Of[Key], undefined> };
}
