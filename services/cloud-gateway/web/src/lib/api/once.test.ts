import { beforeEach, expect, it } from 'vitest';
import { Client } from './client';
import { Once } from './once';
import { Problem } from './problem';

const RUN = { scenario: { name: 'short', tasks: [] } };

let now: number;
let keys: string[];
let answers: (() => Response)[];
let once: Once;

beforeEach(() => {
  now = 0;
  keys = [];
  answers = [];
  const client = new Client(async (_, init) => {
    keys.push(new Headers(init.headers).get('Idempotency-Key') ?? '');
    return (answers.shift() ?? done)();
  });
  once = new Once(client, () => now);
});

const done = () => new Response('{"run":"r1"}', { status: 201, headers: { 'Content-Type': 'application/json' } });

/** It was delivered, and the answer was lost on its way. */
function lost(): Response {
  throw new TypeError('Failed to fetch');
}

function refused(status: number, code: string): () => Response {
  const headers = { 'Content-Type': 'application/problem+json' };
  return () => new Response(JSON.stringify({ type: `/api/v1/problems/${code}`, detail: code }), { status, headers });
}

async function start(body: unknown = RUN, route = '/api/v1/runs'): Promise<unknown> {
  return once.post(route, { body }).catch((error: unknown) => error);
}

it('sends a start whose answer was lost again with the same key', async () => {
  answers = [lost];
  expect(await start()).toBeInstanceOf(Problem);
  expect(await start()).toEqual({ run: 'r1' });
  expect(keys[0]).not.toBe('');
  expect(keys[1]).toBe(keys[0]);
});

it('has a new key once it was done: a second run is meant', async () => {
  await start();
  await start();
  expect(keys[1]).not.toBe(keys[0]);
});

it.each([
  [503, 'no_database'], // this is not on record
  [503, 'not_written'],
  [503, 'no_answer'],
  [503, 'stopping'],
  [409, 'under_way'],
])('keeps the key after %i %s, which does not say whether it was done', async (status, code) => {
  answers = [refused(status, code), refused(status, code)];
  await start();
  await start();
  await start();
  expect(new Set(keys).size).toBe(1);
});

it('keeps the key if a proxy answers in the place of the gateway, or the answer breaks off', async () => {
  answers = [
    () => new Response('<html>Bad Gateway</html>', { status: 502 }),
    () => new Response('{"run":', { status: 201, headers: { 'Content-Type': 'application/json' } }),
  ];
  await start();
  await start();
  await start();
  expect(new Set(keys).size).toBe(1);
});

it.each([
  [422, 'bad_value'],
  [429, 'queue_full'],
  [503, 'peer_unreachable'],
  [503, 'not_confirmed'], // the person was told to look; the gateway would repeat this for ever
  [504, 'timeout'],
])('has a new key after %i %s', async (status, code) => {
  answers = [refused(status, code)];
  await start();
  await start();
  expect(keys[1]).not.toBe(keys[0]);
});

it('has a key for each body and each route', async () => {
  answers = [lost, lost, lost];
  await start();
  await start({ ...RUN, priority: 1 });
  await start(RUN, '/api/v1/simulations');
  expect(new Set(keys).size).toBe(3);
});

it('forgets a key after 15 minutes, and the oldest of more than 16', async () => {
  answers = Array.from({ length: 20 }, () => lost);
  await start();
  now = 15 * 60_000;
  await start();
  expect(keys[1]).not.toBe(keys[0]);
  for (let i = 0; i < 16; i++) await start({ i });
  await start();
  expect(keys.at(-1)).not.toBe(keys[1]);
});
