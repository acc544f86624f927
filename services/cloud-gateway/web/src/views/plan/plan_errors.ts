/** What is wrong with a wish, beside its fields: by what is typed, and by the gateway's word. */
import type { Fault } from '../../lib/api/problem';
import { placeOfBeside, wrongsOfBeside, type BesideField } from './beside_wish';
import { faultsOf, placeOfFault, wrongsOf, type FaultField } from './fault_wish';
import { placeOfLink, wrongsOfLink, type LinkField } from './link_wish';
import type { Wrong } from './numbers';
import { slidFaults, within, type Wish } from './plan_job';
import { placeOfSensor, wrongsOfSensor, type SensorField } from './sensor_wish';

type Why = Wrong | { why: string };

export interface PlanErrors {
  faults: Partial<Record<FaultField, string>>[];
  link: Partial<Record<LinkField, string>>;
  sensors: Partial<Record<SensorField, string>>[];
  beside: Partial<Record<BesideField, string>>[];
  relays: string;
  /** Of no field. */
  rest: string[];
  isGood: boolean;
}

/** `say`: a wrong in words; `hasSlider`: the slider's faults come before the list's in the job. */
export function errorsOf(wish: Wish, nodes: string[], refused: Fault[], hasSlider: boolean, say: (wrong: Why) => string): PlanErrors {
  const said = (wrongs: object): Record<string, string> => Object.fromEntries(Object.entries(wrongs).map(([field, wrong]) => [field, say(wrong as Why)]));
  const out: PlanErrors = {
    faults: wish.more.map((one) => said(wrongsOf(one, nodes))),
    link: said(wrongsOfLink(wish.link)),
    sensors: wish.sensorValues.map((one, i) => said(wrongsOfSensor(one, nodes, wish.sensorValues.slice(0, i)))),
    beside: wish.beside.map((one) => said(wrongsOfBeside(one))),
    relays: wish.relays.every((id) => nodes.includes(id)) ? '' : say({ why: 'node' }),
    rest: [], isGood: true,
  };
  out.isGood = out.relays === '' && [...out.faults, out.link, ...out.sensors, ...out.beside].every((one) => Object.keys(one).length === 0);
  const before = hasSlider ? slidFaults(within(wish)).length : 0;
  for (const fault of refused) place(out, fault, wish, before);
  return out;
}

function place(out: PlanErrors, fault: Fault, wish: Wish, before: number): void {
  const text = fault.hint === '' ? fault.detail : `${fault.detail}; ${fault.hint}`;
  const pointer = fault.pointer.replace(/^\/faults\/(\d+)/, (_, number: string) => `/faults/${Number(number) - before}`);
  const [ofFault, ofLink, ofSensor, ofBeside] = [placeOfFault(pointer, wish.more), placeOfLink(pointer), placeOfSensor(pointer), placeOfBeside(pointer)];
  if (ofFault !== null) out.faults[ofFault.wish]![ofFault.field] ??= text;
  else if (ofLink !== null) out.link[ofLink] ??= text;
  else if (ofSensor !== null && out.sensors[ofSensor.wish]) out.sensors[ofSensor.wish]![ofSensor.field] ??= text;
  else if (ofBeside !== null && out.beside[ofBeside.wish]) out.beside[ofBeside.wish]![ofBeside.field] ??= text;
  else if (pointer.startsWith('/relays')) out.relays ||= text;
  else if (!out.rest.includes(text)) out.rest.push(text);
}

/** So many faults the job has. */
export const countOf = (wish: Wish): number => wish.more.flatMap(faultsOf).length;
