/** Which open alarms are new to this page. Those that were there when it was opened are not: people see them. */
import type { Alert, AlertRow } from '../api/types';

export class NewAlarms {
  private seen: Set<string> | null = null;

  /** `isKnown`: the list has been received. What chatters is seen and not told: it is not new either once it is quiet. */
  see(open: AlertRow[], isKnown: boolean): Alert[] {
    if (!isKnown) return [];
    const seen = this.seen;
    this.seen = new Set([...(seen ?? []), ...open.map((row) => row.content.id)]);
    if (seen === null) return [];
    return open.filter((row) => !row.alarm.chatters && !seen.has(row.content.id)).map((row) => row.content);
  }
}

/** Higher priority, more and higher tones: two for most, three for what is critical. Hz. */
export function tonesOf(severity: Alert['severity']): number[] {
  if (severity === 'WARNING') return [660];
  return severity === 'URGENT' ? [660, 880] : [880, 660, 880];
}
