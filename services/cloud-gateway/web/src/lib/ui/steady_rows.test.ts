import { describe, expect, it } from 'vitest';
import { AIMED_MS, SteadyRows } from './steady_rows';

const steady = () => new SteadyRows<string>((item) => item);

describe('rows with buttons', () => {
  it('follow their order while nobody is at them', () => {
    const rows = steady();
    expect(rows.next(['a', 'b'], false, 'x', 0)).toEqual(['a', 'b']);
    expect(rows.next(['c', 'b', 'a'], false, 'x', 1)).toEqual(['c', 'b', 'a']);
  });

  it('stay where they are while somebody is, and what is new stands at the end', () => {
    const rows = steady();
    rows.next(['a', 'b', 'c'], false, 'x', 0);
    expect(rows.next(['new', 'c', 'a', 'b'], true, 'x', 1)).toEqual(['a', 'b', 'c', 'new']);
    expect(rows.next(['newer', 'new', 'c', 'a'], true, 'x', 2)).toEqual(['a', 'c', 'new', 'newer']);
    expect(rows.next(['newer', 'new', 'c', 'a'], false, 'x', 3)).toEqual(['newer', 'new', 'c', 'a']);
  });

  it('are sorted anew by who is at them', () => {
    const rows = steady();
    rows.next(['a', 'b'], true, 'x', 0);
    expect(rows.next(['b', 'a'], true, 'y', 1)).toEqual(['b', 'a']);
  });

  it('that came under the hand just now are not pressed', () => {
    const rows = steady();
    rows.next(['a', 'b'], false, 'x', 1000);
    expect(['a', 'b'].map((key) => rows.hasJustMoved(key, 1000))).toEqual([false, false]); // nothing was there before
    rows.next(['b', 'c'], true, 'x', 2000); // 'a' is over, and 'b' took its place, 'c' that of 'b'
    expect(['b', 'c'].map((key) => rows.hasJustMoved(key, 2000 + AIMED_MS - 1))).toEqual([true, true]);
    expect(['b', 'c'].map((key) => rows.hasJustMoved(key, 2000 + AIMED_MS))).toEqual([false, false]);
    rows.next(['b', 'c', 'd'], true, 'x', 3000);
    expect(['b', 'd'].map((key) => rows.hasJustMoved(key, 3001))).toEqual([false, false]); // the place of 'd' was free
  });
});
