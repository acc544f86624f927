/** The values of one sensor that a chart shows: oldest first, each moment once, only so many. */
export interface Point {
  /** UTC, s. */
  time: number;
  value: number;
}

export interface Span {
  least: number;
  most: number;
  mean: number;
}

export const MOST_POINTS = 20_000;

/** The later of two values of one moment counts. */
export function joined(points: readonly Point[], more: readonly Point[]): Point[] {
  const last = points.at(-1);
  const isBehind = more.every((one, i) => one.time > (i === 0 ? (last?.time ?? -Infinity) : more[i - 1]!.time));
  if (isBehind) return [...points, ...more].slice(-MOST_POINTS);
  const byTime = new Map([...points, ...more].map((one) => [one.time, one]));
  return [...byTime.values()].sort((a, b) => a.time - b.time).slice(-MOST_POINTS);
}

/** Since when none is missing, of values that were stored since `since`: too many push the oldest out. */
export function wholeSince(points: readonly Point[], since: number): number {
  return points.length < MOST_POINTS ? since : Math.max(since, points[0]!.time);
}

export function since(points: readonly Point[], time: number): Point[] {
  return points.filter((one) => one.time >= time);
}

export function spanOf(points: readonly Point[]): Span | null {
  if (points.length === 0) return null;
  let [least, most, sum] = [Infinity, -Infinity, 0];
  for (const { value } of points) {
    least = Math.min(least, value);
    most = Math.max(most, value);
    sum += value;
  }
  return { least, most, mean: sum / points.length };
}
