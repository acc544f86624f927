/** Drives one robot from this page: hands and the clock around Drive, over the live stream. */
import { onDestroy } from 'svelte';
import type { Drivable } from '../../lib/api/types';
import { Drive, type DriveState, type Latency } from '../../lib/drive/drive';
import { Hands } from '../../lib/drive/hands';
import { ramped } from '../../lib/drive/ramp';
import { isStanding, speedsOf, type Pad } from '../../lib/drive/wish';
import { t } from '../../lib/i18n/i18n.svelte';
import { live } from '../../lib/live/live.svelte';

const TICK_MS = 20;
const FIRST_LIMIT = 0.3;

export class Driver {
  state = $state<DriveState>('idle');
  robot = $state('');
  why = $state('');
  latency = $state.raw<Latency | null>(null);
  /** What was sent last. */
  speeds = $state.raw<number[]>([]);
  hasPad = $state(false);
  /** Share of the highest speeds. */
  limit = $state(FIRST_LIMIT);

  private readonly hands = new Hands();
  private readonly drive = new Drive();
  private part: Drivable | null = null;
  private ramp: number[] = [];
  private tickedAt = 0;

  /** While the component that calls it is shown. */
  constructor() {
    const timer = setInterval(() => this.tick(), TICK_MS);
    const unheard = live.onDrive((answer) => {
      this.drive.heard(answer, performance.now());
      this.show();
    });
    onDestroy(() => {
      clearInterval(timer);
      unheard();
      this.letGo();
    });
  }

  begin(robot: string, part: Drivable, take: boolean): void {
    this.stand();
    this.part = part;
    this.say(this.drive.begin(robot, part.part, take, performance.now()));
  }

  letGo(): void {
    this.stand();
    this.say(this.drive.letGo());
  }

  /** Zero at once, whatever is held. */
  stand(): void {
    this.hold((hands) => hands.drop());
  }

  /** Something is held, or let go: told at once. */
  hold(change: (hands: Hands) => void): void {
    change(this.hands);
    this.tick();
  }

  private tick(): void {
    const now = performance.now();
    if (this.drive.state === 'idle' || this.part === null) return;
    if (live.isLost) this.drive.lost(t('shell.lost'));
    this.ramp = ramped(this.ramp, this.wanted(this.part), this.part.limits, now - this.tickedAt);
    this.tickedAt = now;
    this.say(this.drive.tick(this.ramp, now));
  }

  private wanted(part: Drivable): number[] {
    const wish = this.hands.wish(part, this.pad());
    return isStanding(wish) ? part.axes.map(() => 0) : speedsOf(wish, part, this.limit);
  }

  /** A gamepad is nobody's hand while the page has no focus. */
  private pad(): Pad | null {
    const pad = navigator.getGamepads().find((one) => one !== null && one.mapping === 'standard') ?? null;
    this.hasPad = pad !== null;
    return document.hasFocus() ? pad : null;
  }

  private say(words: string[]): void {
    for (const word of words) live.say(word);
    this.show();
  }

  private show(): void {
    const { state, robot, why, latency, speeds } = this.drive;
    this.state = state;
    this.robot = robot;
    this.why = why === 'timeout' ? t('control.noAnswer') : why;
    this.latency = latency;
    if (this.speeds.join() !== speeds.join()) this.speeds = speeds;
  }
}
