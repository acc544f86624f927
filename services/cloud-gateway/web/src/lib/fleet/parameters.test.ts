import { describe, expect, it } from 'vitest';
import type { Parameter } from '../api/types';
import { dataOf, shownAs, valueOf, wrongWith } from './parameters';

const parameter = (more: Partial<Parameter>): Parameter => ({
  name: 'x', type: 'number', required: false, unit: '', range: [], one_of: [], count: 0, ...more,
});

describe('a parameter that is typed', () => {
  it('becomes a value of its type', () => {
    expect(valueOf(parameter({}), ' 1.5 ')).toBe(1.5);
    expect(valueOf(parameter({}), '')).toBeUndefined();
    expect(valueOf(parameter({ type: 'numbers' }), '1, 2 3')).toEqual([1, 2, 3]);
    expect(valueOf(parameter({ type: 'bool' }), 'true')).toBe(true);
    expect(valueOf(parameter({ type: 'place' }), 'dock')).toBe('dock');
    expect(shownAs([1, 2])).toBe('1, 2');
  });

  it('is refused when it does not fit', () => {
    expect(wrongWith(parameter({ required: true }), undefined)).toBe('missing');
    expect(wrongWith(parameter({}), valueOf(parameter({}), 'fast'))).toBe('number');
    expect(wrongWith(parameter({ type: 'integer' }), 1.5)).toBe('integer');
    expect(wrongWith(parameter({ range: [0, 1] }), 2)).toBe('range');
    expect(wrongWith(parameter({ type: 'place', one_of: ['dock'] }), 'sea')).toBe('oneOf');
    expect(wrongWith(parameter({ type: 'numbers', count: 2 }), [1])).toBe('count');
    expect(wrongWith(parameter({ type: 'numbers' }), [1, NaN])).toBe('number');
    expect(wrongWith(parameter({}), undefined)).toBeNull();
  });

  it('is sent with the others once all of them fit', () => {
    const both = [parameter({ name: 'a', required: true }), parameter({ name: 'b' })];
    expect(dataOf(both, { a: 1, other: 5 })).toEqual({ a: 1 });
    expect(dataOf(both, { b: 1 })).toBeNull();
  });
});
