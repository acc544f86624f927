/** Boxes at their places, and the lines between them, in rem. */
import type { Placed } from './layout';

export const WIDE = 13.5;
export const HIGH = 5;
const GAP_Y = 1.25;
/** A line ends before its box: there the arrow's head is. */
const HEAD = 0.4;

export interface Boxes {
  width: number;
  height: number;
  x: (box: number) => number;
  y: (box: number) => number;
  /** The line from a box's right side to the left one of another. */
  line: (from: number, to: number) => string;
  /** The line from a box to where a pointer is. */
  lineTo: (from: number, x: number, y: number) => string;
  /** The box at that place; -1: there is none. */
  at: (x: number, y: number) => number;
}

export function boxesOf(placed: readonly Placed[], gapX: number): Boxes {
  const x = (box: number) => (placed[box]?.column ?? 0) * (WIDE + gapX);
  const y = (box: number) => (placed[box]?.row ?? 0) * (HIGH + GAP_Y);
  const last = (of: (one: Placed) => number) => placed.reduce((most, one) => Math.max(most, of(one)), 0);
  const lineTo = (from: number, x2: number, y2: number) => {
    const [x1, y1, bend] = [x(from) + WIDE, y(from) + HIGH / 2, gapX * 0.75];
    return `M${x1} ${y1}C${x1 + bend} ${y1} ${x2 - bend} ${y2} ${x2 - HEAD} ${y2}`;
  };
  return {
    width: last((one) => one.column) * (WIDE + gapX) + WIDE,
    height: last((one) => one.row) * (HIGH + GAP_Y) + HIGH,
    x, y, lineTo,
    line: (from, to) => lineTo(from, x(to), y(to) + HIGH / 2),
    at: (px, py) => placed.findIndex((_, box) => px >= x(box) && px <= x(box) + WIDE && py >= y(box) && py <= y(box) + HIGH),
  };
}

/** A box of which an edge is in sight counts as shown for a browser: who gets there by Tab would see nothing of it. */
export function shownWhole(event: FocusEvent): void {
  (event.currentTarget as HTMLElement).scrollIntoView({ block: 'nearest', inline: 'nearest' });
}
