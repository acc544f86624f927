import { expect, it } from 'vitest';
import { keyOf, placeOf, sortFaults } from './faults';

const fault = (pointer: string) => ({ pointer, detail: 'wrong', hint: 'mend it', warning: false });

it('finds the task that a fault belongs to', () => {
  expect(placeOf('/tasks/3/skill')).toBe(3);
  expect(placeOf('/scenario/tasks/12')).toBe(12);
  expect(placeOf('/name')).toBeNull();
  expect(placeOf('/tasks')).toBeNull();
  expect(keyOf('/tasks/3/data/place')).toBe('data/place');
});

it('sorts faults by task, the rest apart', () => {
  const sorted = sortFaults([fault('/tasks/1/skill'), fault(''), fault('/tasks/1/robot')]);
  expect(sorted.byTask.get(1)).toHaveLength(2);
  expect(sorted.rest).toHaveLength(1);
});
