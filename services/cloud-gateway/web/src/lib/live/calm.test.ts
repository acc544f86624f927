import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Calm } from './calm';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test('the first value comes at once, then the newest of each half second', () => {
  const shown: number[] = [];
  const calm = new Calm<number>((value) => shown.push(value));
  calm.take(1, 500, 0);
  for (let i = 2; i <= 5; i++) calm.take(i, 500, i * 10);
  expect(shown).toEqual([1]);
  vi.advanceTimersByTime(480);
  expect(shown).toEqual([1, 5]);
  calm.take(6, 500, 510);
  vi.advanceTimersByTime(490);
  expect(shown).toEqual([1, 5, 6]);
});

test('after a quiet time, and without a wait, a value comes at once', () => {
  const shown: number[] = [];
  const calm = new Calm<number>((value) => shown.push(value));
  calm.take(1, 500, 0);
  calm.take(2, 500, 600);
  calm.take(3, 0, 610);
  expect(shown).toEqual([1, 2, 3]);
});

test('a value that came at once replaces one that waited, and what is stopped shows nothing more', () => {
  const shown: number[] = [];
  const calm = new Calm<number>((value) => shown.push(value));
  calm.take(1, 500, 0);
  calm.take(2, 500, 10);
  calm.take(3, 0, 20);
  vi.advanceTimersByTime(1000);
  expect(shown).toEqual([1, 3]);
  calm.take(4, 500, 30);
  calm.stop();
  vi.advanceTimersByTime(1000);
  expect(shown).toEqual([1, 3]);
});
