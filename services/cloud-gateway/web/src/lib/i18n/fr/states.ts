import type { Words } from '../en';

export const states: Pick<Words, 'state' | 'severity' | 'connection' | 'runState' | 'taskState'> = {
  state: {
    atWork: 'au travail',
    ready: 'prêt',
    stopped: 'arrêté',
    retired: 'hors service',
    failed: 'en panne',
    limited: 'limité',
    offline: 'robot hors ligne',
    broken: 'robot non relié',
    late: 'en retard',
    notHeard: 'sans nouvelles',
    refused: 'au-delà de sa limite',
    unknown: 'inconnu',
  },
  severity: {
    WARNING: 'avertissement',
    URGENT: 'urgent',
    CRITICAL: 'critique',
    FATAL: 'fatal',
  },
  connection: {
    ONLINE: 'relié',
    OFFLINE: 'hors ligne',
    CONNECTION_BROKEN: 'non relié',
  },
  runState: {
    RUNNING: 'en cours',
    PAUSED: 'suspendue',
    ABORTING: 'en cours d’arrêt',
    FINISHED: 'terminée',
    ABORTED: 'arrêtée',
    EXPIRED: 'délai dépassé',
  },
  taskState: {
    WAITING: 'attend',
    notBegun: 'non commencée',
    INITIALIZING: 'commence',
    RUNNING: 'en cours',
    PAUSED: 'suspendue',
    RETRIABLE: 'non faite',
    interrupted: 'interrompue',
    FINISHED: 'terminée',
    FAILED: 'échouée',
    SKIPPED: 'omise',
  },
};
