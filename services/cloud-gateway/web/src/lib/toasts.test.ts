import { beforeEach, expect, it, vi } from 'vitest';

vi.mock('./i18n/i18n.svelte', () => ({ t: (key: string) => key }));

let lib: typeof import('./toasts.svelte');
let problem: typeof import('./api/problem');

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('localStorage', { getItem: () => 'en', setItem: () => undefined });
  vi.stubGlobal('document', { cookie: '', documentElement: {} });
  vi.stubGlobal('location', { hash: '' });
  vi.resetModules();
  lib = await import('./toasts.svelte');
  problem = await import('./api/problem');
});

const texts = () => lib.toasts.list.map((toast) => toast.text);

it('names whom a refusal is about', () => {
  lib.toasts.problem(new problem.Problem(409, 'conflict', 'it still says "mobile failed"'), { of: 'ridgeback' });
  lib.toasts.problem(new problem.Problem(409, 'conflict', "no fault keeps 'ur3' out of use"), { of: 'ur3' }); // it does itself
  lib.toasts.problem(new Error('network'), { of: 'ur3' });
  expect(texts()).toEqual(['ridgeback: it still says "mobile failed"', "no fault keeps 'ur3' out of use", 'ur3: Error: network']);
});

it('keeps a fault while its view is shown, and for a while after it', () => {
  lib.toasts.fault('refused');
  vi.advanceTimersByTime(180_000);
  expect(texts()).toEqual(['refused']);
  lib.toasts.leave();
  expect(texts()).toEqual([]);
  lib.toasts.fault('refused again'); // and the answer of one who has left already
  vi.advanceTimersByTime(1000);
  lib.toasts.leave();
  expect(texts()).toEqual(['refused again']);
  vi.advanceTimersByTime(5000);
  expect(texts()).toEqual([]);
});

it('keeps what must not be missed until somebody closes it', () => {
  lib.toasts.fault('the stop was not ordered', [], { isKept: true });
  lib.toasts.leave();
  vi.advanceTimersByTime(3_600_000);
  expect(texts()).toEqual(['the stop was not ordered']);
  for (let i = 1; i <= 6; i++) lib.toasts.fault(`refused ${i}`);
  expect(texts()).toEqual(['the stop was not ordered', 'refused 3', 'refused 4', 'refused 5', 'refused 6']);
});
