/** A wish under work, until it is a simulation. */
import { Problem } from '../../lib/api/client';
import { once } from '../../lib/api/once';
import type { Fault } from '../../lib/api/problem';
import { toasts } from '../../lib/toasts.svelte';
import { within, type Started, type Wish } from './plan_job';

export class Asking {
  wish = $state.raw<Wish>()!;
  seed = $state('');
  isBusy = $state(false);
  /** What the gateway found wrong, until something is changed. */
  refused = $state.raw<Fault[]>([]);

  constructor(first: Wish) {
    this.wish = first;
    this.seed = String(first.seed);
  }

  get isSeed(): boolean {
    return /^\d{1,6}$/.test(this.seed.trim());
  }

  set(change: Partial<Wish>): void {
    this.wish = within({ ...this.wish, ...change });
    this.refused = [];
  }

  /** With the seed that is typed. */
  get whole(): Wish {
    return { ...this.wish, seed: Number(this.seed) };
  }

  /** Nothing: it was refused. */
  async start(job: object): Promise<Started | null> {
    this.isBusy = true;
    try {
      return await once.post<Started>('/api/v1/simulations', { body: job });
    } catch (problem) {
      this.refused = problem instanceof Problem ? problem.faults : [];
      if (this.refused.length === 0) toasts.problem(problem);
      return null;
    } finally {
      this.isBusy = false;
    }
  }
}
