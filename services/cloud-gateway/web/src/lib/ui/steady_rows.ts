/** Rows that have buttons do not move under the hand of who is about to press one. Pure: no clock, no page. */

/** A row that came to its place so short a time ago is not the one that was aimed at, ms. */
export const AIMED_MS = 400;

export class SteadyRows<Item> {
  private keys: string[] = [];
  private sortedAs = '';
  private readonly movedAt = new Map<string, number>();

  constructor(private readonly keyOf: (item: Item) => string) {}

  /**
   * The rows to show of those that are wanted. Held: who was shown keeps its order, and what is new stands at the end,
   * unless somebody sorts them in another way, which `sortedAs` tells.
   */
  next(wanted: Item[], isHeld: boolean, sortedAs: string, now: number): Item[] {
    const rows = isHeld && sortedAs === this.sortedAs ? this.inOldOrder(wanted) : wanted;
    const keys = rows.map(this.keyOf);
    this.sortedAs = sortedAs;
    this.note(keys, now);
    return rows;
  }

  /** It has moved just now: a press was meant for another row. */
  hasJustMoved(key: string, now: number): boolean {
    return now - (this.movedAt.get(key) ?? -Infinity) < AIMED_MS;
  }

  private inOldOrder(wanted: Item[]): Item[] {
    const byKey = new Map(wanted.map((item) => [this.keyOf(item), item]));
    const old = this.keys.filter((key) => byKey.has(key));
    const shown = new Set(old);
    return [...old.map((key) => byKey.get(key)!), ...wanted.filter((item) => !shown.has(this.keyOf(item)))];
  }

  /** Also what is new took the place of another one, unless that place was free. */
  private note(keys: string[], now: number): void {
    const before = new Map(this.keys.map((key, i) => [key, i]));
    for (const key of this.movedAt.keys()) if (!before.has(key)) this.movedAt.delete(key);
    keys.forEach((key, i) => {
      if (i < this.keys.length && before.get(key) !== i) this.movedAt.set(key, now);
    });
    this.keys = keys;
  }
}
