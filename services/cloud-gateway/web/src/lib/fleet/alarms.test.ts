import { expect, it } from 'vitest';
import type { Alert } from '../api/types';
import { openAlarms } from './alarms';

function alert(id: string, severity: Alert['severity'], time: number, state: Alert['state'] = 'OPEN'): Alert {
  return {
    id, severity, time, state, run: '', name: '', robot: 'ur3', capability: '', cause: 'robot_fault', text: '', tasks: [],
    expires: 0, needs_word: false, proposals: [], unfit: [], policy: 'ask', verdict: 'none', epoch: 0, person: '', reason: '', waits_for: '',
  };
}

it('puts the first cause of the highest priority on top, and leaves out what is decided', () => {
  const alerts = [
    alert('late', 'CRITICAL', 20), alert('cause', 'CRITICAL', 10), alert('low', 'WARNING', 1),
    alert('decided', 'FATAL', 5, 'DECIDED'), alert('expired', 'URGENT', 3, 'EXPIRED'),
  ];
  expect(openAlarms(alerts).map((one) => one.id)).toEqual(['cause', 'late', 'expired', 'low']);
});
