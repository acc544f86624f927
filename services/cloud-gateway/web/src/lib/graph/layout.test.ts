import { describe, expect, it } from 'vitest';
import { layered, withoutImplied } from './layout';

describe('the layout of a scenario', () => {
  it('puts a chain into a line', () => {
    expect(layered([[], [0], [1]])).toEqual([{ column: 0, row: 0 }, { column: 1, row: 0 }, { column: 2, row: 0 }]);
  });

  it('puts a task behind the last one that it waits for', () => {
    expect(layered([[], [0], [0, 1]])[2]).toEqual({ column: 2, row: 0 });
  });

  it('does not need the tasks in order', () => {
    expect(layered([[1], [2], []]).map((one) => one.column)).toEqual([2, 1, 0]);
  });

  it('gives two tasks never the same place', () => {
    const placed = layered([[], [], [], [0, 2], [1], [0], [3, 4, 5]]);
    expect(new Set(placed.map((one) => `${one.column} ${one.row}`)).size).toBe(7);
  });

  it('crosses no lines that need not cross', () => {
    // 2 waits for 1, 3 for 0: drawn in the order given, the two lines would cross.
    const [a, b, c, d] = layered([[], [], [1], [0]]);
    expect(Math.sign(a!.row - b!.row)).toBe(Math.sign(d!.row - c!.row));
  });

  it('ends with a circle, a task that waits for itself and one that is not there', () => {
    const placed = layered([[1], [0], [2], [9, -1]]);
    expect(placed).toHaveLength(4);
    expect(placed.every((one) => one.column < 4)).toBe(true);
  });

  it('draws nothing for nothing', () => expect(layered([])).toEqual([]));

  it('places a thousand tasks within a blink', () => {
    const chain = Array.from({ length: 1000 }, (_, i) => (i < 10 ? [] : [i - 10]));
    const begun = performance.now();
    layered(chain);
    expect(performance.now() - begun).toBeLessThan(500);
  });
});

describe('the lines of a scenario', () => {
  it('leave out what another line says', () => expect(withoutImplied([[], [0], [0, 1]])).toEqual([[], [0], [1]]));
  it('keep what nothing else says', () => expect(withoutImplied([[], [], [0, 1]])).toEqual([[], [], [0, 1]]));
  it('hide no line of a circle', () => expect(withoutImplied([[1], [0]])).toEqual([[1], [0]]));
});
