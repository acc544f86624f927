/** The forms of policy, criteria and minimums: texts as a person types them, and what goes to the gateway. */
import type { Schemas } from '../../lib/api/types';

export type Policy = Schemas['Policy'];
export type Criteria = Schemas['Criteria'];
export type Minimums = Schemas['Minimums'];

/** As the gateway shows a criterion: always an object. */
interface ShownCriterion {
  weight?: number;
  from?: 'robot' | 'description' | 'sensor';
  value?: string;
  unit?: string;
  best?: number;
  worst?: number;
  at_least?: number;
  at_most?: number;
  capabilities?: string[];
}

export interface CriterionRow {
  name: string;
  weight: string;
  best: string;
  worst: string;
  /** battery, distance and availability have a source of their own. */
  isOwn: boolean;
  from: 'robot' | 'description' | 'sensor';
  value: string;
  unit: string;
  /** What the form does not change. */
  kept: { at_least?: number | undefined; at_most?: number | undefined; capabilities?: string[] | undefined };
}

export interface MinimumRow {
  name: string;
  unit: string;
  atLeast: string;
  atMost: string;
}

const PAPER = ['battery', 'distance', 'availability'];
const PAPER_UNITS: Record<string, string> = { battery: '%', distance: 'm', availability: '' };

/** In which unit its best and worst values are. */
export function unitOf({ name, isOwn, unit }: CriterionRow): string {
  return isOwn ? unit : (PAPER_UNITS[name] ?? '');
}

/** `Best value (m)`. */
export function withUnit(label: string, unit: string): string {
  return unit === '' ? label : `${label} (${unit})`;
}

/** Also with a comma, as people write it; nothing typed is nothing. What is no number stays text: the gateway says so. */
export function numberOf(text: string): number | string | undefined {
  const plain = text.trim().replace(',', '.');
  if (plain === '') return undefined;
  const out = Number(plain);
  return Number.isFinite(out) ? out : text;
}

function round(value: number): string {
  return String(Number(value.toPrecision(6)));
}

const shown = (criteria: Criteria): [string, ShownCriterion][] =>
  Object.entries(criteria.criteria as Record<string, ShownCriterion | number>).map(([name, one]) => [
    name,
    typeof one === 'number' ? { weight: one } : one,
  ]);

export function rowsOfCriteria(criteria: Criteria): CriterionRow[] {
  return shown(criteria).map(([name, one]) => ({
    name,
    weight: round(one.weight ?? 1),
    best: one.best === undefined ? '' : String(one.best),
    worst: one.worst === undefined ? '' : String(one.worst),
    isOwn: !PAPER.includes(name),
    from: one.from ?? 'robot',
    value: one.value ?? '',
    unit: one.unit ?? '',
    kept: { at_least: one.at_least, at_most: one.at_most, capabilities: one.capabilities },
  }));
}

/**
 * What is typed stays when the minimums were saved meanwhile: bounds are of both. Nothing: somebody has changed what is
 * typed over, too.
 */
export function withNewBounds(typed: CriterionRow[], old: Criteria, now: Criteria): CriterionRow[] | null {
  const rows = rowsOfCriteria(now);
  const plain = (all: CriterionRow[]) => JSON.stringify(all.map((row) => ({ ...row, kept: row.kept.capabilities })));
  if (plain(typed) === plain(rowsOfCriteria(old))) return rows;
  if (plain(rows) !== plain(rowsOfCriteria(old))) return null;
  return typed.map((row) => ({ ...row, kept: rows.find((one) => one.name === row.name)?.kept ?? row.kept }));
}

export function emptyCriterion(): CriterionRow {
  return { name: '', weight: '1', best: '', worst: '', isOwn: true, from: 'robot', value: '', unit: '', kept: {} };
}

/** Without members that are undefined: the gateway knows none of them. */
function filled<T extends object>(object: T): T {
  return Object.fromEntries(Object.entries(object).filter(([, value]) => value !== undefined && value !== '')) as T;
}

export function criteriaOf(rows: CriterionRow[]): unknown {
  const criteria = rows.map((row) => {
    const source = row.isOwn ? { from: row.from, value: row.value, unit: row.unit } : {};
    const range = { best: numberOf(row.best), worst: numberOf(row.worst) };
    return [row.name.trim(), filled({ weight: numberOf(row.weight), ...source, ...range, ...row.kept })];
  });
  return { criteria: Object.fromEntries(criteria) };
}

/** A name that is there twice would be sent once. */
export function twice(rows: CriterionRow[]): string | null {
  const names = rows.map((row) => row.name.trim());
  return names.find((name, i) => names.indexOf(name) !== i) ?? null;
}

export function rowsOfMinimums(criteria: Criteria, minimums: Minimums): MinimumRow[] {
  return shown(criteria).map(([name, one]) => ({
    name,
    unit: one.unit ?? PAPER_UNITS[name] ?? '',
    atLeast: minimums[name]?.at_least === undefined ? '' : String(minimums[name]?.at_least),
    atMost: minimums[name]?.at_most === undefined ? '' : String(minimums[name]?.at_most),
  }));
}

/** The same of minimums, when the criteria were saved. */
export function withNewCriteria(typed: MinimumRow[], old: MinimumRow[], now: MinimumRow[]): MinimumRow[] | null {
  const boundsOf = (rows: MinimumRow[], name: string) => {
    const row = rows.find((one) => one.name === name);
    return row && { atLeast: row.atLeast, atMost: row.atMost };
  };
  const isSame = (a: unknown, b: unknown) => JSON.stringify(a) === JSON.stringify(b);
  const isTyped = (name: string) => !isSame(boundsOf(typed, name), boundsOf(old, name));
  if (now.some(({ name }) => isTyped(name) && !isSame(boundsOf(now, name), boundsOf(old, name)))) return null;
  return now.map((row) => (isTyped(row.name) ? { ...row, ...boundsOf(typed, row.name) } : row));
}

export function minimumsOf(rows: MinimumRow[]): unknown {
  const bounds = rows.map((row) => [row.name, filled({ at_least: numberOf(row.atLeast), at_most: numberOf(row.atMost) })] as const);
  return Object.fromEntries(bounds.filter(([, one]) => Object.keys(one).length > 0));
}

export interface PolicyForm {
  mode: 'ask' | 'automatic';
  bind: 'automatic' | 'ask';
  maxMoves: string;
  minScore: string;
  minLead: string;
  maxSeverity: Schemas['Severity'];
  expiresS: string;
}

export function formOfPolicy(policy: Policy): PolicyForm {
  return {
    mode: policy.mode,
    bind: policy.bind ?? 'automatic',
    maxMoves: String(policy.max_moves ?? 2),
    minScore: String(policy.conditions?.min_score ?? 0),
    minLead: String(policy.conditions?.min_lead ?? 0),
    maxSeverity: policy.conditions?.max_severity ?? 'FATAL',
    expiresS: String(policy.expires_s ?? 600),
  };
}

export function policyOf(form: PolicyForm): unknown {
  const conditions = filled({ min_score: numberOf(form.minScore), min_lead: numberOf(form.minLead), max_severity: form.maxSeverity });
  return filled({ mode: form.mode, bind: form.bind, max_moves: numberOf(form.maxMoves), conditions, expires_s: numberOf(form.expiresS) });
}
