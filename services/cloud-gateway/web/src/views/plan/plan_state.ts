/** How the states of a simulation look: colour for one that has failed alone, and that is no alarm. */
import { runLooks, taskLooks } from '../../lib/fleet/run_state';
import type { Look } from '../../lib/ui/shapes';
import type { Simulation } from './plan_job';

export const simulationLooks: Record<Simulation['state'], Look> = {
  queued: taskLooks.WAITING,
  running: taskLooks.RUNNING,
  done: taskLooks.FINISHED,
  failed: { ...taskLooks.FAILED, tone: 'warning' },
  cancelled: runLooks.ABORTED,
};
