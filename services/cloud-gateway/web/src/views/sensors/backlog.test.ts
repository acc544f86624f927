import { expect, it } from 'vitest';
import { Backlog, MOST_READ, type StoredPage } from './backlog';
import type { Point } from './series';

const PAGE = 1000;

/** A gateway that has a value of each second from `first` to 99,999. */
function stored(first: number) {
  const asked: string[] = [];
  const ask = async (cursor: string): Promise<StoredPage> => {
    asked.push(cursor);
    const end = cursor === '' ? 100_000 : Number(cursor);
    const begin = Math.max(first, end - PAGE);
    const points = Array.from({ length: end - begin }, (_, i) => ({ time: begin + i, value: 1 }));
    return { points, count: points.length, oldest: points[0]?.time ?? null, next: begin > first ? String(begin) : '' };
  };
  return { ask, asked };
}

function reader(ask: (cursor: string) => Promise<StoredPage>) {
  const given: Point[] = [];
  const backlog = new Backlog(ask, (points) => given.push(...points));
  return { backlog, given };
}

it('reads further pages until the window begins', async () => {
  const { ask, asked } = stored(0);
  const { backlog, given } = reader(ask);
  await backlog.reach(99_940);
  expect(asked).toEqual(['']);
  await backlog.reach(96_400);
  expect(asked).toEqual(['', '99000', '98000', '97000']);
  expect(given).toHaveLength(4000);
  expect(backlog.since).toBe(96_000);
  await backlog.reach(96_500);
  expect(asked).toHaveLength(4);
});

it('ends where nothing older is stored: then all of the window is there', async () => {
  const { backlog } = reader(stored(98_500).ask);
  await backlog.reach(0);
  expect(backlog.since).toBe(-Infinity);
});

it('ends at so many values, and says since when they are', async () => {
  const { ask, asked } = stored(0);
  const { backlog, given } = reader(ask);
  await backlog.reach(0);
  await backlog.reach(-1);
  expect(given).toHaveLength(MOST_READ);
  expect(asked).toHaveLength(MOST_READ / PAGE);
  expect(backlog.since).toBe(100_000 - MOST_READ);
});

it('reads one page at a time, and as far as the last wish wants', async () => {
  const { ask, asked } = stored(0);
  const { backlog } = reader(ask);
  await Promise.all([backlog.reach(99_940), backlog.reach(97_500)]);
  expect(asked).toEqual(['', '99000', '98000']);
});

it('does not ask again and again for what is refused, but once with each wish', async () => {
  let count = 0;
  const { backlog } = reader(async () => {
    ++count;
    throw new Error('no history');
  });
  await backlog.reach(0);
  expect(backlog.since).toBe(Infinity);
  await backlog.reach(0);
  expect(count).toBe(2);
});
