import { describe, expect, it } from 'vitest';
import { linkOf, linkWishOf, newLink, placeOfLink, wrongsOfLink, type LinkField, type LinkKind, type LinkWish } from './link_wish';

const wish = (kind: LinkKind, texts: Partial<Record<LinkField, string>> = {}): LinkWish => ({ kind, texts: { ...newLink(kind).texts, ...texts } });

describe('a wished network', () => {
  it('has a name, or is described: milliseconds, percent, kB a second', () => {
    expect(linkOf(wish('vpn'))).toBe('vpn');
    expect(linkOf(wish('own', { delay: '20', deviation: '5', loss: '0.1', rate: '500' }))).toEqual(
      { delay_s: 0.02, deviation_s: 0.005, loss: 0.001, bytes_a_second: 500_000 });
    expect(linkOf(wish('own', { deviation: '' }))).toEqual({ delay_s: 0.02 });
    expect(linkOf(wish('measured', { delays: '18 21,5\n400' }))).toEqual({ delays_s: [0.018, 0.0215, 0.4] });
  });

  it('comes back from a job as it was', () => {
    for (const one of [wish('wifi'), wish('own', { loss: '0.3' }), wish('measured', { delays: '18 400', rate: '20' })]) {
      expect(linkOf(linkWishOf(linkOf(one)))).toEqual(linkOf(one));
    }
    expect(linkWishOf(undefined).kind).toBe('lan');
  });

  it('says by its field what is wrong', () => {
    expect(wrongsOfLink(wish('own'))).toEqual({});
    expect(wrongsOfLink(wish('lan', { delay: 'x' }))).toEqual({});
    expect(wrongsOfLink(wish('own', { delay: '' }))).toEqual({ delay: { why: 'missing' } });
    expect(wrongsOfLink(wish('own', { delay: '4', deviation: '5' }))).toEqual({ deviation: { why: 'deviation' } });
    expect(wrongsOfLink(wish('own', { loss: '51' }))).toEqual({ loss: { why: 'between', min: 0, max: 50 } });
    for (const delays of ['', 'a', '-1', '20000', '1 '.repeat(10_001)]) {
      expect(wrongsOfLink(wish('measured', { delays }))).toEqual({ delays: { why: 'delays' } });
    }
    expect(placeOfLink('/link/bytes_a_second')).toBe('rate');
    expect(placeOfLink('/link/delays_s/3')).toBe('delays');
    expect(placeOfLink('/seed')).toBeNull();
  });
});
