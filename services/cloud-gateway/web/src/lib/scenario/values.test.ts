import { expect, it } from 'vitest';
import { numberOrText, textIn, valueIn } from './values';

it('reads numbers with a comma, and keeps what is none', () => {
  expect(['1,5', ' 2 ', '1e3', '', '  ', ' soon'].map(numberOrText)).toEqual([1.5, 2, 1000, undefined, undefined, 'soon']);
});

it('tells a text of digits from a number, and back', () => {
  for (const value of ['00123', '0x1F', '123', '', '"x"', ' x ', 'open', 7, -1.5, 1e21]) expect(valueIn(textIn(value))).toBe(value);
  expect(['00123', '"7"', '7', '-1,5', 'E2-07'].map(valueIn)).toEqual(['00123', '7', 7, -1.5, 'E2-07']);
});
