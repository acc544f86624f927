export type Cell = string | number | null;
export interface Column<Item> {
  key: string;
  label: string;
  /** What it is sorted by, and shown as if the table has no cell of its own for it. */
  value: (item: Item) => Cell;
  /** Numbers stand at the right. */
  isNumber?: boolean;
}

const names = new Intl.Collator(undefined, { numeric: true }); // to make one takes far longer than to use it

function compare(a: Cell, b: Cell): number {
  if (a === null || b === null) return Number(a === null) - Number(b === null);
  if (typeof a === 'number' && typeof b === 'number') return a - b;
  return names.compare(String(a), String(b));
}

/** Letters without a place where a line may be broken: what has more would push the columns beside it out of sight. */
const LONG = 20;

export function hasLongWord(cell: Cell): boolean {
  return typeof cell === 'string' && cell.split(/[\s-]+/).some((word) => word.length > LONG);
}

/** Stable; what has no value comes last in both directions. */
export function sorted<Item>(items: Item[], column: Column<Item>, isDown: boolean): Item[] {
  return items
    .map((item) => ({ item, cell: column.value(item) }))
    .sort((a, b) => compare(a.cell, b.cell) * (isDown && a.cell !== null && b.cell !== null ? -1 : 1))
    .map((one) => one.item);
}
