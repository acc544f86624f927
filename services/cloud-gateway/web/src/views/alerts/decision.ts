/** What a person may decide on an alert, and what became of it. */
import { pageHints } from '../../lib/api/problem';
import type { Alert, AlertRow, Schemas } from '../../lib/api/types';
import { isOpen } from '../../lib/fleet/alarms';

export { isOpen };

export type Decision = Schemas['AlertDecision'];
export type Verdict = Decision['verdict'];

const NOT_RULED = ['double_execution', 'run_ends'];

/** Nobody has decided yet. */
export function isUndecided(alert: Alert): boolean {
  return isOpen(alert) && alert.verdict === 'none';
}

/** The verdicts that make sense; the gateway has the last word. */
export function verdictsOf(alert: Alert): Verdict[] {
  if (alert.run === '') return ['retry']; // no run needs the robot: there is nothing to move or to skip
  if (NOT_RULED.includes(alert.cause)) return ['abort'];
  if (alert.cause === 'robot_wanted') return ['accept', 'override', 'skip', 'abort']; // nothing has failed
  return ['accept', 'override', 'retry', 'skip', 'abort'];
}

const WHOLE_ROBOT = ['peer_expired', 'robot_connection', 'robot_fault', 'robot_retired'];

/** What the robot cannot do any more: a capability, all of it (`whole`), or nothing: some alerts are of no loss. */
export function lostOf(alert: Alert): { capability: string; whole: boolean } {
  return { capability: alert.capability, whole: alert.capability === '' && WHOLE_ROBOT.includes(alert.cause) };
}

/** Why a person has to look whether the robot stands, which may be online; empty: it is not said. */
export function whyWord(alert: Alert): string {
  return /; ([^;]*): --stands if you have seen that /.exec(alert.waits_for)?.[1] ?? '';
}

/** What an open alert waits for; empty: nothing but a decision, which has commands of `trb` there, and buttons here. */
export function waitOf(alert: Alert): string {
  if (!isOpen(alert)) return '';
  if (!isUndecided(alert)) return alert.waits_for;
  return pageHints([alert.waits_for])[0] ?? '';
}

/** Others can take its tasks over; else nobody is looked for, and that there is none would say too much. */
export function hasCandidates(alert: Alert): boolean {
  return alert.run !== '' && !NOT_RULED.includes(alert.cause);
}

/** Its candidates can be ranked. */
export function isRanked(alert: Alert): boolean {
  return isOpen(alert) && verdictsOf(alert).includes('accept');
}

/** The same verdict again, with the word that the failed robot stands. */
export function standsAgain(alert: Alert): Decision | null {
  if (alert.verdict === 'none') return null;
  const out: Decision = { verdict: alert.verdict, robot: chosenRobot(alert), reason: alert.reason, stands: true };
  return alert.verdict === 'accept' ? { ...out, shown: alert.proposals[0]?.tasks ?? [] } : out;
}

/** Who takes over by the decision; empty: nobody, or several. */
export function chosenRobot(alert: Alert): string {
  return alert.verdict === 'accept' || alert.verdict === 'override' ? (alert.proposals[0]?.robot ?? '') : '';
}

/** Who takes over, in words: each robot once. */
export function takersIn(tasks: readonly { robot: string }[]): string {
  return [...new Set(tasks.map((one) => one.robot))].join(' + ');
}

/** Only what the gateway needs: no empty member. */
export function bodyOf(decision: Decision): Decision {
  const out: Decision = { verdict: decision.verdict };
  if (decision.robot) out.robot = decision.robot;
  if (decision.reason) out.reason = decision.reason;
  if (decision.stands) out.stands = true;
  if (decision.shown?.length) out.shown = decision.shown;
  return out;
}

/** Somebody else was first: who. */
export function winnerOf(alert: Alert, me: string): string | null {
  return alert.verdict !== 'none' && alert.person !== me ? alert.person : null;
}

/** Whose decision an answer tells of: the same verdict of another person is answered like one's own. */
export function deciderIn(text: string): string | null {
  return /was decided by '([^']+)'/.exec(text)?.[1] ?? null;
}

/** What matters first: open ones by priority and first cause, then what is over, newest first. */
export function inOrder(rows: AlertRow[], openFirst: (rows: AlertRow[]) => AlertRow[]): AlertRow[] {
  const open = openFirst(rows).map((row) => row.content.id);
  const place = (row: AlertRow) => (open.includes(row.content.id) ? open.indexOf(row.content.id) : open.length);
  return [...rows].sort((a, b) => place(a) - place(b) || b.content.time - a.content.time);
}
