import { expect, it } from 'vitest';
import { uniqueKeys } from './keys';

it('gives each row a key of its own, the first one its wish', () => {
  expect(uniqueKeys(['a', 'b', 'a', 'a'])).toEqual(['a', 'b', 'a\n1', 'a\n2']);
  expect(new Set(uniqueKeys(['a', 'a', 'a\n1'])).size).toBe(3);
});
