/** Speeds rise over a moment, so that a key is no jolt; they fall at once. */

/** From standing to full speed. */
const RISE_MS = 400;

/** The speeds after `ms`, from `now` towards `wanted`; `full`: the highest of each. */
export function ramped(now: readonly number[], wanted: readonly number[], full: readonly number[], ms: number): number[] {
  return wanted.map((goal, i) => {
    const from = now[i] ?? 0;
    const turned = from * goal < 0 ? 0 : from; // the other way begins at standing
    if (Math.abs(goal) <= Math.abs(turned)) return goal;
    const step = ((full[i] ?? 0) * Math.max(0, ms)) / RISE_MS;
    return Math.abs(goal - turned) <= step ? goal : turned + Math.sign(goal) * step;
  });
}
