/** What a person orders of a run or of one of its tasks. */
import { api, newKey } from '../../lib/api/client';
import { pageHints } from '../../lib/api/problem';
import type { RunOrder, TaskOrder } from '../../lib/fleet/run_state';
import { t, tOr } from '../../lib/i18n/i18n.svelte';
import { toasts } from '../../lib/toasts.svelte';

export async function orderRun(run: string, what: RunOrder, reason: string): Promise<void> {
  await send(`/api/v1/runs/{run}/${what}`, { run }, reason === '' ? {} : { reason }, tOr('runs', what));
}

export async function orderTask(run: string, task: string, what: TaskOrder, body: Record<string, unknown>): Promise<void> {
  await send(`/api/v1/runs/{run}/tasks/{task}/${what}`, { run, task }, body, `${task}: ${tOr('runs', what)}`);
}

async function send(route: string, path: Record<string, string>, body: unknown, what: string): Promise<void> {
  const busy = toasts.busy(t('runs.sent', { what }));
  try {
    await api.post(route, { path, body, idempotencyKey: newKey() });
    toasts.done(t('runs.taken', { what }));
  } catch (problem) {
    toasts.problem(problem, { of: what, hintsOf: pageHints });
  } finally {
    toasts.close(busy);
  }
}
