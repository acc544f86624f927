/**
 * The page's side of driving a robot, without a socket or a clock: words and times in, words to send out.
 *
 * | State   | Event                              | Does                                        | Next    |
 * |---------|------------------------------------|---------------------------------------------|---------|
 * | idle    | begin                              | word 1: the robot stands                    | asking  |
 * | asking  | driving                            |                                             | driving |
 * | asking  | over                               | why                                         | idle    |
 * | asking  | 2 s without an answer              | lets go                                     | idle    |
 * | driving | speeds, somebody holds something   | a word each 50 ms                           | driving |
 * | driving | nothing is held                    | zeros: at once, then each 200 ms, which     | driving |
 * |         |                                    | keeps the robot                             |         |
 * | driving | over (taken, silent, refused)      | why                                         | idle    |
 * | any     | let go; the page is hidden or left | lets go                                     | idle    |
 * | any     | the stream is lost                 | nothing: the gateway ends the drive         | idle    |
 *
 * Nobody holds anything: no speed but zero is sent. Nothing that waits is sent later: a word is made when it is sent.
 */
import type { DriveAnswer } from '../api/types';

export type DriveState = 'idle' | 'asking' | 'driving';

const MOVING_MS = 50;
const STANDING_MS = 200;
const ANSWER_MS = 2000;
const MOST_UNANSWERED = 64;

export interface Latency {
  /** Page - gateway, there and back. */
  page: number;
  /** Gateway - robot's node, there and back. */
  robot: number;
}

export class Drive {
  state: DriveState = 'idle';
  robot = '';
  part = '';
  /** Why the last drive is over or did not begin; empty: it was let go. */
  why = '';
  /** Milliseconds; nothing: not known yet. */
  latency: Latency | null = null;
  /** The speeds of the last word. */
  speeds: number[] = [];

  private sequence = 0;
  private sentAt = -Infinity;
  private begunAt = 0;
  private readonly unanswered = new Map<number, number>();

  /** Words to send. */
  begin(robot: string, part: string, take: boolean, now: number): string[] {
    const before = this.letGo();
    this.state = 'asking';
    this.robot = robot;
    this.part = part;
    this.why = '';
    this.latency = null;
    this.sequence = 0;
    this.begunAt = now;
    return [...before, this.word([], now, take)];
  }

  letGo(): string[] {
    if (this.state === 'idle') return [];
    this.end('');
    return [JSON.stringify({ let_go: this.robot })];
  }

  lost(why: string): void {
    if (this.state !== 'idle') this.end(why);
  }

  /** Call it often; `speeds`: what is held now, empty if nothing is. */
  tick(speeds: readonly number[], now: number): string[] {
    if (this.state === 'idle') return [];
    if (this.state === 'asking') {
      if (now - this.begunAt >= ANSWER_MS) {
        const words = this.letGo();
        this.why = 'timeout';
        return words;
      }
      return now - this.sentAt >= STANDING_MS ? [this.word([], now)] : [];
    }
    const isMoving = speeds.some((speed) => speed !== 0);
    const wasMoving = this.speeds.some((speed) => speed !== 0);
    const waited = now - this.sentAt;
    const isDue = isMoving ? waited >= MOVING_MS : wasMoving || waited >= STANDING_MS;
    return isDue ? [this.word(isMoving ? [...speeds] : [], now)] : [];
  }

  heard(answer: DriveAnswer, now: number): void {
    if (answer.robot !== this.robot || this.state === 'idle' || answer.sequence > this.sequence) return;
    // What was said of an earlier drive is no answer to this one.
    const sent = this.unanswered.get(answer.sequence);
    if (answer.state === 'over') {
      if (sent !== undefined || this.state === 'driving') this.end(answer.error?.detail ?? '');
      return;
    }
    if (sent === undefined || answer.error !== undefined) return;
    for (const sequence of this.unanswered.keys()) if (sequence <= answer.sequence) this.unanswered.delete(sequence);
    const robot = answer.round_trip_s * 1000;
    this.latency = { page: Math.max(0, now - sent - robot), robot };
    this.state = 'driving';
  }

  private word(speeds: number[], now: number, take = false): string {
    this.sentAt = now;
    this.speeds = speeds;
    this.unanswered.set(++this.sequence, now);
    if (this.unanswered.size > MOST_UNANSWERED) this.unanswered.delete(this.unanswered.keys().next().value!);
    const word = { drive: this.robot, part: this.part, speeds, sequence: this.sequence };
    return JSON.stringify(take ? { ...word, take } : word);
  }

  private end(why: string): void {
    this.state = 'idle';
    this.why = why;
    this.speeds = [];
    this.latency = null;
    this.unanswered.clear();
  }
}
