import { expect, it } from 'vitest';
import { Problem } from '../../lib/api/problem';
import { MISSING, readRun } from './read_run';

const refused = (status: number, detail = '') => () => Promise.reject(new Problem(status, 'x', detail));
const from = (scheduler: () => Promise<string>, archive: () => Promise<string>) => readRun((route) => (route.includes('archive') ? archive() : scheduler()));
const has = () => Promise.resolve('run');

it('finds a run in the archive, whatever the scheduler says', async () => {
  for (const status of [404, 503]) expect(await from(refused(status), has)).toEqual({ run: 'run', why: '' });
});

it('says that there is none only if both say so', async () => {
  expect(await from(refused(404), refused(404))).toEqual({ why: MISSING });
  expect(await from(refused(503, 'no answer'), refused(404))).toEqual({ why: 'no answer' });
  expect(await from(refused(404), refused(0, 'the gateway cannot be reached'))).toEqual({ why: 'the gateway cannot be reached' });
});
