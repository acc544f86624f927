import { beforeEach, expect, it, vi } from 'vitest';

vi.mock('../../lib/i18n/i18n.svelte', () => ({ t: (key: string) => key, tOr: (_: string, word: string) => word }));

let orders: typeof import('./robot_orders');
let toasts: typeof import('../../lib/toasts.svelte').toasts;

beforeEach(async () => {
  vi.stubGlobal('localStorage', { getItem: () => 'en', setItem: () => undefined });
  vi.stubGlobal('document', { cookie: '', documentElement: {} });
  vi.resetModules();
  orders = await import('./robot_orders');
  ({ toasts } = await import('../../lib/toasts.svelte'));
});

const shown = () => toasts.list.map(({ kind, text }) => `${kind} ${text}`);
const answer = (body: unknown) => new Response(JSON.stringify(body), { headers: { 'Content-Type': 'application/json' } });

it('says that it is sent until it is answered', async () => {
  let arrive = (_: Response) => {};
  vi.stubGlobal('fetch', () => new Promise<Response>((done) => (arrive = done)));
  const ordered = orders.order('ur3', 'release');
  expect(shown()).toEqual(['busy robot.sent']);
  arrive(answer({ robots: [{ robot: 'ur3', state: 'confirmed', text: '' }] }));
  await ordered;
  expect(shown()).toEqual(['done ur3: done_release']);
});

it('says of a stop without an answer that the gateway is not reached, after 8 s', async () => {
  const late = new AbortController();
  const timeout = vi.spyOn(AbortSignal, 'timeout').mockReturnValue(late.signal);
  vi.stubGlobal('fetch', (_: string, { signal }: RequestInit) => new Promise((_, fail) => signal!.addEventListener('abort', () => fail(signal!.reason))));
  const ordered = orders.order('ur3', 'stop');
  late.abort(new DOMException('', 'TimeoutError'));
  await ordered;
  expect(timeout).toHaveBeenCalledWith(8000);
  expect(shown()).toEqual(['fault ur3: unreachable']);
});
