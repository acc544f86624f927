import { expect, it } from 'vitest';
import { roomFor } from './paint';

const pen = { measureText: (text: string) => ({ width: 8 * text.length }) } as unknown as CanvasRenderingContext2D;
const picture = { width: 500, height: 500 };
const rect = (x: number, y: number, width: number, height: number) => ({ x, y, width, height });

it('puts a label right of its thing, else where nothing else is, and nowhere if there is no room', () => {
  const at = { x: 100, y: 100 };
  const side = (taken: ReturnType<typeof rect>[], avoided: ReturnType<typeof rect>[] = []) => roomFor(pen, at, ['ur3'], 10, { ...picture, taken, avoided });
  expect(side([])?.x).toBe(110);
  expect(side([rect(115, 90, 10, 20)])?.x).toBe(66);
  expect(side([rect(0, 0, 200, 200)])).toBeUndefined();
  expect(side([], [rect(115, 95, 10, 10)])?.x).toBe(66); // not over a place's cross
  expect(side([], [rect(0, 0, 200, 200)])?.x).toBe(110); // but rather there than nowhere
  const edge = (x: number, avoided: ReturnType<typeof rect>[] = []) => roomFor(pen, { x, y: 100 }, ['ur3'], 10, { ...picture, taken: [], avoided });
  expect(edge(480)?.x).toBe(446); // within the picture
  expect(edge(10, [rect(25, 95, 10, 10)])).toMatchObject({ x: 20, y: 91.5 }); // over a cross rather than cut
});
