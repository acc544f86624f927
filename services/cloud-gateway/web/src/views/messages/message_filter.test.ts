import { describe, expect, it } from 'vitest';
import { fits, joined, MOST, shares, type Passed, type Wish } from './message_filter';

const message = (number: number, more: Partial<Passed> = {}): Passed =>
  ({ number, time: '', direction: '>', phase: 'task', type: 'command', subtype: 'go_to', source: 'cloud', target: 'ur3', size: 3, ...more }) as Passed;
const all: Wish = { node: '', type: '', phase: '', text: '' };

describe('messages that pass', () => {
  it('are shown if they fit every wish', () => {
    expect(fits(message(1), all)).toBe(true);
    expect(fits(message(1), { ...all, node: 'ur3' })).toBe(true);
    expect(fits(message(1), { ...all, node: 'drone' })).toBe(false);
    expect(fits(message(1), { ...all, type: 'request' })).toBe(false);
    expect(fits(message(1), { ...all, phase: 'fail' })).toBe(false);
    expect(fits(message(1), { ...all, text: 'GO_' })).toBe(true);
    expect(fits(message(1), { ...all, text: 'stop' })).toBe(false);
  });

  it('stand once, newest first, and only so many', () => {
    expect(joined([message(2), message(1)], [message(3), message(2)]).map((one) => one.number)).toEqual([3, 2, 1]);
    const many = Array.from({ length: MOST + 5 }, (_, i) => message(i + 1));
    expect(joined([], many)).toHaveLength(MOST);
    expect(joined([], many)[0]!.number).toBe(MOST + 5);
  });

  it('are counted by phase', () => {
    const counts = { boot: 0, identification: 0, devices: 0, task: 4, forward: 1, sensor: 0, fail: 0, upkeep: 0 };
    expect(shares(counts).find((one) => one.phase === 'forward')).toEqual({ phase: 'forward', count: 1, share: 0.25 });
    expect(shares({ ...counts, task: 0, forward: 0 }).every((one) => one.share === 0)).toBe(true);
  });
});
