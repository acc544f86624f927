/**
 * Alarms as IEC 62682 wants them: by priority; what follows from a first cause stands below it; what is shelved stands apart;
 * what chatters is one line.
 */
import type { Alert, AlertRow } from '../api/types';

const OPEN: Alert['state'][] = ['OPEN', 'EXPIRED', 'RELEASING'];

export function isOpen(alert: Alert): boolean {
  return OPEN.includes(alert.state);
}

export function isShelved(row: AlertRow): boolean {
  return row.alarm.shelved !== undefined && isOpen(row.content);
}

/** The alarm at the beginning of those that this one follows from. */
function rootOf(row: AlertRow, byId: Map<string, AlertRow>): AlertRow {
  const seen = new Set<string>();
  for (let at = row; ; ) {
    const before = byId.get(at.alarm.first);
    if (before === undefined || seen.has(at.content.id)) return at;
    seen.add(at.content.id);
    at = before;
  }
}

/** Open, not shelved: a group for each first cause, by the highest priority in it; the first cause on top of its group. */
export function openAlarms(rows: AlertRow[]): AlertRow[] {
  const open = rows.filter((row) => isOpen(row.content) && !isShelved(row));
  const byId = new Map(open.map((row) => [row.content.id, row]));
  const root = new Map(open.map((row) => [row, rootOf(row, byId)]));
  const priority = new Map<AlertRow, number>();
  for (const [row, first] of root) priority.set(first, Math.min(priority.get(first) ?? 9, row.alarm.priority));
  const key = (row: AlertRow): [number, number, string, number, number, number] => {
    const first = root.get(row)!;
    return [priority.get(first)!, first.content.time, first.content.id, row === first ? 0 : 1, row.alarm.priority, row.content.time];
  };
  return open.sort((a, b) => compare(key(a), key(b)));
}

function compare(a: (number | string)[], b: (number | string)[]): number {
  const i = a.findIndex((one, at) => one !== b[at]);
  return i < 0 ? 0 : a[i]! < b[i]! ? -1 : 1;
}

/** Those that nobody has seen come before those that somebody has: the one that calls. */
export function calling(open: AlertRow[]): AlertRow | undefined {
  return open.find((row) => row.alarm.acknowledged === undefined) ?? open[0];
}

/** Of a source that chatters, the last time stands for all. */
export function withoutRepeats(rows: AlertRow[]): AlertRow[] {
  const last = new Map<string, AlertRow>();
  for (const row of rows.filter((one) => one.alarm.chatters)) {
    const known = last.get(row.alarm.source);
    if (known === undefined || known.content.time < row.content.time) last.set(row.alarm.source, row);
  }
  return rows.filter((row) => !row.alarm.chatters || last.get(row.alarm.source) === row);
}
