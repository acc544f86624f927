/** How far the value of a sensor may be believed. */
import type { Live } from '../../lib/api/types';

/** `gone`: the fleet has no such sensor now. `late`, `notHeard` and `refused` are words of the section `state`. */
export type StreamState = 'waits' | 'live' | 'late' | 'notHeard' | 'refused' | 'gone';

const WORST_FIRST = [['not_heard', 'notHeard'], ['refused', 'refused'], ['late', 'late']] as const;

/** `isKnown`: all rows of its topic are here. `sensor`, `reading`: how live the two rows are; nothing: there is none. */
export function streamState(isKnown: boolean, sensor: Live | undefined, reading: Live | undefined): StreamState {
  if (sensor === undefined) return isKnown ? 'gone' : 'waits';
  const worst = WORST_FIRST.find(([live]) => live === sensor || live === reading);
  return worst?.[1] ?? (reading === undefined ? 'waits' : 'live');
}
