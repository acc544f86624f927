/** Who could take over, as it is shown: bars by criterion, and what a person would decide by choosing him. */
import type { Alert, Schemas } from '../../lib/api/types';
import { takersIn, type Decision } from './decision';

export type Proposal = Schemas['Proposal'];

export interface Bar {
  key: string;
  criterion: string;
  robot: string;
  value: number;
  unit: string;
  weight: number;
  contribution: number;
  /** It was measured; else the value is 0 or the others' mean, for the sum's sake. */
  isKnown: boolean;
  /** 0 to 1: of the longest bar of all candidates, so that their lengths compare. */
  length: number;
}

export interface Candidate {
  key: string;
  /** Of one robot, or of several that share the tasks. */
  name: string;
  proposal: Proposal;
  bars: Bar[];
  /** His place by the weights in force, from 1; nothing: he is not proposed. */
  placeInForce: number | null;
}

export function keyOf(proposal: Proposal): string {
  return proposal.robot || proposal.tasks.map((one) => `${one.task}=${one.robot}`).join(',');
}

export function candidatesOf(shown: Proposal[], inForce: Proposal[]): Candidate[] {
  const longest = Math.max(...shown.flatMap((one) => one.parts.map((part) => part.contribution)), 1e-9);
  const places = inForce.map(keyOf);
  return shown.map((proposal) => {
    const key = keyOf(proposal);
    const place = places.indexOf(key);
    return {
      key, proposal, name: nameOf(proposal), placeInForce: place < 0 ? null : place + 1,
      bars: proposal.parts.map((part, i) => ({
        ...part, isKnown: isKnown(proposal, part), key: `${part.robot} ${part.criterion} ${i}`, length: Math.max(0, part.contribution) / longest,
      })),
    };
  });
}

/**
 * The proposals by their scores, equal ones by name, as they were ranked. A decision puts the chosen one first: the ranking had not said so. Who was chosen without
 * being proposed has no score, and is last.
 */
export function ranked(proposals: Proposal[]): Proposal[] {
  return [...proposals].sort((a, b) => b.score - a.score || (nameOf(a) < nameOf(b) ? -1 : 1));
}

/** Of a decided alert: which of its proposals the decision took; nothing: none. */
export function chosenOf(alert: Alert): Proposal | null {
  return alert.verdict === 'accept' || alert.verdict === 'override' ? (alert.proposals[0] ?? null) : null;
}

/**
 * Choosing a proposed robot accepts the proposal, as it is shown; one that only other weights bring up is an override.
 */
export function choiceOf(alert: Alert, proposal: Proposal): Decision | null {
  if (proposal.robot !== '') {
    const isProposed = alert.proposals.some((one) => one.robot === proposal.robot);
    return isProposed ? { verdict: 'accept', robot: proposal.robot, shown: proposal.tasks } : { verdict: 'override', robot: proposal.robot };
  }
  // Shared tasks have no robot to name: only the best is accepted without one.
  const best = alert.proposals[0];
  return best !== undefined && keyOf(best) === keyOf(proposal) ? { verdict: 'accept', robot: '', shown: proposal.tasks } : null;
}

/**
 * Who is proposed and who is not fit. If that changes, the ranking that is shown is outdated; values alone change with
 * each answer of a robot, also with those that a ranking has asked for.
 */
export function whoOf(alert: Alert): string {
  return [...alert.proposals.map(keyOf).sort(), '/', ...alert.unfit.map((one) => `${one.robot} ${one.why}`).sort()].join('\n');
}

/** An alert has a number for each value; only its note says that nobody has measured it. Of several robots it names whose. */
function isKnown(proposal: Proposal, part: Schemas['CriterionPart']): boolean {
  const word = `${part.criterion} is not known`;
  let robot = proposal.robot;
  return !proposal.note.split('; ').some((one) => {
    const named = proposal.tasks.find((task) => one.startsWith(`${task.robot}: `));
    if (named !== undefined) robot = named.robot;
    const said = named === undefined ? one : one.slice(named.robot.length + 2);
    return robot === part.robot && (said === word || said.startsWith(`${word},`));
  });
}

function nameOf(proposal: Proposal): string {
  return proposal.robot || takersIn(proposal.tasks);
}
