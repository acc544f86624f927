/**
 * What is stored of a sensor, read back page by page, the newest first, as far as somebody wants to see it.
 *
 * | State   | Event                                   | Does                      | Next    |
 * |---------|-----------------------------------------|---------------------------|---------|
 * | idle    | wanted further back than it was read    | asks for a page           | reading |
 * | reading | wanted further back                     | remembered                | reading |
 * | reading | a page, and it does not go back enough  | gives it, asks for the next | reading |
 * | reading | the last page, enough, MOST_READ values, or refused | gives it      | idle    |
 */
import type { Point } from './series';

export const MOST_READ = 20_000;

export interface StoredPage {
  points: Point[];
  /** How many entries it has, also those that are no numbers. */
  count: number;
  /** The time of its oldest entry, s; nothing: it has none. */
  oldest: number | null;
  /** For the next page; empty: there is none. */
  next: string;
}

export class Backlog {
  /** Since when every stored value was given, s; -Infinity: all of them. */
  since = Infinity;
  private wanted = Infinity;
  private isReading = false;
  private hasEnded = false;
  private cursor = '';
  private read = 0;

  constructor(private readonly ask: (cursor: string) => Promise<StoredPage>, private readonly give: (points: Point[], since: number) => void) {}

  /** Until all since `from` were given, or there are too many. A refused page is asked for again with the next wish. */
  async reach(from: number): Promise<void> {
    this.wanted = Math.min(this.wanted, from);
    if (this.isReading) return;
    this.isReading = true;
    try {
      while (!this.hasEnded && this.since > this.wanted) this.take(await this.ask(this.cursor));
    } catch {
      this.wanted = Infinity; // it lives without what was before
    } finally {
      this.isReading = false;
    }
  }

  private take(page: StoredPage): void {
    this.read += page.count;
    this.cursor = page.next;
    this.since = page.next === '' ? -Infinity : (page.oldest ?? this.since);
    this.hasEnded = page.next === '' || this.read >= MOST_READ;
    this.give(page.points, this.since);
  }
}
