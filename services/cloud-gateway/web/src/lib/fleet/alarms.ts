/** Open alarms as IEC 62682 wants them: by priority; within one priority the first cause is on top. */
import type { Alert, Severity } from '../api/types';

const PRIORITY: Severity[] = ['FATAL', 'CRITICAL', 'URGENT', 'WARNING'];
const OPEN: Alert['state'][] = ['OPEN', 'EXPIRED', 'RELEASING'];

export function openAlarms(alerts: Alert[]): Alert[] {
  return alerts
    .filter((alert) => OPEN.includes(alert.state))
    .sort((a, b) => PRIORITY.indexOf(a.severity) - PRIORITY.indexOf(b.severity) || a.time - b.time);
}
