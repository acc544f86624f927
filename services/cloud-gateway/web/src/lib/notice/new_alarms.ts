/**
 * Which open alarms are new to this page, or worse than it knows them. Those that were there when it was opened are neither:
 * people see them.
 */
import type { Alert, AlertRow } from '../api/types';
import { worst } from '../fleet/robot_state';

const LOWEST = 9;

export class NewAlarms {
  /** By id, the highest priority (the lowest number) that this page has seen it with. */
  private seen: Map<string, number> | null = null;

  /**
   * `isKnown`: the list has been received. What chatters is seen and not told: it is not new either once it is quiet. One
   * that gets worse is told, whatever somebody has seen of it before: it wants to be seen anew.
   */
  see(open: AlertRow[], isKnown: boolean): Alert[] {
    if (!isKnown) return [];
    const isFirst = this.seen === null;
    const seen = (this.seen ??= new Map());
    return open.filter((row) => {
      const { id } = row.content;
      const before = seen.get(id);
      seen.set(id, Math.min(before ?? LOWEST, row.alarm.priority));
      if (isFirst) return false;
      return before === undefined ? !row.alarm.chatters : row.alarm.priority < before;
    }).map((row) => row.content);
  }
}

/** Of what is new, the severity that the tones tell. */
export function loudest(alerts: Alert[]): Alert['severity'] | null {
  return worst(alerts.map((one) => one.severity));
}

/** Higher priority, more and higher tones: two for most, three for what is critical. Hz. */
export function tonesOf(severity: Alert['severity']): number[] {
  if (severity === 'WARNING') return [660];
  return severity === 'URGENT' ? [660, 880] : [880, 660, 880];
}
