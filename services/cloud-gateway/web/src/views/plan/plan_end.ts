/** How a simulated run stands at the end of what was simulated, and what of its plan was not reached. */
import type { JobFault } from './fault_wish';
import type { Job } from './plan_job';
import type { Answer } from './plan_result';

/**
 * | A run that is not over everywhere   | Stand |
 * |-------------------------------------|-------|
 * | has its end at the cloud            | kept  |
 * | has an alert, and nobody decides    | waits |
 * | does not move any more              | still |
 * | else                                | open  |
 */
export type Stand = 'waits' | 'kept' | 'still' | 'open';

/** Nothing: it is over, or none was played. */
export function standOf({ world }: Answer): Stand | null {
  if (world === undefined) return null;
  if (world.finished_at_cloud === true) return 'kept';
  if (world.state !== 'OPEN') return null;
  if ((world.alerts ?? []).length > 0) return 'waits';
  return world.stands_still_s === undefined ? 'open' : 'still';
}

export interface LateFault {
  /** In s since the run's submission. */
  at: number;
  /** Among the job's faults, from 0. */
  place: number;
  /** Nothing: the job that is known has none there. */
  fault: JobFault | null;
}

/** The job's faults whose time did not come. */
export function lateFaults(answer: Answer, job: Job): LateFault[] {
  return (answer.world?.not_reached ?? []).map(({ fault, at }) => ({ at, place: fault, fault: job.faults?.[fault] ?? null }));
}

export interface LateSensor {
  /** In s since the run's submission: the first that it was to tell. */
  at: number;
  /** Among the job's sensors, from 0. */
  place: number;
  /** "temperature, belt"; empty: the job that is known has none there. */
  name: string;
}

/** The job's sensors that were to tell something after the end. */
export function lateSensors(answer: Answer, job: Job): LateSensor[] {
  return (answer.world?.steps_not_reached ?? []).map(({ sensor, at }) => {
    const told = job.sensor_values?.[sensor];
    return { at, place: sensor, name: told === undefined ? '' : `${told.name}, ${told.node}` };
  });
}

/** What was simulated of the run, in s since its submission. */
export function playedOf(answer: Answer): number {
  return answer.seconds - (answer.world?.submitted_s ?? 0);
}
