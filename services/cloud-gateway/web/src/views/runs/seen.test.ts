import { expect, it } from 'vitest';
import type { TaskView } from '../../lib/api/types';
import { isStill, seenOf } from './seen';

it('counts a word on a robot for this robot and this attempt alone', () => {
  const task = { id: 'go', robot: 'a', attempt: 1 } as TaskView;
  const seen = seenOf(task);
  expect(isStill(seen, { ...task, state: 'FAILED' })).toBe(true);
  expect([{ robot: 'b' }, { attempt: 2 }, { id: 'grab' }].map((change) => isStill(seen, { ...task, ...change }))).toEqual([false, false, false]);
});
