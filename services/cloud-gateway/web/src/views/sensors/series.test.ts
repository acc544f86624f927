import { describe, expect, it } from 'vitest';
import { joined, MOST_POINTS, since, spanOf, wholeSince, type Point } from './series';

const points = (...pairs: [number, number][]): Point[] => pairs.map(([time, value]) => ({ time, value }));

describe('a sensor\'s values', () => {
  it('grow at their end', () => {
    expect(joined(points([1, 10]), points([2, 11], [3, 12]))).toEqual(points([1, 10], [2, 11], [3, 12]));
  });

  it('take in what was stored before, in order and each moment once', () => {
    expect(joined(points([3, 12], [4, 13]), points([4, 14], [2, 11]))).toEqual(points([2, 11], [3, 12], [4, 14]));
  });

  it('lose the oldest when there are too many', () => {
    const many = Array.from({ length: MOST_POINTS + 2 }, (_, i) => ({ time: i, value: i }));
    expect(joined([], many)[0]!.time).toBe(2);
    expect(joined(many.slice(0, MOST_POINTS), points([9e9, 1]))).toHaveLength(MOST_POINTS);
  });

  it('are whole since they were read, or since the oldest that was not pushed out', () => {
    expect(wholeSince(points([5, 1], [6, 1]), -Infinity)).toBe(-Infinity);
    expect(wholeSince(points([5, 1], [6, 1]), 5)).toBe(5);
    const many = Array.from({ length: MOST_POINTS }, (_, i) => ({ time: i + 7, value: i }));
    expect(wholeSince(many, -Infinity)).toBe(7);
    expect(wholeSince(many, 9)).toBe(9);
  });

  it('are told by their least, most and mean within a window', () => {
    expect(spanOf(since(points([1, 100], [2, 1], [3, 3]), 2))).toEqual({ least: 1, most: 3, mean: 2 });
    expect(spanOf([])).toBeNull();
  });
});
