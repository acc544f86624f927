import { expect, it } from 'vitest';
import { commanderOf } from './control';

it('tells a run by the beginning of its id, a node by its name', () => {
  const run = '0123456789abcdef0123456789abcdef';
  expect(commanderOf(`run ${run}`)).toEqual({ text: 'run 01234567', run });
  expect(commanderOf('ur3')).toEqual({ text: 'ur3', run: null });
  expect(commanderOf('run away')).toEqual({ text: 'run away', run: null });
  expect(commanderOf('')).toBeNull();
});
