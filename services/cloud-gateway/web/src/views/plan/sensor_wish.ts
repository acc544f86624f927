/** What the sensors tell that a scenario's conditions wait for. */
import type { Schemas } from '../../lib/api/types';
import type { Scenario } from '../../lib/scenario/scenario_model';
import { textIn as comparedText, valueIn as comparedIn } from '../../lib/scenario/values';
import { numberIn, present, wrongNumber, type Wrong } from './numbers';

export type JobSensor = Schemas['SimulationSensor'];
type Value = Exclude<JobSensor['value'], undefined>;
export type CourseKind = 'value' | 'steps' | 'ramp';
export type SensorField = 'node' | 'name' | 'unit' | 'value' | 'steps' | 'from' | 'to' | 'begin' | 'end';

export interface SensorWish {
  node: string;
  name: string;
  unit: string;
  identity: string;
  course: CourseKind;
  /** One value; lines "SECONDS VALUE"; a ramp's four numbers. A value "-": it cannot be read. */
  texts: Record<'value' | 'steps' | 'from' | 'to' | 'begin' | 'end', string>;
}

export const COURSES: CourseKind[] = ['value', 'steps', 'ramp'];
export const MOST_SENSORS = 100;
const NAME = /^[A-Za-z_][A-Za-z0-9_]{0,63}$/;
const TIME = { min: 0, max: 604_800 };
const NUMBER = { min: -1e12, max: 1e12, isNeeded: true };

export function newSensor(node: string): SensorWish {
  return { node, name: '', unit: '', identity: '', course: 'value', texts: { value: '', steps: '', from: '', to: '', begin: '0', end: '' } };
}

/** One for each sensor that a condition names, where the scenario's author says it is, else at the cloud. */
export function sensorsWanted(scenario: Scenario): SensorWish[] {
  const out = new Map<string, SensorWish>();
  for (const { when } of scenario.tasks) {
    if (typeof when !== 'object' || when === null) continue;
    const name = when.sensor ?? 'sensor';
    const node = when.of || 'cloud';
    const key = `${node} ${name} ${when.identity ?? ''}`;
    const value = when.value === undefined ? '' : textIn(when.value);
    if (!out.has(key)) out.set(key, { ...newSensor(node), name, unit: when.unit ?? '', identity: when.identity ?? '', texts: { ...newSensor(node).texts, value } });
  }
  return [...out.values()];
}

/** With those that another scenario's conditions name, too. */
export function withWanted(wishes: SensorWish[], scenario: Scenario): SensorWish[] {
  return [...wishes, ...sensorsWanted(scenario).filter((wanted) => !wishes.some((one) => one.node === wanted.node && one.name === wanted.name))];
}

export type SensorWrongs = Partial<Record<SensorField, Wrong | { why: 'node' | 'name' | 'twice' | 'steps' | 'end' }>>;

export function wrongsOfSensor(wish: SensorWish, nodes: string[], before: SensorWish[]): SensorWrongs {
  const out: SensorWrongs = {};
  if (!nodes.includes(wish.node)) out.node = { why: 'node' };
  if (!NAME.test(wish.name)) out.name = { why: 'name' };
  else if (before.some((one) => one.node === wish.node && one.name === wish.name)) out.name = { why: 'twice' };
  if (wish.course === 'value' && wish.texts.value.trim() === '') out.value = { why: 'missing' };
  if (wish.course === 'steps' && stepsIn(wish.texts.steps) === null) out.steps = { why: 'steps' };
  if (wish.course === 'ramp') Object.assign(out, wrongsOfRamp(wish.texts));
  return out;
}

function wrongsOfRamp(texts: SensorWish['texts']): SensorWrongs {
  const out: SensorWrongs = {};
  for (const field of ['from', 'to', 'begin', 'end'] as const) {
    const wrong = wrongNumber(texts[field], field === 'from' || field === 'to' ? NUMBER : { ...TIME, isNeeded: field === 'end' });
    if (wrong !== null) out[field] = wrong;
  }
  const end = numberIn(texts.end);
  if (end !== undefined && end <= (numberIn(texts.begin) ?? 0)) out.end ??= { why: 'end' };
  return out;
}

/** "-": it cannot be read. */
function valueIn(text: string): Value {
  return text.trim() === '-' ? null : comparedIn(text);
}

function textIn(value: Value): string {
  if (value === null) return '-';
  return value === '-' ? '"-"' : comparedText(value);
}

/** Nothing: a line is none, or they are not in order of time. */
function stepsIn(text: string): NonNullable<JobSensor['steps']> | null {
  const lines = text.split('\n').map((line) => line.trim()).filter((line) => line !== '');
  const steps = lines.map((line) => {
    const [, at, value] = /^(\S+)\s+(.+)$/.exec(line) ?? [];
    return { at: numberIn(at) ?? -1, value: valueIn(value ?? '') };
  });
  const isGood = steps.length > 0 && steps.length <= 1000 && steps.every((one, i) => one.at >= 0 && one.at <= TIME.max && (i === 0 || one.at > steps[i - 1]!.at));
  return isGood ? steps : null;
}

export function sensorOf({ node, name, unit, identity, course, texts }: SensorWish): JobSensor {
  const common = present({ node, name, unit: unit === '' ? undefined : unit, identity: identity === '' ? undefined : identity });
  if (course === 'steps') return { ...common, steps: stepsIn(texts.steps) ?? [] };
  if (course === 'value') return { ...common, value: valueIn(texts.value) };
  const [from, to, begin, end] = [texts.from, texts.to, texts.begin, texts.end].map((text) => numberIn(text) ?? 0) as [number, number, number, number];
  return { ...common, ramp: { from, to, begin, end } };
}

export function sensorWishOf(sensor: JobSensor): SensorWish {
  const { ramp } = sensor;
  return {
    node: sensor.node, name: sensor.name, unit: sensor.unit ?? '', identity: sensor.identity ?? '',
    course: sensor.steps ? 'steps' : ramp ? 'ramp' : 'value',
    texts: {
      value: sensor.value === undefined ? '' : textIn(sensor.value), steps: (sensor.steps ?? []).map((one) => `${one.at} ${textIn(one.value)}`).join('\n'),
      from: String(ramp?.from ?? ''), to: String(ramp?.to ?? ''), begin: String(ramp?.begin ?? 0), end: String(ramp?.end ?? ''),
    },
  };
}

/** Of the gateway's word on /sensor_values/N/FIELD. */
export function placeOfSensor(pointer: string): { wish: number; field: SensorField } | null {
  const found = /^\/sensor_values\/(\d+)(?:\/(\w+))?(?:\/(\w+))?/.exec(pointer);
  if (found === null) return null;
  const field = found[2] === 'ramp' ? (found[3] ?? 'end') : (found[2] ?? 'name');
  return { wish: Number(found[1]), field: field as SensorField };
}
