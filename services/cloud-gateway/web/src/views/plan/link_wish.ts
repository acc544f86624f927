/** The network between two computers: one with a name, or described, in the units that people say it in. */
import type { Schemas } from '../../lib/api/types';
import { numberIn, present, textOfNumber, wrongNumber, type Bounds, type Wrong } from './numbers';

export type JobLink = NonNullable<Schemas['SimulationJob']['link']>;
export type LinkName = 'lan' | 'wifi' | 'vpn';
export type LinkKind = LinkName | 'own' | 'measured';
export type LinkField = 'delay' | 'deviation' | 'delays' | 'loss' | 'rate';

/** Delays in ms, loss in percent of the packets, rate in kB a second. */
export interface LinkWish {
  kind: LinkKind;
  texts: Record<LinkField, string>;
}

export const LINK_KINDS: LinkKind[] = ['lan', 'wifi', 'vpn', 'own', 'measured'];
export const MOST_MEASURED = 10_000;
const MOST_MS = 10_000;
const BOUNDS: Record<'delay' | 'deviation' | 'loss' | 'rate', Bounds> = {
  delay: { min: 0, max: MOST_MS, isNeeded: true },
  deviation: { min: 0, max: MOST_MS },
  loss: { min: 0, max: 50 },
  rate: { min: 0.1, max: 1e8 },
};
/** As the job names them. */
const FIELD_OF: Record<string, LinkField> = { delay_s: 'delay', deviation_s: 'deviation', delays_s: 'delays', loss: 'loss', bytes_a_second: 'rate' };

export const linkFields = (kind: LinkKind): LinkField[] =>
  kind === 'own' ? ['delay', 'deviation', 'loss', 'rate'] : kind === 'measured' ? ['delays', 'loss', 'rate'] : [];

export const newLink = (kind: LinkKind): LinkWish => ({ kind, texts: { delay: '20', deviation: '5', delays: '', loss: '', rate: '' } });

export type LinkWrongs = Partial<Record<LinkField, Wrong | { why: 'delays' | 'deviation' }>>;

export function wrongsOfLink({ kind, texts }: LinkWish): LinkWrongs {
  const out: LinkWrongs = {};
  for (const field of linkFields(kind)) {
    const wrong = field === 'delays' ? (delaysIn(texts.delays) === null ? { why: 'delays' as const } : null) : wrongNumber(texts[field], BOUNDS[field]);
    if (wrong !== null) out[field] = wrong;
  }
  const [delay, deviation] = [numberIn(texts.delay), numberIn(texts.deviation)];
  if (kind === 'own' && delay !== undefined && deviation !== undefined && deviation > delay) out.deviation ??= { why: 'deviation' };
  return out;
}

/** Seconds; nothing: there is none, too many, or one that is no delay. */
function delaysIn(text: string): number[] | null {
  const words = text.split(/[\s;]+/).filter((word) => word !== '');
  const values = words.map(numberIn);
  const isGood = values.length > 0 && values.length <= MOST_MEASURED && values.every((one) => one !== undefined && one >= 0 && one <= MOST_MS);
  return isGood ? values.map((one) => exact(one! / 1000)) : null;
}

const exact = (value: number): number => Number(value.toPrecision(12));
const times = (text: string, factor: number): number | undefined => {
  const value = numberIn(text);
  return value === undefined ? undefined : exact(value * factor);
};

export function linkOf({ kind, texts }: LinkWish): JobLink {
  if (kind !== 'own' && kind !== 'measured') return kind;
  const rate = times(texts.rate, 1000);
  const common = { loss: times(texts.loss, 0.01), bytes_a_second: rate === undefined ? undefined : Math.round(rate) };
  if (kind === 'measured') return present({ delays_s: delaysIn(texts.delays) ?? [], ...common });
  return present({ delay_s: times(texts.delay, 0.001), deviation_s: times(texts.deviation, 0.001), ...common });
}

export function linkWishOf(link: JobLink | undefined): LinkWish {
  if (typeof link !== 'object') return newLink(link ?? 'lan');
  const text = (value: number | undefined, factor: number) => textOfNumber(value === undefined ? undefined : exact(value * factor));
  return {
    kind: link.delays_s === undefined ? 'own' : 'measured',
    texts: {
      delay: text(link.delay_s, 1000), deviation: text(link.deviation_s, 1000), delays: (link.delays_s ?? []).map((one) => exact(one * 1000)).join(' '),
      loss: text(link.loss, 100), rate: text(link.bytes_a_second, 0.001),
    },
  };
}

/** Of the gateway's word on /link/FIELD. */
export function placeOfLink(pointer: string): LinkField | null {
  const found = /^\/link\/(\w+)/.exec(pointer);
  return found === null ? null : (FIELD_OF[found[1]!] ?? null);
}
