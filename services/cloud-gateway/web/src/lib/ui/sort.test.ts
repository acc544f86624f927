import { describe, expect, it } from 'vitest';
import { sorted, type Column } from './sort';

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
