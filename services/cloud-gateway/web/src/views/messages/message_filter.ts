/** Which of the messages that pass are shown. */
import type { Schemas } from '../../lib/api/types';

export type Passed = Schemas['PassedMessage'];

export interface Wish {
  node: string;
  type: string;
  phase: string;
  text: string;
}

/** As many as the page keeps; the oldest go. */
export const MOST = 500;

export function fits(message: Passed, wish: Wish): boolean {
  if (wish.node !== '' && message.source !== wish.node && message.target !== wish.node) return false;
  if (wish.type !== '' && message.type !== wish.type) return false;
  if (wish.phase !== '' && message.phase !== wish.phase) return false;
  const wanted = wish.text.trim().toLowerCase();
  return wanted === '' || `${message.subtype} ${message.source} ${message.target}`.toLowerCase().includes(wanted);
}

/** Newest first, each once: what was read and what came live may overlap. */
export function joined(shown: readonly Passed[], more: readonly Passed[]): Passed[] {
  const byNumber = new Map([...shown, ...more].map((message) => [message.number, message]));
  return [...byNumber.values()].sort((a, b) => b.number - a.number).slice(0, MOST);
}

/** The share of each phase, for a bar. */
export function shares(phases: Schemas['PhaseCounts']): { phase: string; count: number; share: number }[] {
  const all = Object.entries(phases) as [string, number][];
  const most = Math.max(1, ...all.map(([, count]) => count));
  return all.map(([phase, count]) => ({ phase, count, share: count / most }));
}
