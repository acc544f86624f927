/** Who ended a run before its end, and why: a view of a run has no word of it, its signed records have. */
import { Problem } from '../../lib/api/problem';
import type { RunDetail, Schemas } from '../../lib/api/types';

const ASKED = 5;
const AGAIN_MS = 2000;

export interface EndedBy {
  /** The node at which it was ordered. */
  node: string;
  /** With the person's name, if it was ordered on the page. */
  reason: string;
  /** UTC ns. */
  time: number;
}

export function wasEnded(state: RunDetail['state']): boolean {
  return state === 'ABORTING' || state === 'ABORTED';
}

/** The earliest order that ends it; nothing: there is none among them. */
export function endedBy(records: Schemas['ProofRecord'][]): EndedBy | null {
  const orders = records.filter((one) => one.kind === 'run_abort').map(({ content }) => ({
    node: textOf(content.by), reason: textOf(content.reason), time: typeof content.time === 'number' ? content.time : 0,
  }));
  return orders.sort((a, b) => a.time - b.time)[0] ?? null;
}

/** Asks again while the scheduler or the gateway does not answer. Nothing: the records have made room, or are too large to be read. */
export async function readEnder(get: () => Promise<Schemas['ProofRecord'][]>, wait: (ms: number) => Promise<void>): Promise<EndedBy | null> {
  for (let asked = 1; ; ++asked) {
    try {
      return endedBy(await get());
    } catch (problem) {
      const isSilent = problem instanceof Problem && (problem.status === 0 || problem.status >= 500);
      if (!isSilent || asked === ASKED) return null;
      await wait(AGAIN_MS);
    }
  }
}

function textOf(value: unknown): string {
  return typeof value === 'string' ? value : '';
}
