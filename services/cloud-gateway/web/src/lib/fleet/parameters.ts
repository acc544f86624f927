/** Values of a skill's parameters: what a person types, and what it means. */
import type { Parameter } from '../api/types';

export type Wrong = 'missing' | 'number' | 'integer' | 'range' | 'oneOf' | 'count';

/** What a field of that parameter shows. */
export function shownAs(value: unknown): string {
  if (value === undefined || value === null) return '';
  if (Array.isArray(value)) return value.join(', ');
  return typeof value === 'object' ? JSON.stringify(value) : String(value);
}

/** The value of what was typed; undefined: nothing was. */
export function valueOf(parameter: Parameter, typed: string): unknown {
  const text = typed.trim();
  if (text === '') return undefined;
  if (parameter.type === 'bool') return text === 'true';
  if (parameter.type === 'numbers') return text.split(/[\s,;]+/).filter((one) => one !== '').map(Number);
  if (parameter.type === 'number' || parameter.type === 'integer') {
    const number = Number(text);
    return Number.isNaN(number) ? text : number;
  }
  return text;
}

/** What is wrong with a value; nothing: it may be sent. */
export function wrongWith(parameter: Parameter, value: unknown): Wrong | null {
  if (value === undefined) return parameter.required ? 'missing' : null;
  if (parameter.type === 'number' || parameter.type === 'integer') return wrongNumber(parameter, value);
  if (parameter.type === 'numbers') return wrongList(parameter, value);
  if (parameter.one_of.length > 0 && !parameter.one_of.includes(String(value))) return 'oneOf';
  return null;
}

function wrongNumber(parameter: Parameter, value: unknown): Wrong | null {
  if (typeof value !== 'number' || !Number.isFinite(value)) return 'number';
  if (parameter.type === 'integer' && !Number.isInteger(value)) return 'integer';
  const [low, high] = parameter.range;
  return low !== undefined && high !== undefined && (value < low || value > high) ? 'range' : null;
}

function wrongList(parameter: Parameter, value: unknown): Wrong | null {
  if (!Array.isArray(value) || value.some((one) => typeof one !== 'number' || !Number.isFinite(one))) return 'number';
  if (parameter.count > 0 && value.length !== parameter.count) return 'count';
  const [low, high] = parameter.range;
  return low !== undefined && high !== undefined && value.some((one) => one < low || one > high) ? 'range' : null;
}

/** All that may be sent; nothing: at least one is wrong. */
export function dataOf(parameters: readonly Parameter[], values: Record<string, unknown>): Record<string, unknown> | null {
  if (parameters.some((parameter) => wrongWith(parameter, values[parameter.name]) !== null)) return null;
  return Object.fromEntries(parameters.map((one) => [one.name, values[one.name]]).filter(([, value]) => value !== undefined));
}
