import { expect, it } from 'vitest';
import { streamState } from './stream_state';

it('is live only if both the sensor and its value are', () => {
  expect(streamState(true, 'live', 'live')).toBe('live');
  expect(streamState(true, 'live', 'late')).toBe('late');
  expect(streamState(true, 'live', 'not_heard')).toBe('notHeard');
  expect(streamState(true, 'late', 'live')).toBe('late');
  expect(streamState(true, 'late', 'not_heard')).toBe('notHeard');
  expect(streamState(true, 'refused', 'late')).toBe('refused');
});

it('waits for the topic and for the first value', () => {
  expect(streamState(false, undefined, undefined)).toBe('waits');
  expect(streamState(true, 'live', undefined)).toBe('waits');
  expect(streamState(true, 'not_heard', undefined)).toBe('notHeard');
});

it('has gone if the fleet has no such sensor, whatever it said last', () => {
  expect(streamState(true, undefined, undefined)).toBe('gone');
  expect(streamState(true, undefined, 'live')).toBe('gone');
});
