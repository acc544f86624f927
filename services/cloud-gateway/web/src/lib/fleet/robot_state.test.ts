import { describe, expect, it } from 'vitest';
import type { Live, OutOfUse, RobotContent, Row } from '../api/types';
import { robotSeverity, robotState, stateOrder } from './robot_state';

function robot(content: Partial<RobotContent> = {}, live: Live = 'live'): Row<RobotContent> {
  const whole = {
    connection: 'ONLINE', detail: '', fenced: false, control: '', out_of_use: [], values: [], faults: [], cut: false, drives: [], ...content,
  };
  return { kind: 'robot', node: 'ur3', name: '', number: 1, version: 1, live, heard: '', content: whole };
}

function out(capability: string, retired = false): OutOfUse {
  return { capability, severity: 'CRITICAL', text: 'stuck', since: 0, retired, by: '' };
}

describe('the state of a robot', () => {
  it.each([
    ['ready', robot()],
    ['atWork', robot({ control: 'run 1' })],
    ['stopped', robot({ fenced: true, control: 'run 1' })],
    ['failed', robot({ out_of_use: [out('')], fenced: true })],
    ['limited', robot({ out_of_use: [out('grab')], control: 'run 1' })],
    ['retired', robot({ out_of_use: [out('', true)] })],
    ['offline', robot({ connection: 'OFFLINE' })],
    ['broken', robot({ connection: 'CONNECTION_BROKEN' })],
    ['unknown', robot({ connection: '' })],
    ['late', robot({ control: 'run 1' }, 'late')],
    ['refused', robot({}, 'refused')],
  ] as const)('is %s', (state, row) => {
    expect(robotState(row)).toBe(state);
    expect(stateOrder).toContain(state);
  });

  it('is not heard, whatever it said last', () => {
    expect(robotState(robot({ out_of_use: [out('')], fenced: true }, 'not_heard'))).toBe('notHeard');
  });

  it('has the severity of its worst fault; a retirement is none', () => {
    expect(robotSeverity(robot({ out_of_use: [out('', true)] }).content)).toBeNull();
    const faults = [{ capability: '', severity: 'WARNING' as const, text: '', since: '' }];
    expect(robotSeverity(robot({ faults, out_of_use: [out('grab')] }).content)).toBe('CRITICAL');
  });
});
