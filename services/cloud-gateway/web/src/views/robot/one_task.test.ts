import { expect, it } from 'vitest';
import { oneTask } from './one_task';

it('is a scenario of one task that no other robot takes over', () => {
  expect(oneTask('ur3', 'go_to', { place: 'dock' })).toEqual({
    name: 'go_to ur3', tasks: [{ id: 'go_to', robot: 'ur3', skill: 'go_to', pinned: true, data: { place: 'dock' } }],
  });
  expect(oneTask('ur3', 'Land', {}).tasks[0]).toEqual({ id: 'land', robot: 'ur3', skill: 'Land', pinned: true });
  expect(oneTask('r'.repeat(64), 'go_to', {}).name).toHaveLength(64);
});
