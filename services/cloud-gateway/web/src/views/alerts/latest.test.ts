import { expect, it } from 'vitest';
import { Latest } from './latest';

it('sends one wish at a time, and of those that come meanwhile the last', async () => {
  const sent: number[] = [];
  const ends: (() => void)[] = [];
  const send = (wish: number) => new Promise<void>((end) => (sent.push(wish), ends.push(end)));
  const latest = new Latest<number>(send, () => Promise.resolve());
  const all = latest.want(1);
  void latest.want(2);
  void latest.want(3);
  expect(sent).toEqual([1]);
  ends[0]!();
  await Promise.resolve().then(() => Promise.resolve()).then(() => Promise.resolve());
  expect(sent).toEqual([1, 3]);
  void latest.want(4);
  latest.drop(); // the view was left
  ends[1]!();
  await all;
  expect(sent).toEqual([1, 3]);
});
