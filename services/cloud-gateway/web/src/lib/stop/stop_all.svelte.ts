/**
 * Stops every robot. It depends on nothing else of the page: a request of its own that waits for no other, the key is
 * heard before any view hears it, and a second press sends a second stop. Not a safety function.
 */
import { api, newKey, Problem } from '../api/client';
import type { RobotOrder } from '../api/types';

export type StopResult =
  | { state: 'idle' | 'sending' }
  | { state: 'done'; robots: RobotOrder[] }
  /** `isOver`: refused, as the session had ended: the one who sees it is at the sign-in. */
  | { state: 'failed'; detail: string; isOver: boolean };

class StopAll {
  result = $state<StopResult>({ state: 'idle' });
  private last = 0;

  async send(): Promise<void> {
    const mine = ++this.last;
    this.result = { state: 'sending' };
    const result = await this.order();
    if (mine === this.last) this.result = result;
  }

  dismiss(): void {
    this.result = { state: 'idle' };
  }

  private async order(): Promise<StopResult> {
    try {
      const answer = await api.post<{ robots: RobotOrder[] }>('/api/v1/stop', {
        idempotencyKey: newKey(),
        signal: AbortSignal.timeout(8000),
      });
      return { state: 'done', robots: answer.robots };
    } catch (error) {
      return { state: 'failed', detail: error instanceof Problem ? error.detail : String(error), isOver: api.isOver(error) };
    }
  }
}

export const stopAll = new StopAll();

/** Shift+Esc: no view uses it, no browser takes it from the page, and one hand finds it without looking. */
export function isStopKey(event: KeyboardEvent): boolean {
  return event.key === 'Escape' && event.shiftKey && !event.ctrlKey && !event.altKey && !event.metaKey && !event.repeat;
}
