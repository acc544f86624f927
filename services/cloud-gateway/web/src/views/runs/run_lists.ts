/** Which runs stand where: under way, or over. The stream keeps those that have ended for a while, the archive for long. */
import type { RunSummary } from '../../lib/api/types';
import { isUnderWay } from '../../lib/fleet/run_state';

export interface RunLists {
  underWay: RunSummary[];
  /** Ended, and still told by the stream: the archive has a run only a minute after its end. */
  ended: RunSummary[];
}

export function listsOf(live: RunSummary[]): RunLists {
  return { underWay: live.filter((run) => isUnderWay(run.state)), ended: live.filter((run) => !isUnderWay(run.state)) };
}

/** Each run once: what the archive has of it is the last word. */
export function allOver(archived: RunSummary[], ended: RunSummary[]): RunSummary[] {
  const kept = new Set(archived.map((run) => run.run));
  return [...archived, ...ended.filter((run) => !kept.has(run.run))];
}

/** It changes when a run ends, and at no other time. */
export function endsOf(ended: RunSummary[]): string {
  return ended.map((run) => run.run).sort().join(' ');
}
