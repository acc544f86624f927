/** What an operator orders of one robot. Each is done once, also if it is sent twice. */
import { api, newKey } from '../../lib/api/client';
import type { RobotOrder } from '../../lib/api/types';
import { t, tOr } from '../../lib/i18n/i18n.svelte';
import { toasts } from '../../lib/toasts.svelte';

export type Order = 'stop' | 'release' | 'repaired' | 'retired' | 'returned';

/** As of the stop for all: whoever has pressed it has to know soon that it does not get through. */
const STOP_MS = 8000;

interface Answer {
  robots?: RobotOrder[];
}

export async function order(robot: string, what: Order, body?: Record<string, string>): Promise<void> {
  const busy = toasts.busy(t('robot.sent', { robot, order: tOr('robot', what) }));
  try {
    const signal = what === 'stop' ? { signal: AbortSignal.timeout(STOP_MS) } : {};
    const ask = { path: { robot }, idempotencyKey: newKey(), ...signal, ...(body ? { body } : {}) };
    const answer = await api.post<Answer | undefined>(`/api/v1/robots/{robot}/${what}`, ask);
    tell(robot, what, answer?.robots?.[0]);
  } catch (problem) {
    if (what === 'stop' && api.isOver(problem)) toasts.fault(t('stop.overOf', { robot }), [], { isKept: true });
    else toasts.problem(problem, { of: robot, isKept: what === 'stop' });
  } finally {
    toasts.close(busy);
  }
}

/** Only what the robot's node has confirmed is told as done. */
function tell(robot: string, what: Order, told: RobotOrder | undefined): void {
  const done = `${robot}: ${tOr('robot', `done_${what}`)}`;
  if (told === undefined || told.state === 'confirmed') toasts.done(told?.text ? `${done} (${told.text})` : done);
  else toasts.fault(t('robot.notConfirmed', { robot, order: tOr('robot', what), state: told.state === 'sent' ? t('stop.sent') : t('stop.unreachable') }), [told.text], { isKept: what === 'stop' });
}
