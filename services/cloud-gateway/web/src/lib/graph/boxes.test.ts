import { expect, it } from 'vitest';
import { boxesOf, HIGH, WIDE } from './boxes';

const boxes = boxesOf([{ column: 0, row: 0 }, { column: 1, row: 1 }], 3);

it('puts boxes beside and below each other', () => {
  expect([boxes.x(0), boxes.y(0)]).toEqual([0, 0]);
  expect([boxes.x(1), boxes.width]).toEqual([WIDE + 3, 2 * WIDE + 3]);
  expect(boxes.height).toBe(boxes.y(1) + HIGH);
});

it('draws a line from the right side of one to the left side of the other', () => {
  expect(boxes.line(0, 1)).toMatch(new RegExp(`^M${WIDE} ${HIGH / 2}C`));
  expect(boxes.line(0, 1)).toBe(boxes.lineTo(0, boxes.x(1), boxes.y(1) + HIGH / 2));
});

it('finds the box where somebody lets go', () => {
  expect(boxes.at(1, 1)).toBe(0);
  expect(boxes.at(boxes.x(1) + 1, boxes.y(1) + 1)).toBe(1);
  expect(boxes.at(WIDE + 1, 1)).toBe(-1);
});

it('has room for one box when there is none', () => {
  expect([boxesOf([], 3).width, boxesOf([], 3).height]).toEqual([WIDE, HIGH]);
});
