/** What a hand wants, whatever it holds: keys, a stick, a gamepad or sliders; and the speeds that this means for a part. */
import type { Drivable } from '../api/types';

/** A share of the highest speed for each axis, -1 to 1; an axis that is not named stands. */
export type Wish = Record<string, number>;

export const STAND: Wish = {};

const KEYS = new Map<string, [axis: string, sign: number]>([
  ['KeyW', ['x', 1]], ['ArrowUp', ['x', 1]],
  ['KeyS', ['x', -1]], ['ArrowDown', ['x', -1]],
  ['KeyA', ['y', 1]], ['ArrowLeft', ['y', 1]],
  ['KeyD', ['y', -1]], ['ArrowRight', ['y', -1]],
  ['KeyQ', ['yaw', 1]],
  ['KeyE', ['yaw', -1]],
  ['KeyR', ['z', 1]], ['PageUp', ['z', 1]],
  ['KeyF', ['z', -1]], ['PageDown', ['z', -1]],
]);

/** Less of a stick than this is no wish: it does not rest exactly in its middle. */
const DEAD = 0.12;

export function isDriveKey(code: string): boolean {
  return KEYS.has(code);
}

function bounded(share: number): number {
  return Number.isFinite(share) ? Math.max(-1, Math.min(1, share)) : 0;
}

/** Sideways of a part that cannot move sideways is a turn, as a car's wheel has it. */
function axisFor(axis: string, part: Drivable): string | null {
  if (part.axes.includes(axis)) return axis;
  return axis === 'y' && part.axes.includes('yaw') ? 'yaw' : null;
}

function add(wish: Wish, part: Drivable, axis: string, share: number): void {
  const has = axisFor(axis, part);
  if (has !== null && share !== 0) wish[has] = bounded((wish[has] ?? 0) + share);
}

/** Physical keys, so that they lie alike on every keyboard. */
export function wishOfKeys(held: Iterable<string>, part: Drivable): Wish {
  const wish: Wish = {};
  const sums = new Map<string, number>();
  for (const code of held) {
    const [axis, sign] = KEYS.get(code) ?? ['', 0];
    if (sign !== 0) sums.set(axis, (sums.get(axis) ?? 0) + sign);
  }
  for (const [axis, sum] of sums) add(wish, part, axis, Math.sign(sum));
  return wish;
}

/** Beyond the dead middle it begins at 0. */
export function shareOf(stick: number): number {
  const far = Math.abs(bounded(stick));
  return far < DEAD ? 0 : Math.sign(stick) * ((far - DEAD) / (1 - DEAD));
}

/** A stick from its middle: `right` and `up` from -1 to 1. */
export function wishOfStick(right: number, up: number, part: Drivable): Wish {
  const wish: Wish = {};
  add(wish, part, 'x', shareOf(up));
  add(wish, part, 'y', -shareOf(right));
  return wish;
}

export interface Pad {
  axes: readonly number[];
  buttons: readonly { pressed: boolean }[];
}

/** W3C's standard mapping: left stick moves, right stick turns and lifts. A shoulder button must be held. */
export function isHeld(pad: Pad): boolean {
  return [4, 5, 6, 7].some((button) => pad.buttons[button]?.pressed ?? false);
}

export function wishOfPad(pad: Pad, part: Drivable): Wish {
  if (!isHeld(pad)) return STAND;
  const wish = wishOfStick(pad.axes[0] ?? 0, -(pad.axes[1] ?? 0), part);
  add(wish, part, 'yaw', -shareOf(pad.axes[2] ?? 0));
  add(wish, part, 'z', -shareOf(pad.axes[3] ?? 0));
  return wish;
}

/** Several hands at once: the wishes add up. */
export function together(...wishes: Wish[]): Wish {
  const out: Wish = {};
  for (const wish of wishes) {
    for (const [axis, share] of Object.entries(wish)) out[axis] = bounded((out[axis] ?? 0) + share);
  }
  return out;
}

export function isStanding(wish: Wish): boolean {
  return Object.values(wish).every((share) => share === 0);
}

/** In the order of the part's axes. `limit` of their highest speeds, 0 to 1. */
export function speedsOf(wish: Wish, part: Drivable, limit: number): number[] {
  const share = Math.max(0, bounded(limit));
  return part.axes.map((axis, i) => bounded(wish[axis] ?? 0) * share * (part.limits[i] ?? 0) || 0);
}
