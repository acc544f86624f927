import { expect, it } from 'vitest';
import type { Alert, AlertRow } from '../../lib/api/types';
import { openAlarms } from '../../lib/fleet/alarms';
import { bodyOf, deciderIn, hasCandidates, inOrder, isRanked, isUndecided, lostOf, standsAgain, takersIn, verdictsOf, waitOf, whyWord, winnerOf } from './decision';

const alert = (of: Partial<Alert>): Alert => ({
  id: 'a', severity: 'CRITICAL', time: 1, state: 'OPEN', run: 'r', name: 'paper', robot: 'ridgeback', capability: 'mobile', cause: 'robot_fault',
  text: '', tasks: [], expires: 0, needs_word: false, proposals: [], unfit: [], policy: 'ask', verdict: 'none', epoch: 0, person: '', reason: '',
  waits_for: '', ...of,
});
const decided = alert({
  state: 'RELEASING', verdict: 'override', person: 'ann', reason: 'it is free',
  proposals: [{ robot: 'drone', tasks: [], score: 0, parts: [], note: '', merit: 0 }],
});

it('offers what makes sense', () => {
  expect(verdictsOf(alert({ run: '' }))).toEqual(['retry']);
  expect(verdictsOf(alert({ cause: 'run_ends' }))).toEqual(['abort']);
  expect(verdictsOf(alert({ cause: 'robot_wanted' }))).not.toContain('retry');
  expect(verdictsOf(alert({}))).toEqual(['accept', 'override', 'retry', 'skip', 'abort']);
  expect([alert({}), alert({ state: 'DECIDED' }), alert({ run: '' })].map(isRanked)).toEqual([true, false, false]);
  expect([alert({ state: 'EXPIRED' }), decided].map(isUndecided)).toEqual([true, false]);
});

it('sends no empty member', () => {
  expect(bodyOf({ verdict: 'accept', robot: '', reason: '', stands: false })).toEqual({ verdict: 'accept' });
});

it('repeats a verdict with the word that the robot stands', () => {
  expect(standsAgain(decided)).toEqual({ verdict: 'override', robot: 'drone', reason: 'it is free', stands: true });
  const shared = [{ task: 'go', robot: 'near' }, { task: 'grab', robot: 'full' }, { task: 'put', robot: 'near' }];
  const accepted = standsAgain(alert({ verdict: 'accept', proposals: [{ robot: '', tasks: shared }] as unknown as Alert['proposals'] }))!;
  expect([accepted.robot, accepted.shown, takersIn(shared)]).toEqual(['', shared, 'near + full']);
  expect(bodyOf(accepted)).toEqual({ verdict: 'accept', stands: true, shown: shared });
  expect(standsAgain(alert({}))).toBeNull();
});

it('says what is lost, and nothing where nothing is', () => {
  expect(lostOf(alert({ cause: 'robot_fault', capability: 'mobile' }))).toEqual({ capability: 'mobile', whole: false });
  for (const cause of ['robot_fault', 'robot_connection', 'peer_expired', 'robot_retired']) expect(lostOf(alert({ cause, capability: '' })).whole).toBe(true);
  for (const cause of ['task_overdue', 'double_execution', 'run_ends']) expect(lostOf(alert({ cause, capability: '' })).whole).toBe(false);
});

it('says why a person has to look at the robot, which may be online', () => {
  const of = (waits_for: string) => alert({ needs_word: true, waits_for });
  const asked = "a verdict: trb alert decide 0123abcd (no robot can take over: --retry, --skip or --abort); nobody knows what became of task 't4': --stands if you have seen that ridgeback stands";
  expect(whyWord(of(asked))).toBe("nobody knows what became of task 't4'");
  expect(whyWord(of('a verdict: trb alert decide 0123abcd; ridgeback is silent: --stands if you have seen that ridgeback stands'))).toBe('ridgeback is silent');
  expect(whyWord(of('a verdict on node cloud2'))).toBe('');
  expect(whyWord(of(''))).toBe('');
});

it('says what an alert waits for, but for commands of trb', () => {
  expect(waitOf(alert({ waits_for: 'a verdict on node cloud2' }))).toBe('a verdict on node cloud2');
  expect(waitOf(alert({ waits_for: "a robot that can do task 't6', or a verdict: trb alert decide 0123abcd --skip or --abort" }))).toBe('');
  expect(waitOf(alert({ waits_for: 'a lift to go', state: 'CLOSED' }))).toBe('');
  expect(waitOf({ ...decided, waits_for: "task 't4' runs at ridgeback: its end" })).toBe("task 't4' runs at ridgeback: its end");
});

it('looks for nobody to take over what was done twice, or what no run needs', () => {
  expect(hasCandidates(alert({ run: 'r1', cause: 'robot_fault' }))).toBe(true);
  expect(hasCandidates(alert({ run: 'r1', cause: 'double_execution' }))).toBe(false);
  expect(hasCandidates(alert({ run: '', cause: 'robot_fault' }))).toBe(false);
});

it('names who was first', () => {
  expect(deciderIn("alert b3 was decided by 'ann': accept, go to drone already")).toBe('ann');
  expect(deciderIn('ridgeback is taken as mended')).toBeNull();
  expect([winnerOf(decided, 'bob'), winnerOf(decided, 'ann'), winnerOf(alert({}), 'bob')]).toEqual(['ann', null, null]);
});

it('lists open alerts by priority and first cause, then what is over, the newest first', () => {
  const rows = [
    alert({ id: 'old', state: 'CLOSED', time: 1 }), alert({ id: 'later', time: 9 }), alert({ id: 'new', state: 'DECIDED', time: 8 }),
    alert({ id: 'first', time: 2 }),
  ].map((content) => ({ content, alarm: { priority: 2, source: content.id, first: '', chatters: false, times: 1 } }) as AlertRow);
  expect(inOrder(rows, openAlarms).map((row) => row.content.id)).toEqual(['first', 'later', 'new', 'old']);
});
