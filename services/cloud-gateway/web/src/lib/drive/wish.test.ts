import { describe, expect, it } from 'vitest';
import type { Drivable } from '../api/types';
import { isDriveKey, isStanding, shareOf, speedsOf, together, wishOfKeys, wishOfPad, wishOfStick } from './wish';

const rover: Drivable = { part: 'base', axes: ['x', 'yaw'], limits: [0.5, 1] };
const drone: Drivable = { part: 'base', axes: ['x', 'y', 'z', 'yaw'], limits: [1, 1, 0.5, 2] };
const belt: Drivable = { part: 'belt', axes: ['x'], limits: [0.3] };

function pad(axes: number[], ...pressed: number[]) {
  return { axes, buttons: Array.from({ length: 16 }, (_, i) => ({ pressed: pressed.includes(i) })) };
}

describe('keys', () => {
  it('drive what has the axis', () => {
    expect(wishOfKeys(['KeyW', 'KeyQ'], rover)).toEqual({ x: 1, yaw: 1 });
    expect(wishOfKeys(['ArrowDown'], belt)).toEqual({ x: -1 });
    expect(wishOfKeys(['KeyR', 'KeyQ'], belt)).toEqual({});
  });

  it('turn what cannot move sideways', () => {
    expect(wishOfKeys(['KeyA'], drone)).toEqual({ y: 1 });
    expect(wishOfKeys(['ArrowLeft'], rover)).toEqual({ yaw: 1 });
    expect(wishOfKeys(['KeyD', 'KeyE'], rover)).toEqual({ yaw: -1 });
  });

  it('against each other stand, and two for one are one', () => {
    expect(isStanding(wishOfKeys(['KeyW', 'KeyS'], rover))).toBe(true);
    expect(wishOfKeys(['KeyW', 'ArrowUp'], rover)).toEqual({ x: 1 });
  });

  it('that are none of these are nothing', () => {
    expect(wishOfKeys(['KeyX', 'constructor', 'Escape'], drone)).toEqual({});
    expect(isDriveKey('KeyX')).toBe(false);
    expect(isDriveKey('ArrowUp')).toBe(true);
  });
});

describe('a stick', () => {
  it('rests in its middle, and is whole at its edge', () => {
    expect(wishOfStick(0.05, -0.1, drone)).toEqual({});
    expect(wishOfStick(-1, 1, drone)).toEqual({ x: 1, y: 1 });
    expect(wishOfStick(1, 0, rover)).toEqual({ yaw: -1 });
  });

  it('has no jump at the edge of its middle, and no more than all', () => {
    expect(shareOf(0.121)).toBeLessThan(0.01);
    expect(shareOf(-3)).toBe(-1);
    expect(shareOf(Number.NaN)).toBe(0);
  });
});

describe('a gamepad', () => {
  it('does nothing unless a shoulder button is held', () => {
    expect(wishOfPad(pad([0, -1, 1, 0]), drone)).toEqual({});
    expect(wishOfPad(pad([0, -1, 1, 0], 5), drone)).toEqual({ x: 1, yaw: -1 });
    expect(wishOfPad(pad([0, 0, 0, -1], 4), drone)).toEqual({ z: 1 });
    expect(wishOfPad({ axes: [], buttons: [] }, drone)).toEqual({});
  });
});

describe('speeds', () => {
  it('are in the order of the axes, within limit and bounds', () => {
    expect(speedsOf({ yaw: -1, x: 0.5 }, rover, 0.5)).toEqual([0.125, -0.5]);
    expect(speedsOf({ x: 9 }, belt, 9)).toEqual([0.3]);
    expect(speedsOf({ x: 1 }, rover, Number.NaN)).toEqual([0, 0]);
    expect(speedsOf({ x: 1 }, { part: 'base', axes: ['x', 'y'], limits: [1] }, 1)).toEqual([1, 0]);
  });

  it('of several hands add up', () => {
    expect(together({ x: 0.7 }, { x: 0.7, yaw: -0.2 }, {})).toEqual({ x: 1, yaw: -0.2 });
  });
});
