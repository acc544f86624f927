import { expect, it } from 'vitest';
import type { RobotContent, RobotOrder, Row } from '../api/types';
import { namesBy, StopCourse } from './stop_course';

const order = (robot: string, state: RobotOrder['state'] = 'confirmed'): RobotOrder => ({ robot, state, text: '' });
const row = (node: string, fenced: boolean, live: Row['live'] = 'live') => ({ node, live, content: { fenced } }) as Row<RobotContent>;

it('is over when each of its robots was shown as stopped and is so no more', () => {
  const stop = new StopCourse([order('a'), order('b')]);
  stop.see([row('a', false), row('b', false)], 0, true); // no row has shown it yet
  expect(stop.since).toEqual({ open: [], released: 0, isOver: false });
  stop.see([row('a', true), row('b', true)], 1000, true);
  stop.see([row('a', false), row('b', true)], 2000, true);
  expect(stop.since).toEqual({ open: [], released: 1, isOver: false });
  stop.see([row('a', false), row('b', false)], 3000, true);
  expect(stop.since.isOver).toBe(true);
});

it('goes on for a robot that is stopped again', () => {
  const stop = new StopCourse([order('a')]);
  for (const [at, fenced] of [true, false, true].entries()) stop.see([row('a', fenced)], at, true);
  expect(stop.since).toEqual({ open: [], released: 0, isOver: false });
});

it('is over for who was released before a row had shown it, after 10 s of rows without a gap', () => {
  const stop = new StopCourse([order('a')]);
  stop.see([row('a', false)], 0, true);
  stop.see([row('a', false)], 9000, false); // the connection is lost
  stop.see([row('a', false)], 11000, true);
  expect(stop.since.isOver).toBe(false);
  stop.see([row('a', false)], 21001, true);
  expect(stop.since.isOver).toBe(true);
});

it('is not over by old rows', () => {
  const stop = new StopCourse([order('a')]);
  stop.see([row('a', true)], 0, true);
  stop.see([row('a', false, 'not_heard')], 60000, true);
  stop.see([row('a', false)], 61000, false);
  expect(stop.since.isOver).toBe(false);
});

it('keeps who has not confirmed until a row shows him as stopped', () => {
  const stop = new StopCourse([order('a'), order('b', 'sent'), order('c', 'unreachable')]);
  stop.see([row('a', true), row('b', false), row('c', false)], 0, true);
  stop.see([row('a', false), row('b', true), row('c', false)], 60000, true);
  expect(stop.since.open.map((one) => one.robot)).toEqual(['c']);
  stop.see([row('a', false), row('b', false), row('c', false)], 61000, true);
  expect(stop.since).toMatchObject({ released: 2, isOver: false });
});

it('waits for no robot that has left the fleet', () => {
  const stop = new StopCourse([order('a'), order('b')]);
  stop.see([row('a', true), row('b', true)], 0, true);
  stop.see([row('a', false)], 1000, true);
  expect(stop.since.isOver).toBe(true);
});

it('names once what is said of many', () => {
  const robots = [order('a', 'sent'), order('b', 'unreachable'), order('c'), order('d', 'sent')];
  expect(namesBy(robots, (one) => (one.state === 'confirmed' ? '' : one.state))).toEqual([['sent', 'a, d'], ['unreachable', 'b']]);
});
