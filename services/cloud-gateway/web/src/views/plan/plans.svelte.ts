/** The gateway's simulations, read again and again while somebody looks: soon while one is under way. */
import { api } from '../../lib/api/client';
import { toasts } from '../../lib/toasts.svelte';
import { isOver, type Simulation } from './plan_job';

const SOON_MS = 1000;
const LATER_MS = 10_000;

export class Plans {
  list = $state.raw<Simulation[]>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private abort: AbortController | undefined;

  /** Now, and from then on until it is ended. What cannot be read stays as it was: the connection's loss is told elsewhere. */
  async read(): Promise<void> {
    this.end();
    const mine = (this.abort = new AbortController());
    try {
      this.list = (await api.get<{ items: Simulation[] }>('/api/v1/simulations', { signal: mine.signal })).items;
    } catch {
      // It is tried again.
    }
    if (mine.signal.aborted) return;
    this.timer = setTimeout(() => void this.read(), this.list?.every(isOver) ? LATER_MS : SOON_MS);
  }

  end(): void {
    this.abort?.abort();
    clearTimeout(this.timer);
  }

  /** Cancels it, or forgets one that is over. */
  async remove(id: string): Promise<void> {
    try {
      await api.send('DELETE', '/api/v1/simulations/{simulation}', { path: { simulation: id } });
    } catch (problem) {
      toasts.problem(problem);
    }
    await this.read();
  }
}
