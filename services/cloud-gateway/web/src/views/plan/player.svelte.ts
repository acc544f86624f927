/** Plays a film: its time goes on while it plays, in small steps, or for who wants less motion once a second. */
import { calmMotion } from '../../lib/calm_motion.svelte';

export const SPEEDS = ['0.5', '1', '2', '5', '10', '60'] as const;
export type Speed = (typeof SPEEDS)[number];
const LONGEST_S = 40;
const CALM_MS = 1000;

/** The slowest by which it takes no longer than somebody likes to look. */
export function speedFor(end: number): Speed {
  return SPEEDS.slice(1).find((speed) => end / Number(speed) <= LONGEST_S) ?? '60';
}

export class Player {
  time = $state(0);
  isPlaying = $state(false);
  speed = $state<Speed>('1');
  private frame = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private before = 0;

  constructor(private readonly end: number) {
    this.speed = speedFor(end);
  }

  play(): void {
    if (this.time >= this.end) this.time = 0;
    this.isPlaying = true;
    this.before = performance.now();
    if (calmMotion.isWanted) this.timer = setInterval(() => this.pass(performance.now()), CALM_MS);
    else this.frame = requestAnimationFrame((now) => this.draw(now));
  }

  pause(): void {
    this.isPlaying = false;
    cancelAnimationFrame(this.frame);
    clearInterval(this.timer);
  }

  /** To a time; it stands there. */
  show(time: number): void {
    this.pause();
    this.time = Math.min(Math.max(0, time), this.end);
  }

  private draw(now: number): void {
    this.pass(now);
    if (this.isPlaying) this.frame = requestAnimationFrame((next) => this.draw(next));
  }

  private pass(now: number): void {
    // After a while in another tab it goes on where it was.
    const passed = Math.min(Math.max(0, now - this.before), 2 * CALM_MS) / 1000;
    this.before = now;
    this.time = Math.min(this.end, this.time + passed * Number(this.speed));
    if (this.time >= this.end) this.pause();
  }
}
