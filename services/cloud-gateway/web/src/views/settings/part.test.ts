import { beforeEach, expect, it, vi } from 'vitest';
import { api, Problem } from '../../lib/api/client';
import { Part } from './part.svelte';

const toasts = vi.hoisted(() => ({ done: vi.fn(), fault: vi.fn(), problem: vi.fn() }));
vi.mock('../../lib/toasts.svelte', () => ({ toasts }));
vi.mock('../../lib/i18n/i18n.svelte', () => ({ t: (key: string) => key }));

let readAgain: ReturnType<typeof vi.fn<() => void>>;
let part: Part;

beforeEach(() => {
  vi.restoreAllMocks();
  readAgain = vi.fn<() => void>();
  part = new Part('/api/v1/policy', readAgain);
});

async function save(answer: Problem): Promise<void> {
  vi.spyOn(api, 'send').mockRejectedValue(answer);
  await part.save({}, '"1"');
}

it('reads the settings again that are written and not in force: their version is a new one', async () => {
  const problem = new Problem(503, 'not_in_force', 'resilience.json is written, but not in force: no answer');
  await save(problem);
  expect(toasts.problem).toHaveBeenCalledWith(problem);
  expect(readAgain).toHaveBeenCalledOnce();
  expect(part.isBusy).toBe(false);
});

it('keeps what is typed when nothing was written', async () => {
  await save(new Problem(422, 'faults', 'no', [{ pointer: '/max_moves', detail: 'too many', hint: '9 at most' }]));
  expect(part.at('/max_moves')).toBe('too many. 9 at most');
  await save(new Problem(412, 'changed', 'another version'));
  await save(new Problem(503, 'no_answer', 'no answer'));
  expect(readAgain).not.toHaveBeenCalled();
});
