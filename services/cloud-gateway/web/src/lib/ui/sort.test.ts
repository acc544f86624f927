import { describe, expect, it } from 'vitest';
import { hasLongWord, sorted, type Column } from './sort';

const column: Column<string | number | null> = { key: 'x', label: 'x', value: (item) => item };

describe('a sorted column', () => {
  it('sorts numbers as numbers, also within names', () => {
    expect(sorted([10, 9, 100], column, false)).toEqual([9, 10, 100]);
    expect(sorted(['robot10', 'robot9'], column, false)).toEqual(['robot9', 'robot10']);
  });

  it('has what is unknown at its end in both directions', () => {
    expect(sorted([null, 1, 2], column, false)).toEqual([1, 2, null]);
    expect(sorted([1, null, 2], column, true)).toEqual([2, 1, null]);
  });
});

describe('a long word', () => {
  it('is broken within, so that the columns beside it are seen', () => {
    expect(hasLongWord(`a robot ${'x'.repeat(64)}`)).toBe(true);
    expect(hasLongWord('robot-36-of-the-hall-in-the-north')).toBe(false);
    expect(hasLongWord(12345678901234567890123)).toBe(false);
    expect(hasLongWord(null)).toBe(false);
  });
});
