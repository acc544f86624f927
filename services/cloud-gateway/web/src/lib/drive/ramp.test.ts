import { expect, it } from 'vitest';
import { ramped } from './ramp';

const full = [0.5, 2];

it('rises over a moment', () => {
  expect(ramped([0, 0], [0.5, -2], full, 100)).toEqual([0.125, -0.5]);
  expect(ramped([0.45, -1.9], [0.5, -2], full, 100)).toEqual([0.5, -2]);
});

it('falls at once', () => {
  expect(ramped([0.5, -2], [0, -0.5], full, 1)).toEqual([0, -0.5]);
});

it('turns round by way of standing', () => {
  expect(ramped([0.5, 0], [-0.5, 0], full, 40)).toEqual([-0.05, 0]);
});

it('goes nowhere in no time, nor without a limit', () => {
  expect(ramped([0.1], [0.5], [0.5], 0)).toEqual([0.1]);
  expect(ramped([0], [0.5], [0.5], -5)).toEqual([0]);
  expect(ramped([], [1], [], 50)).toEqual([0]);
});
