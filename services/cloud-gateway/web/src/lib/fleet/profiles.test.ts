import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { api } from '../api/client';
import type { Live } from '../api/types';
import { Profiles, RETRY_MS } from './profiles.svelte';

const rows = (...robots: [string, Live][]) => robots.map(([node, live]) => ({ node, live }));
let asked: string[];
let answers: Map<string, unknown>;
let profiles: Profiles;

beforeEach(() => {
  vi.useFakeTimers();
  asked = [];
  answers = new Map();
  profiles = new Profiles();
  vi.spyOn(api, 'get').mockImplementation(async (_, ask) => {
    const robot = ask?.path?.robot ?? '';
    asked.push(robot);
    const content = answers.get(robot);
    if (content === undefined) throw new Error('there is no such profile');
    return { content } as never;
  });
});

afterEach(() => {
  vi.restoreAllMocks();
  vi.useRealTimers();
});

describe('a profile', () => {
  it('is read once while its robot is live, also if the list changes', async () => {
    answers.set('ur3', 'one');
    profiles.want(rows(['ur3', 'live']));
    await vi.advanceTimersByTimeAsync(200);
    profiles.want(rows(['ur3', 'live']));
    await vi.advanceTimersByTimeAsync(60_000);
    expect([profiles.get('ur3'), asked]).toEqual(['one', ['ur3']]);
  });

  it('that could not be read is read 2 s later, though the list does not change', async () => {
    profiles.want(rows(['ur3', 'live']));
    await vi.advanceTimersByTimeAsync(RETRY_MS - 1);
    expect([profiles.get('ur3'), asked]).toEqual([undefined, ['ur3']]);
    answers.set('ur3', 'one');
    await vi.advanceTimersByTimeAsync(200);
    expect([profiles.get('ur3'), asked]).toEqual(['one', ['ur3', 'ur3']]);
    await vi.advanceTimersByTimeAsync(120_000);
    expect(asked).toHaveLength(2);
  });

  it('that is missing for long is asked for less and less often, also while the list changes all the time', async () => {
    let end = profiles.want(rows(['ur3', 'live']));
    for (let i = 0; i < 600; ++i) {
      await vi.advanceTimersByTimeAsync(100);
      end();
      end = profiles.want(rows(['ur3', 'live']));
    }
    expect(asked).toHaveLength(5); // at 0, 2, 6, 14 and 30 s
  });

  it('is not asked for by a view that was left', async () => {
    const end = profiles.want(rows(['ur3', 'live']));
    end();
    await vi.advanceTimersByTimeAsync(120_000);
    expect(asked).toHaveLength(1);
    profiles.want(rows(['ur3', 'live']));
    await vi.advanceTimersByTimeAsync(1);
    expect(asked).toHaveLength(2);
  });

  it('is read again when its robot is heard again, and stays meanwhile', async () => {
    answers.set('ur3', 'one');
    profiles.want(rows(['ur3', 'live']));
    await vi.advanceTimersByTimeAsync(200);
    profiles.want(rows(['ur3', 'late']));
    await vi.advanceTimersByTimeAsync(200);
    answers.set('ur3', 'two');
    profiles.want(rows(['ur3', 'live']));
    expect(profiles.get('ur3')).toBe('one');
    await vi.advanceTimersByTimeAsync(200);
    expect([profiles.get('ur3'), asked]).toEqual(['two', ['ur3', 'ur3']]);
  });

  it('is forgotten with its robot', async () => {
    answers.set('ur3', 'one');
    profiles.want(rows(['ur3', 'live']));
    profiles.want(rows());
    await vi.advanceTimersByTimeAsync(200);
    expect(profiles.get('ur3')).toBeUndefined();
  });

  it('is read four at a time', async () => {
    let release = () => {};
    const gate = new Promise<void>((resolve) => (release = resolve));
    vi.mocked(api.get).mockImplementation(async (_, ask) => {
      asked.push(ask?.path?.robot ?? '');
      await gate;
      return { content: 'one' } as never;
    });
    profiles.want(rows(...['a', 'b', 'c', 'd', 'e', 'f'].map((one): [string, Live] => [one, 'live'])));
    await vi.advanceTimersByTimeAsync(1000);
    expect(asked).toHaveLength(4);
    release();
    await vi.advanceTimersByTimeAsync(200);
    expect(asked).toHaveLength(6);
    expect(profiles.get('f')).toBe('one');
  });
});
