import { beforeEach, describe, expect, it } from 'vitest';
import type { DriveAnswer } from '../api/types';
import { Drive } from './drive';

let drive: Drive;
let now: number;
let said: Record<string, unknown>[];

beforeEach(() => {
  drive = new Drive();
  now = 1000;
  said = [];
});

function keep(words: string[]): void {
  said.push(...words.map((word) => JSON.parse(word) as Record<string, unknown>));
}

function answer(sequence: number, more: Partial<DriveAnswer> = {}): void {
  drive.heard({ robot: 'pioneer1', sequence, state: 'driving', round_trip_s: 0.01, ...more }, now);
}

function over(sequence: number, detail: string): void {
  const error = { type: '', title: '', status: 409, detail, errors: [] };
  answer(sequence, { state: 'over', error });
}

/** For so long the hand holds these speeds, looked at as often as a page draws. */
function hold(speeds: number[], ms: number): void {
  for (const end = now + ms; now < end; now += 10) keep(drive.tick(speeds, now));
}

function begun(): void {
  keep(drive.begin('pioneer1', 'base', false, now));
  now += 15;
  answer(1);
  said = [];
}

describe('a drive', () => {
  it('begins standing, once the gateway agrees', () => {
    keep(drive.begin('pioneer1', 'base', false, now));
    expect(said).toEqual([{ drive: 'pioneer1', part: 'base', speeds: [], sequence: 1 }]);
    hold([1, 0], 100);
    expect(said).toHaveLength(1);
    answer(1);
    expect(drive.state).toBe('driving');
  });

  it('takes the robot only in its first word', () => {
    keep(drive.begin('pioneer1', 'base', true, now));
    answer(1);
    hold([1], 60);
    expect(said.map((word) => word.take)).toEqual([true, undefined]);
  });

  it('sends speeds 20 times a second while something is held, and zero at once when nothing is', () => {
    begun();
    hold([0.5, 0], 1000);
    expect(said.length).toBeGreaterThanOrEqual(18);
    expect(said.length).toBeLessThanOrEqual(21);
    expect(said.at(-1)).toMatchObject({ speeds: [0.5, 0] });
    said = [];
    hold([0, 0], 10);
    expect(said).toMatchObject([{ speeds: [] }]);
  });

  it('keeps the robot with zeros, five a second', () => {
    begun();
    hold([0, 0], 2000);
    expect(said.length).toBeGreaterThanOrEqual(9);
    expect(said.length).toBeLessThanOrEqual(11);
    expect(said.every((word) => (word.speeds as number[]).length === 0)).toBe(true);
  });

  it('counts its words on', () => {
    begun();
    hold([1], 500);
    const numbers = said.map((word) => word.sequence as number);
    expect(numbers).toEqual(numbers.map((_, i) => i + 2));
  });

  it('is let go of once, and says nothing after that', () => {
    begun();
    keep(drive.letGo());
    keep(drive.letGo());
    hold([1], 500);
    expect(said).toEqual([{ let_go: 'pioneer1' }]);
  });

  it('of another robot ends the one before', () => {
    begun();
    keep(drive.begin('ur3', 'joints', false, now));
    expect(said).toEqual([{ let_go: 'pioneer1' }, { drive: 'ur3', part: 'joints', speeds: [], sequence: 1 }]);
  });
});

describe('the end of a drive', () => {
  it('is told with its reason, and a held key starts nothing', () => {
    begun();
    hold([1], 100);
    over(2, "bob has taken 'pioneer1'");
    said = [];
    hold([1], 500);
    expect(drive.state).toBe('idle');
    expect(drive.why).toBe("bob has taken 'pioneer1'");
    expect(said).toEqual([]);
  });

  it('follows from an answer that does not come', () => {
    keep(drive.begin('pioneer1', 'base', false, now));
    hold([1], 2100);
    expect(drive.why).toBe('timeout');
    expect(said.at(-1)).toEqual({ let_go: 'pioneer1' });
    expect(said.every((word) => !('speeds' in word) || (word.speeds as number[]).length === 0)).toBe(true);
  });

  it('follows from a lost stream, without a word', () => {
    begun();
    drive.lost('lost');
    hold([1], 300);
    expect([drive.state, drive.why, said]).toEqual(['idle', 'lost', []]);
  });

  it('of the drive before this one ends nothing', () => {
    begun();
    hold([1], 500);
    keep(drive.begin('pioneer1', 'base', false, now));
    over(9, 'done');
    expect(drive.state).toBe('asking');
    answer(1);
    expect(drive.state).toBe('driving');
  });
});

describe('the latency', () => {
  it('is divided into page - gateway and gateway - robot', () => {
    keep(drive.begin('pioneer1', 'base', false, now));
    now += 25;
    answer(1);
    expect(drive.latency).toEqual({ page: 15, robot: 10 });
  });

  it('takes the word that was answered, not the newest, and no refusal', () => {
    begun();
    hold([1], 200);
    const before = drive.latency;
    answer(2, { error: { type: '', title: '', status: 409, detail: 'old', errors: [] } });
    expect(drive.latency).toEqual(before);
    answer(2);
    expect(drive.latency!.page).toBeGreaterThanOrEqual(100);
    answer(2);
    expect(drive.state).toBe('driving');
  });
});
