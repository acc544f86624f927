import { describe, expect, it, vi } from 'vitest';
import { allPages, Client, urlOf } from './client';
import { pageHints, Problem } from './problem';

interface Sent {
  url: string;
  init: RequestInit;
}

/** A gateway that gives these answers one after the other. */
function gateway(...answers: (Response | Error)[]): { client: Client; sent: Sent[] } {
  const sent: Sent[] = [];
  const client = new Client(async (url, init) => {
    sent.push({ url, init });
    const next = answers.shift();
    if (next === undefined || next instanceof Error) throw next ?? new Error('no more answers');
    return next;
  });
  return { client, sent };
}

function json(body: unknown, status = 200, headers: Record<string, string> = {}): Response {
  const type = status < 400 ? 'application/json' : 'application/problem+json';
  return new Response(JSON.stringify(body), { status, headers: { 'Content-Type': type, ...headers } });
}

const header = (sent: Sent | undefined, name: string) => new Headers(sent?.init.headers).get(name);

it('sends what somebody else wrote byte by byte', async () => {
  const { client, sent } = gateway(json({ id: 'a' }, 201));
  const text = '{ "tasks": [],\n  "name": "x" }';
  await client.post('/api/v1/scenarios/import', { text });
  expect(sent[0]!.init.body).toBe(text);
  expect(header(sent[0], 'Content-Type')).toBe('application/json');
});

describe('an address', () => {
  it('has its parameters escaped, so that no id becomes another path', () => {
    expect(urlOf('/api/v1/robots/{robot}', { robot: '../users' })).toBe('/api/v1/robots/..%2Fusers');
    expect(urlOf('/api/v1/robots', {}, { limit: 5, cursor: undefined, name: 'a b' })).toBe('/api/v1/robots?limit=5&name=a+b');
  });

  it('is refused without its parameter', () => {
    expect(() => urlOf('/api/v1/robots/{robot}')).toThrow('robot is missing');
  });
});

describe('a request', () => {
  it('carries the CSRF value if it changes something', async () => {
    const { client, sent } = gateway(json({}), json({}));
    client.csrf = 'abc';
    await client.get('/api/v1/robots');
    await client.post('/api/v1/stop', { idempotencyKey: 'one', body: { reason: 'smoke' } });
    expect(header(sent[0], 'X-CSRF-Token')).toBeNull();
    expect(header(sent[1], 'X-CSRF-Token')).toBe('abc');
    expect(header(sent[1], 'Idempotency-Key')).toBe('one');
    expect(sent[1]?.init.body).toBe('{"reason":"smoke"}');
  });

  it('gives back the version, and names the one that a change is based on', async () => {
    const { client, sent } = gateway(json({}, 200, { ETag: '"7"' }), new Response(null, { status: 204 }));
    const { etag } = await client.send('GET', '/api/v1/scenarios/x');
    await client.send('PUT', '/api/v1/scenarios/x', { ifMatch: etag, body: {} });
    expect(header(sent[1], 'If-Match')).toBe('"7"');
  });

  it('that is refused throws all faults', async () => {
    const faults = [{ pointer: '/tasks/0/robot', detail: 'there is no robot ur4', hint: 'did you mean ur3?' }];
    const { client } = gateway(json({ type: '/api/v1/problems/bad_value', detail: 'one fault', errors: faults }, 422));
    const problem = (await client.post('/x').catch((error: unknown) => error)) as Problem;
    expect(problem).toBeInstanceOf(Problem);
    expect([problem.status, problem.code, problem.hints]).toEqual([422, 'bad_value', ['did you mean ur3?']]);
    expect(problem.at('/tasks/0/robot')).toEqual(faults);
  });

  it('that is refused for the same fault twice gives its hint once', async () => {
    const faults = ['/tasks/0/id', '/tasks/1/id'].map((pointer) => ({ pointer, detail: `${pointer} is no id`, hint: 'use a letter' }));
    const { client } = gateway(json({ type: '/problems/bad_value', detail: '2 faults', errors: [...faults, { ...faults[0], hint: '' }] }, 422));
    await expect(client.post('/x')).rejects.toMatchObject({ hints: ['use a letter'], faults: { length: 3 } });
  });

  it('that has to wait says how long', async () => {
    const { client } = gateway(json({ type: 'wait', detail: 'no sign-in now' }, 429, { 'Retry-After': '12' }));
    await expect(client.post('/x')).rejects.toMatchObject({ retryAfterS: 12 });
  });

  it('without an answer is a problem too', async () => {
    const { client } = gateway(new TypeError('Failed to fetch'));
    await expect(client.get('/x')).rejects.toMatchObject({ isUnreachable: true });
  });

  it('whose session is over leads to the sign-in, once', async () => {
    const { client } = gateway(json({}, 401), json({}, 401));
    let times = 0;
    client.onSignedOut = () => ++times;
    client.csrf = 'abc';
    await expect(client.get('/x')).rejects.toMatchObject({ status: 401 });
    await expect(client.get('/x')).rejects.toMatchObject({ status: 401 });
    expect([times, client.csrf]).toEqual([1, '']);
  });
});

describe('a change with the CSRF value of a session that another tab has replaced', () => {
  const refused = () => json({ type: '/problems/wrong_csrf', detail: 'no' }, 403);
  function tab(...answers: (Response | Error)[]) {
    const made = gateway(...answers);
    const ends: boolean[] = [];
    Object.assign(made.client, { csrf: 'old', user: 'ann', onSignedOut: (isTaken: boolean) => ends.push(isTaken) });
    return { ...made, ends };
  }
  const stop = { idempotencyKey: 'one', body: {} };

  it('is sent once more with the new one', async () => {
    const { client, sent, ends } = tab(refused(), json({ user: 'ann', csrf: 'new' }), json({ robots: [] }));
    await expect(client.post('/api/v1/stop', stop)).resolves.toEqual({ robots: [] });
    expect(sent.map((one) => one.url)).toEqual(['/api/v1/stop', '/api/v1/session', '/api/v1/stop']);
    expect([header(sent[2], 'X-CSRF-Token'), header(sent[2], 'Idempotency-Key'), client.csrf]).toEqual(['new', 'one', 'new']);
    expect(ends).toEqual([]);
  });

  it('is sent no third time', async () => {
    const { client, sent } = tab(refused(), json({ user: 'ann', csrf: 'new' }), refused());
    await expect(client.post('/api/v1/stop', stop)).rejects.toMatchObject({ code: 'wrong_csrf' });
    expect(sent).toHaveLength(3);
  });

  it('is not sent in the name of another user: this tab is signed out', async () => {
    const { client, sent, ends } = tab(refused(), json({ user: 'bob', csrf: 'new' }));
    const problem: unknown = await client.post('/api/v1/stop', stop).catch((error: unknown) => error);
    expect([sent.length, ends, client.csrf, client.isOver(problem)]).toEqual([2, [true], '', true]);
  });

  it('leads to the sign-in if there is no session any more', async () => {
    const { client, ends } = tab(refused(), json({}, 401));
    const problem: unknown = await client.post('/api/v1/stop', stop).catch((error: unknown) => error);
    expect([ends, client.isOver(problem)]).toEqual([[false], true]);
  });

  it('is no end of the session if the gateway cannot be asked, or refuses for another reason', async () => {
    const lost = tab(refused(), new TypeError('Failed to fetch'));
    const problem: unknown = await lost.client.post('/api/v1/stop', stop).catch((error: unknown) => error);
    expect([lost.ends, lost.client.isOver(problem)]).toEqual([[], false]);
    const other = tab(json({ type: '/problems/role_too_low', detail: 'no' }, 403));
    await expect(other.client.post('/x')).rejects.toMatchObject({ code: 'role_too_low' });
    expect(other.sent).toHaveLength(1);
  });
});

it('leaves out hints for a command line', () => {
  expect(pageHints(['say --stands if you have seen it', 'trb alert list says why', 'bring it back'])).toEqual(['bring it back']);
});

it('reads a list to its last page', async () => {
  const { client, sent } = gateway(json({ items: [1, 2], next: 'abc' }), json({ items: [3], next: '' }));
  expect(await allPages(client, '/api/v1/robots')).toEqual([1, 2, 3]);
  expect(sent[1]?.url).toBe('/api/v1/robots?limit=500&cursor=abc');
});

describe('a request without an answer', () => {
  const silent = () => new Client((_, { signal }) => new Promise((_, fail) => signal!.addEventListener('abort', () => fail(signal!.reason))));

  async function after(ms: number, ask: (client: Client) => Promise<unknown>): Promise<unknown> {
    vi.useFakeTimers();
    let said: unknown = 'nothing yet';
    void ask(silent()).catch((problem: Problem) => (said = [problem.status, problem.code]));
    await vi.advanceTimersByTimeAsync(ms);
    vi.useRealTimers();
    return said;
  }

  it('is not confirmed if it changes something, and is told so after 10 s', async () => {
    expect(await after(9_999, (client) => client.post('/api/v1/runs', { body: {} }))).toBe('nothing yet');
    expect(await after(10_000, (client) => client.post('/api/v1/runs', { body: {} }))).toEqual([0, 'unconfirmed']);
    expect(await after(10_000, (client) => client.post('/api/v1/policy', { withinMs: 20_000 }))).toBe('nothing yet');
  });

  it('is unanswered if it only asks', async () => {
    expect(await after(10_000, (client) => client.get('/api/v1/archive'))).toBe('nothing yet');
    expect(await after(30_000, (client) => client.get('/api/v1/archive'))).toEqual([0, 'unanswered']);
    expect(await after(10_000, (client) => client.post('/api/v1/scenarios/check', { isQuestion: true }))).toEqual([0, 'unanswered']);
  });

  it('ends at once when its asker ends it', async () => {
    const asker = new AbortController();
    const asked = silent().get('/api/v1/archive', { signal: asker.signal });
    asker.abort();
    await expect(asked).rejects.toMatchObject({ name: 'AbortError' });
  });
});
