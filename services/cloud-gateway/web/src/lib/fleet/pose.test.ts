import { describe, expect, it } from 'vitest';
import type { Profile, RobotContent, RobotValue } from '../api/types';
import { chargeOf, poseOf, unitOf } from './pose';

function robot(values: Record<string, RobotValue['value']>): RobotContent {
  const list = Object.entries(values).map(([name, value]) => ({ name, value, changed: '' }));
  return { connection: 'ONLINE', detail: '', fenced: false, control: '', out_of_use: [], values: list, faults: [], cut: false, drives: [] };
}

function profile(is: Partial<Profile>): Profile {
  return {
    framework: '', mode: '', transport: '', maker: '', model: '', capabilities: ['mobile'], sensors: [], skills: [],
    places: [], robot: 'ONLINE', detail: '', fenced: false, control: '', plugged: [], frame: { length: 1, x: 0, y: 0, yaw: 0 },
    out_of_use: [], numbers: [], drives: [], ...is,
  };
}

it('has a value in the unit that the fleet knows, and in none that it does not', () => {
  expect(unitOf('state_of_charge', undefined)).toBe('%');
  expect(unitOf('position', profile({ frame: { length: 1000, x: 0, y: 0, yaw: 0 } }))).toBe('(x, y: mm)');
  expect(unitOf('position', profile({ frame: { length: 0, x: 0, y: 0, yaw: 0 } }))).toBe('');
  expect(unitOf('position', profile({ capabilities: ['reach'] }))).toBe('');
  expect(unitOf('battery', profile({ transport: 'udp-at' }))).toBe('%');
  expect(unitOf('battery', profile({ mode: 'ros' }))).toBe(''); // 0 to 1
  expect(unitOf('sonar', profile({}))).toBe('');
});

describe('the place of a robot', () => {
  it('is turned and scaled from its own frame into the hall', () => {
    const pioneer = profile({ frame: { length: 1000, x: 1, y: 3, yaw: Math.PI / 2 } });
    const pose = poseOf(robot({ position: [1500, -500, 90] }), pioneer);
    expect(pose?.x).toBeCloseTo(1.5);
    expect(pose?.y).toBeCloseTo(4.5);
  });

  it.each([[[1, 2]], [{ x: 1, y: 2 }], ['1 2 0.5'], ['1,2']])('is read from %j', (position) => {
    expect(poseOf(robot({ position: position as RobotValue['value'] }), profile({}))).toEqual({ x: 1, y: 2 });
  });

  it('is its frame if it does not move, and unknown if nobody described that', () => {
    const arm = { capabilities: ['grab'], frame: { length: 1, x: 5.5, y: 1, yaw: 0 } };
    expect(poseOf(robot({ position: [0.1, 0.2, 0.3] }), profile(arm))).toEqual({ x: 5.5, y: 1 });
    expect(poseOf(robot({}), profile({ ...arm, frame: { length: 1, x: 0, y: 0, yaw: 0 } }))).toBeNull();
  });

  it.each([
    ['nothing', {}], ['a text', { position: 'here' }], ['one number', { position: 4 }], ['nonsense', { position: [1, null] }],
    ['a place beyond any hall', { position: [1e300, 0] }],
  ])('is unknown from %s', (_, values) => {
    expect(poseOf(robot(values), profile({}))).toBeNull();
  });

  it('is unknown without a unit of length', () => {
    expect(poseOf(robot({ position: [1, 2] }), profile({ frame: { length: 0, x: 0, y: 0, yaw: 0 } }))).toBeNull();
  });
});

describe('the charge', () => {
  it.each([
    [90, { state_of_charge: 90, battery: 12.4 }, {}],
    [50, { battery: 0.5 }, { mode: 'ros' }],
    [98, { battery: 98 }, { transport: 'udp-at' }],
    [null, { battery: 12.4 }, { mode: 'direct', transport: 'arcos' }],
    [null, { battery: 7 }, { mode: 'ros' }],
    [null, {}, { mode: 'ros' }],
  ] as const)('is %s', (is, values, of) => {
    expect(chargeOf(robot(values), profile(of as Partial<Profile>))).toBe(is);
  });
});
