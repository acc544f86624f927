/** What goes wrong, as a person says it: a kind, whom, when, for how long. The end of a fault is a fault of the job, too. */
import type { Schemas } from '../../lib/api/types';
import { numberIn, present, textOfNumber, wrongNumber, type Bounds, type Wrong } from './numbers';

export type JobFault = Schemas['SimulationFault'];
export type WishedKind = 'fail' | 'kill' | 'cut' | 'partition' | 'clock' | 'disk' | 'battery' | 'rate';
export type Way = NonNullable<JobFault['way']>;
export type NumberField = 'at' | 'lasts' | 'ahead_s' | 'drift_ppm' | 'commit_s' | 'percent' | 'per_second' | 'between_s' | 'repair_s';
export type FaultField = NumberField | 'node' | 'other' | 'way' | 'nodes' | 'is_1970';

export interface FaultWish {
  kind: WishedKind;
  node: string;
  /** Empty: all others. */
  other: string;
  way: Way;
  nodes: string[];
  is1970: boolean;
  numbers: Partial<Record<NumberField, string>>;
}

export const WISHED_KINDS: WishedKind[] = ['fail', 'kill', 'cut', 'partition', 'clock', 'disk', 'battery', 'rate'];
export const WAYS: Way[] = ['both', 'there', 'back'];
export const MOST_JOB_FAULTS = 100;
const WEEK = 604_800;

export const FIELDS: Record<WishedKind, FaultField[]> = {
  fail: ['node', 'at', 'lasts'],
  kill: ['node', 'at', 'lasts'],
  cut: ['node', 'other', 'way', 'at', 'lasts'],
  partition: ['nodes', 'at', 'lasts'],
  clock: ['node', 'ahead_s', 'drift_ppm', 'is_1970', 'at'],
  disk: ['node', 'commit_s', 'at'],
  battery: ['node', 'percent', 'per_second', 'at'],
  rate: ['node', 'between_s', 'repair_s'],
};

/** As services/cloud-gateway/api/openapi.json has them. */
export const BOUNDS: Record<NumberField, Bounds> = {
  at: { min: 0, max: WEEK },
  lasts: { min: 0, max: WEEK },
  ahead_s: { min: -1.5e9, max: 1.5e9 },
  drift_ppm: { min: -100_000, max: 100_000, isWhole: true },
  commit_s: { min: 0, max: 60, isNeeded: true },
  percent: { min: 0, max: 100, isNeeded: true },
  per_second: { min: 0, max: 100, isNeeded: true },
  between_s: { min: 1, max: 1e7, isNeeded: true },
  repair_s: { min: 0, max: WEEK },
};

const ENDS = { fail: 'repair', kill: 'start', cut: 'heal', partition: 'heal' } as const;
type Ending = keyof typeof ENDS;
const ends = (kind: string): kind is Ending => kind in ENDS;
const isNumber = (field: FaultField): field is NumberField => field in BOUNDS;

export function newFault(node: string): FaultWish {
  return { kind: 'fail', node, other: '', way: 'both', nodes: [], is1970: false, numbers: { at: '5' } };
}

/** What a kind begins with. */
export function usualNumbers(kind: WishedKind): FaultWish['numbers'] {
  const all: Partial<Record<WishedKind, FaultWish['numbers']>> = {
    clock: { ahead_s: '30' }, disk: { commit_s: '0.5' }, battery: { percent: '20', per_second: '1' }, rate: { between_s: '60', repair_s: '10' },
  };
  return { at: '5', ...all[kind] };
}

/** A robot's fault, or one that the cloud may have as well; of a rate every robot may be meant: ''. */
export const isOfRobot = (kind: WishedKind): boolean => kind === 'fail' || kind === 'battery' || kind === 'rate';
/** It may be so from the start. */
export const mayBegin = (kind: WishedKind): boolean => kind !== 'fail' && kind !== 'kill';

export type FaultWrongs = Partial<Record<FaultField, Wrong | { why: 'node' | 'side' | 'clock' | 'same' }>>;

/** `nodes`: those of the fleet, the cloud among them. */
export function wrongsOf(wish: FaultWish, nodes: string[]): FaultWrongs {
  const out: FaultWrongs = {};
  for (const field of FIELDS[wish.kind]) {
    const wrong = isNumber(field) ? wrongNumber(wish.numbers[field], boundsOf(wish, field)) : wrongWhom(wish, field, nodes);
    if (wrong !== null) out[field] = wrong;
  }
  const { ahead_s, drift_ppm } = wish.numbers;
  const says = [ahead_s, drift_ppm].some((text) => (text ?? '').trim() !== '') || wish.is1970;
  if (wish.kind === 'clock' && (!says || (wish.is1970 && (ahead_s ?? '').trim() !== ''))) out.ahead_s ??= { why: 'clock' };
  return out;
}

function boundsOf(wish: FaultWish, field: NumberField): Bounds {
  return field === 'at' ? { ...BOUNDS.at, isNeeded: !mayBegin(wish.kind) } : BOUNDS[field];
}

function wrongWhom(wish: FaultWish, field: FaultField, nodes: string[]): { why: 'node' | 'side' | 'same' } | null {
  const isThere = (id: string) => nodes.includes(id);
  if (field === 'node') {
    const mayBeAny = wish.kind === 'rate' && wish.node === '';
    return mayBeAny || (isThere(wish.node) && !(isOfRobot(wish.kind) && wish.node === 'cloud')) ? null : { why: 'node' };
  }
  if (field === 'other' && wish.other !== '') return wish.other === wish.node ? { why: 'same' } : isThere(wish.other) ? null : { why: 'node' };
  if (field !== 'nodes') return null;
  const there = wish.nodes.filter(isThere);
  return there.length > 0 && there.length < nodes.length ? null : { why: 'side' };
}

/** The job's faults of one wish: the fault, and its end if it has one. */
export function faultsOf(wish: FaultWish): JobFault[] {
  const has = (field: FaultField) => FIELDS[wish.kind].includes(field);
  const numberOf = (field: NumberField) => (has(field) ? numberIn(wish.numbers[field]) : undefined);
  const whom = present({
    node: has('node') && wish.node !== '' ? wish.node : undefined, other: has('other') && wish.other !== '' ? wish.other : undefined,
    way: has('way') && wish.way !== 'both' ? wish.way : undefined, nodes: has('nodes') ? wish.nodes : undefined,
  });
  const fault = present({
    at: numberOf('at'), kind: wish.kind, ...whom,
    ahead_s: numberOf('ahead_s'), drift_ppm: numberOf('drift_ppm'), is_1970: has('is_1970') && wish.is1970 ? true : undefined,
    commit_s: numberOf('commit_s'), percent: numberOf('percent'), per_second: numberOf('per_second'),
    between_s: numberOf('between_s'), repair_s: numberOf('repair_s'),
  }) as JobFault;
  const lasts = numberOf('lasts');
  if (lasts === undefined || !ends(wish.kind)) return [fault];
  return [fault, { ...whom, at: (fault.at ?? 0) + lasts, kind: ENDS[wish.kind] } as JobFault];
}

/** The wishes that a job's faults came from; an end without its fault is left out. */
export function wishesOf(faults: JobFault[]): FaultWish[] {
  const left = [...faults];
  const out: FaultWish[] = [];
  for (const fault of faults) {
    if (!WISHED_KINDS.includes(fault.kind as WishedKind)) continue;
    const kind = fault.kind as WishedKind;
    const begin = fault.at ?? 0;
    const end = ends(kind) ? left.findIndex((one) => one.kind === ENDS[kind] && (one.at ?? 0) >= begin && isSame(one, fault)) : -1;
    const lasts = end < 0 ? undefined : (left[end]!.at ?? 0) - begin;
    if (end >= 0) left.splice(end, 1);
    out.push(wishOf(kind, fault, lasts));
  }
  return out;
}

function isSame(a: JobFault, b: JobFault): boolean {
  return a.node === b.node && a.other === b.other && (a.way ?? 'both') === (b.way ?? 'both') && (a.nodes ?? []).join() === (b.nodes ?? []).join();
}

function wishOf(kind: WishedKind, fault: JobFault, lasts: number | undefined): FaultWish {
  const { at, ahead_s, drift_ppm, commit_s, percent, per_second, between_s, repair_s } = fault;
  const numbers = { at, lasts, ahead_s, drift_ppm, commit_s, percent, per_second, between_s, repair_s };
  return {
    kind, node: fault.node ?? '', other: fault.other ?? '', way: fault.way ?? 'both', nodes: fault.nodes ?? [], is1970: fault.is_1970 ?? false,
    numbers: Object.fromEntries(Object.entries(numbers).map(([key, value]) => [key, textOfNumber(value === undefined ? undefined : round(value))])),
  };
}

const round = (value: number): number => Math.round(value * 1e6) / 1e6;

/** Which wish and which of its fields the gateway's word on /faults/N/FIELD is about. */
export function placeOfFault(pointer: string, wishes: FaultWish[]): { wish: number; field: FaultField } | null {
  const found = /^\/faults\/(\d+)(?:\/(\w+))?/.exec(pointer);
  if (found === null) return null;
  let number = Number(found[1]);
  for (const [wish, one] of wishes.entries()) {
    const count = faultsOf(one).length;
    if (number < count) {
      const field = found[2] === 'at' && number > 0 ? 'lasts' : ((found[2] ?? 'node') as FaultField);
      return { wish, field: FIELDS[one.kind].includes(field) ? field : FIELDS[one.kind][0]! };
    }
    number -= count;
  }
  return null;
}
