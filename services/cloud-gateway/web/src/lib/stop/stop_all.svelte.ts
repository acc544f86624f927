/**
 * Stops every robot. It depends on nothing else of the page: a request of its own that waits for no other, the key is
 * heard before any view hears it, and a second press sends a second stop. Not a safety function.
 */
import { api, newKey, Problem } from '../api/client';
import type { RobotContent, RobotOrder, Row } from '../api/types';
import { live } from '../live/live.svelte';
import { StopCourse, type StopSince } from './stop_course';

/** That all robots are released is told for so long. */
const OVER_MS = 60000;

export type StopResult =
  | { state: 'idle' | 'sending' }
  /** `at`: when it was answered, UTC ms. */
  | { state: 'done'; at: number; robots: RobotOrder[] }
  /** `isOver`: refused, as the session had ended: the one who sees it is at the sign-in. */
  | { state: 'failed'; detail: string; isOver: boolean };

class StopAll {
  result = $state<StopResult>({ state: 'idle' });
  /** What has become of it since; nothing: nobody has looked yet. */
  since = $state.raw<StopSince>();
  private course: StopCourse | null = null;
  private overSince: number | null = null;
  private last = 0;

  async send(): Promise<void> {
    const mine = ++this.last;
    this.begin({ state: 'sending' });
    const result = await this.order();
    if (mine === this.last) this.begin(result);
  }

  /** The robots' rows, at `now` (ms); `isLive`: they are all there is, and of now. A stop that is over is told, and then goes. */
  see(rows: Row<RobotContent>[], now: number, isLive: boolean): void {
    if (this.course === null) return;
    this.course.see(rows, now, isLive);
    this.since = this.course.since;
    this.overSince = this.since.isOver ? (this.overSince ?? now) : null;
    if (this.overSince !== null && now - this.overSince > OVER_MS) this.dismiss();
  }

  dismiss(): void {
    this.begin({ state: 'idle' });
  }

  private begin(result: StopResult): void {
    this.result = result;
    this.since = undefined;
    this.overSince = null;
    this.course = result.state === 'done' ? new StopCourse(result.robots) : null;
  }

  private async order(): Promise<StopResult> {
    try {
      const answer = await api.post<{ robots: RobotOrder[] }>('/api/v1/stop', {
        idempotencyKey: newKey(),
        signal: AbortSignal.timeout(8000),
      });
      return { state: 'done', at: live.utcMs(), robots: answer.robots };
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
