/** What an alert says of its cause, wherever it is shown. */
import type { Alert } from '../api/types';
import { localTimes, tOr } from '../i18n/i18n.svelte';

export function alertText(alert: Alert): string {
  return localTimes(alert.text) || tOr('alertCause', alert.cause);
}
