/** What a check has found, at the task it belongs to. */
import type { Schemas } from '../../lib/api/types';

export type Fault = Schemas['ScenarioFault'];

export interface Sorted {
  /** By the task's place. */
  byTask: Map<number, Fault[]>;
  /** Of the scenario as a whole. */
  rest: Fault[];
}

export function sortFaults(faults: readonly Fault[]): Sorted {
  const out: Sorted = { byTask: new Map(), rest: [] };
  for (const fault of faults) {
    const place = placeOf(fault.pointer);
    if (place === null) out.rest.push(fault);
    else out.byTask.set(place, [...(out.byTask.get(place) ?? []), fault]);
  }
  return out;
}

/** "/tasks/3/skill" or "/scenario/tasks/3/skill" is of the task at place 3. */
export function placeOf(pointer: string): number | null {
  const found = /^(?:\/scenario)?\/tasks\/(\d+)(?:\/|$)/.exec(pointer);
  return found ? Number(found[1]) : null;
}

/** The key of the task that a fault is about: "skill", "data/place". */
export function keyOf(pointer: string): string {
  return pointer.replace(/^(?:\/scenario)?\/tasks\/\d+\/?/, '');
}
