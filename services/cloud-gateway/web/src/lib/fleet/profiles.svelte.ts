/**
 * The profiles of the robots that are shown, a few at a time. One that could not be read is asked for again 2 s later,
 * then less and less often; one that was read is read again when its robot is heard again: it may have changed meanwhile.
 */
import { SvelteMap } from 'svelte/reactivity';
import { api } from '../api/client';
import type { Profile, Row } from '../api/types';

const MOST_AT_ONCE = 4;
const TOGETHER_MS = 100;
export const RETRY_MS = 2000;
const MOST_RETRY_MS = 60_000;

type Shown = Pick<Row, 'node' | 'live'>;
interface Failed {
  tries: number;
  /** When it is asked for again, by performance.now(). */
  due: number;
}

export class Profiles {
  private readonly known = new SvelteMap<string, Profile>();
  /** Which are shown; true: its row was live. */
  private shown = new Map<string, boolean>();
  private readonly wanted = new Set<string>();
  private readonly reading = new Set<string>();
  private readonly failed = new Map<string, Failed>();
  /** Received and not yet shown: each change has the whole hall looked at, so they come together. */
  private readonly coming = new Map<string, Profile>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private watchers = 0;

  get(robot: string): Profile | undefined {
    return this.known.get(robot);
  }

  /** The robots that are shown: profiles of others are forgotten. Given back: what ends the wish. */
  want(robots: readonly Shown[]): () => void {
    const before = this.shown;
    this.shown = new Map(robots.map((one) => [one.node, one.live === 'live']));
    for (const robot of before.keys()) if (!this.shown.has(robot)) this.forget(robot);
    for (const [robot, isLive] of this.shown) if (!before.has(robot) || (isLive && !before.get(robot))) this.wanted.add(robot);
    ++this.watchers;
    this.next();
    this.arm();
    return () => {
      --this.watchers;
      this.arm();
    };
  }

  private take(robot: string, profile: Profile): void {
    this.coming.set(robot, profile);
    this.timer ??= setTimeout(() => {
      this.timer = undefined;
      for (const [one, of] of this.coming) this.known.set(one, of);
      this.coming.clear();
    }, TOGETHER_MS);
  }

  private forget(robot: string): void {
    this.wanted.delete(robot);
    this.failed.delete(robot);
    this.known.delete(robot);
    this.coming.delete(robot);
  }

  private next(): void {
    for (const robot of this.wanted) {
      if (this.reading.size >= MOST_AT_ONCE) return;
      if (this.reading.has(robot)) continue; // after that
      this.wanted.delete(robot);
      this.reading.add(robot);
      void this.read(robot);
    }
  }

  private async read(robot: string): Promise<void> {
    try {
      const row = await api.get<Row<Profile>>('/api/v1/robots/{robot}/skills', { path: { robot } });
      this.failed.delete(robot);
      if (this.shown.has(robot)) this.take(robot, row.content);
    } catch {
      if (this.shown.has(robot)) this.later(robot);
    }
    this.reading.delete(robot);
    this.next();
    this.arm();
  }

  private later(robot: string): void {
    const tries = this.failed.get(robot)?.tries ?? 0;
    const wait = Math.min(RETRY_MS * 2 ** tries, MOST_RETRY_MS);
    this.failed.set(robot, { tries: tries + 1, due: performance.now() + wait });
  }

  /** One timer for all, to the one that is due first; none while nobody looks. */
  private arm(): void {
    clearTimeout(this.retryTimer);
    this.retryTimer = undefined;
    if (this.watchers === 0) return;
    const first = Math.min(...[...this.failed].filter(([robot]) => !this.isUnderWay(robot)).map(([, one]) => one.due));
    if (first !== Infinity) this.retryTimer = setTimeout(() => this.again(), Math.max(0, first - performance.now()));
  }

  private again(): void {
    const now = performance.now();
    for (const [robot, one] of this.failed) if (one.due <= now && !this.isUnderWay(robot)) this.wanted.add(robot);
    this.next();
    this.arm();
  }

  private isUnderWay(robot: string): boolean {
    return this.wanted.has(robot) || this.reading.has(robot);
  }
}

export const profiles = new Profiles();
