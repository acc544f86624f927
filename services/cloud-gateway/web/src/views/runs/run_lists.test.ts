import { expect, it } from 'vitest';
import type { RunSummary } from '../../lib/api/types';
import { allOver, endsOf, listsOf } from './run_lists';

const run = (id: string, state: RunSummary['state'], over = 0) => ({ run: id, state, over }) as RunSummary;
const ids = (runs: RunSummary[]) => runs.map((one) => one.run);

it('has under way what goes on, is held or is being ended, and nothing that is over', () => {
  const lists = listsOf([run('a', 'RUNNING'), run('b', 'PAUSED'), run('c', 'ABORTING'), run('d', 'FINISHED'), run('e', 'ABORTED'), run('f', 'EXPIRED')]);
  expect(ids(lists.underWay)).toEqual(['a', 'b', 'c']);
  expect(ids(lists.ended)).toEqual(['d', 'e', 'f']);
});

it('has each run that is over once: as the archive has it', () => {
  const all = allOver([run('a', 'FINISHED', 7)], [run('a', 'FINISHED'), run('b', 'ABORTED')]);
  expect(all.map((one) => [one.run, one.over])).toEqual([['a', 7], ['b', 0]]);
});

it('tells that a run has ended, whatever the order of rows', () => {
  expect(endsOf([run('b', 'FINISHED'), run('a', 'FINISHED')])).toBe(endsOf([run('a', 'FINISHED'), run('b', 'FINISHED')]));
  expect(endsOf([run('a', 'FINISHED')])).not.toBe(endsOf([]));
});
