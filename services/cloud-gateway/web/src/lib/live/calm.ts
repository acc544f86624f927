/** Lets through the newest of many values, no two within a wait. The last one always comes through. */
export class Calm<Value> {
  private timer: ReturnType<typeof setTimeout> | undefined;
  private newest: Value | undefined;
  private shownAt = -Infinity;

  constructor(private readonly show: (value: Value) => void) {}

  take(value: Value, wait: number, now: number): void {
    this.newest = value;
    const left = this.shownAt + wait - now;
    if (left <= 0) this.pass(now);
    else this.timer ??= setTimeout(() => this.pass(now + left), left);
  }

  stop(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
  }

  private pass(now: number): void {
    this.stop();
    this.shownAt = now;
    this.show(this.newest as Value);
  }
}
