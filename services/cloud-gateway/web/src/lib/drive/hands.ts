/** What is held at this moment: keys, sticks, sliders, a gamepad. Nothing held: everything stands. */
import type { Drivable } from '../api/types';
import { isDriveKey, STAND, together, wishOfKeys, wishOfPad, wishOfStick, type Pad, type Wish } from './wish';

/** Of a stick on the screen. */
export interface Lever {
  right: number;
  up: number;
}

export class Hands {
  private readonly keys = new Set<string>();
  private move: Lever | null = null;
  private turn: Lever | null = null;
  private readonly sliders = new Map<string, number>();

  /** True: it is a key that drives. A key that repeats by itself is no new wish: after `drop` it has to be pressed anew. */
  press(code: string, isRepeat: boolean): boolean {
    if (!isDriveKey(code)) return false;
    if (!isRepeat) this.keys.add(code);
    return true;
  }

  release(code: string): void {
    this.keys.delete(code);
  }

  /** The stick that moves; null: it is let go. */
  setMove(lever: Lever | null): void {
    this.move = lever;
  }

  /** The stick that turns and lifts. */
  setTurn(lever: Lever | null): void {
    this.turn = lever;
  }

  setSlider(axis: string, share: number): void {
    if (share === 0) this.sliders.delete(axis);
    else this.sliders.set(axis, share);
  }

  /** Everything is let go. */
  drop(): void {
    this.keys.clear();
    this.sliders.clear();
    this.move = null;
    this.turn = null;
  }

  wish(part: Drivable, pad: Pad | null): Wish {
    const { move, turn } = this;
    return together(
      wishOfKeys(this.keys, part),
      move ? wishOfStick(move.right, move.up, part) : STAND,
      turn ? wishOfTurn(turn, part) : STAND,
      Object.fromEntries([...this.sliders].filter(([axis]) => part.axes.includes(axis))),
      pad ? wishOfPad(pad, part) : STAND,
    );
  }
}

/** As the right stick of a gamepad. */
function wishOfTurn({ right, up }: Lever, part: Drivable): Wish {
  const buttons = Array.from({ length: 6 }, () => ({ pressed: true }));
  return wishOfPad({ axes: [0, 0, right, -up], buttons }, part);
}
