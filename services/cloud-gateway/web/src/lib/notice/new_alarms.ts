/** Which open alarms are new to this page. Those that were there when it was opened are not: people see them. */
import type { Alert } from '../api/types';

export class NewAlarms {
  private seen: Set<string> | null = null;

  /** `isKnown`: the list has been received. */
  see(open: Alert[], isKnown: boolean): Alert[] {
    if (!isKnown) return [];
    const seen = this.seen;
    this.seen = new Set([...(seen ?? []), ...open.map((alert) => alert.id)]);
    return seen === null ? [] : open.filter((alert) => !seen.has(alert.id));
  }
}

/** Higher priority, more and higher tones: two for most, three for what is critical. Hz. */
export function tonesOf(severity: Alert['severity']): number[] {
  if (severity === 'WARNING') return [660];
  return severity === 'URGENT' ? [660, 880] : [880, 660, 880];
}
