import { expect, it } from 'vitest';
import type { Alarm, Alert, AlertRow } from '../api/types';
import { calling, isShelved, openAlarms, withoutRepeats } from './alarms';

const PRIORITY = { FATAL: 1, CRITICAL: 2, URGENT: 3, WARNING: 4 };

function alarm(id: string, severity: Alert['severity'], time: number, state: Alert['state'] = 'OPEN', more: Partial<Alarm> = {}): AlertRow {
  const content = { id, severity, time, state } as Alert;
  return { content, alarm: { priority: PRIORITY[severity], source: id, first: '', chatters: false, times: 1, ...more } } as AlertRow;
}
const ids = (rows: AlertRow[]) => rows.map((row) => row.content.id);
const shelved = { by: 'olga', at: '', until: '', reason: 'the wheel is on its way' };

it('puts the highest priority on top, the older one first, and leaves out what is decided', () => {
  const rows = [
    alarm('late', 'CRITICAL', 20), alarm('cause', 'CRITICAL', 10), alarm('low', 'WARNING', 1),
    alarm('decided', 'FATAL', 5, 'DECIDED'), alarm('expired', 'URGENT', 3, 'EXPIRED'),
  ];
  expect(ids(openAlarms(rows))).toEqual(['cause', 'late', 'expired', 'low']);
});

it('puts what follows below its first cause, and the group where its worst belongs', () => {
  const rows = [
    alarm('other', 'CRITICAL', 1), alarm('worse', 'FATAL', 30, 'OPEN', { first: 'cause' }),
    alarm('cause', 'WARNING', 10), alarm('more', 'WARNING', 20, 'OPEN', { first: 'worse' }),
  ];
  expect(ids(openAlarms(rows))).toEqual(['cause', 'worse', 'more', 'other']);
});

it('ends where two name each other', () => {
  const rows = [alarm('a', 'FATAL', 1, 'OPEN', { first: 'b' }), alarm('b', 'FATAL', 2, 'OPEN', { first: 'a' })];
  expect(openAlarms(rows)).toHaveLength(2);
});

it('keeps shelved ones apart, as long as they are open', () => {
  const rows = [alarm('a', 'FATAL', 1, 'OPEN', { shelved }), alarm('b', 'WARNING', 2), alarm('c', 'FATAL', 3, 'CLOSED', { shelved })];
  expect(ids(openAlarms(rows))).toEqual(['b']);
  expect(ids(rows.filter(isShelved))).toEqual(['a']);
});

it('calls for what nobody has seen, and goes on showing what somebody has', () => {
  const seen = alarm('seen', 'FATAL', 1, 'OPEN', { acknowledged: { by: 'olga', at: '' } });
  expect(calling([seen, alarm('new', 'WARNING', 2)])?.content.id).toBe('new');
  expect(calling([seen])?.content.id).toBe('seen');
  expect(calling([])).toBeUndefined();
});

it('shows a source that chatters once', () => {
  const chatters = { chatters: true, times: 3, source: 'ant//robot_fault' };
  const rows = [
    alarm('a', 'URGENT', 1, 'CLOSED', chatters), alarm('b', 'URGENT', 3, 'OPEN', chatters), alarm('c', 'URGENT', 2, 'CLOSED', chatters),
    alarm('d', 'URGENT', 1, 'CLOSED'),
  ];
  expect(ids(withoutRepeats(rows))).toEqual(['b', 'd']);
});
