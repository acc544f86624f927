/** The profiles of robots, each read once and again when a robot comes back. A few at a time. */
import { SvelteMap } from 'svelte/reactivity';
import { api } from '../api/client';
import type { Profile, Row } from '../api/types';

const MOST_AT_ONCE = 4;
const TOGETHER_MS = 100;

class Profiles {
  private readonly known = new SvelteMap<string, Profile>();
  private wanted = new Set<string>();
  private asked = new Set<string>();
  private waiting = 0;
  /** Received and not yet shown: each change has the whole hall looked at, so they come together. */
  private readonly coming = new Map<string, Profile>();
  private timer = 0;

  get(robot: string): Profile | undefined {
    return this.known.get(robot);
  }

  /** The robots that are shown: profiles of others are forgotten. */
  want(robots: string[]): void {
    const now = new Set(robots);
    for (const robot of this.asked) if (!now.has(robot)) this.forget(robot);
    for (const robot of robots) if (!this.asked.has(robot)) this.wanted.add(robot);
    this.next();
  }

  private take(robot: string, profile: Profile): void {
    this.coming.set(robot, profile);
    this.timer ||= window.setTimeout(() => {
      this.timer = 0;
      for (const [one, of] of this.coming) if (this.asked.has(one)) this.known.set(one, of);
      this.coming.clear();
    }, TOGETHER_MS);
  }

  private forget(robot: string): void {
    this.asked.delete(robot);
    this.wanted.delete(robot);
    this.known.delete(robot);
    this.coming.delete(robot);
  }

  private next(): void {
    for (const robot of this.wanted) {
      if (this.waiting >= MOST_AT_ONCE) return;
      this.wanted.delete(robot);
      this.asked.add(robot);
      ++this.waiting;
      void this.read(robot);
    }
  }

  private async read(robot: string): Promise<void> {
    try {
      const row = await api.get<Row<Profile>>('/api/v1/robots/{robot}/skills', { path: { robot } });
      this.take(robot, row.content);
    } catch {
      this.asked.delete(robot); // asked for again with the next change of the list
    } finally {
      --this.waiting;
      this.next();
    }
  }
}

export const profiles = new Profiles();
