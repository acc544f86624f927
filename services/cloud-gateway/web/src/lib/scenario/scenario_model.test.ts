import { describe, expect, it } from 'vitest';
import {
  afterOf, changed, connected, copied, disconnected, emptyScenario, freshId, isFreeId, parsed, renamed, textOf, withTask, withoutTask, wordsIn, wouldCircle,
  type Scenario,
} from './scenario_model';

/** a, then b, then c; c takes its place from a's result. */
const three: Scenario = {
  name: 'three',
  _comment: 'mine',
  tasks: [
    { id: 'a', robot: 'ur3', skill: 'find' },
    { id: 'b', robot: 'ur3', skill: 'pick', after: ['a'] },
    { id: 'c', robot: 'cart', skill: 'go_to', after: ['b', 'a'], data: { place: { from: 'a', value: 'place' } } },
  ],
};

describe('a scenario that is edited', () => {
  it('is left as it was by each change', () => {
    const before = structuredClone(three);
    for (const change of [withoutTask(three, 'a'), renamed(three, 'a', 'z'), connected(three, 'c', 'a'), changed(three, 'a', { retries: 2 })]) {
      expect(change).not.toBe(undefined);
    }
    expect(three).toEqual(before);
  });

  it('comes back from its text with everything in it', () => {
    expect(parsed(textOf(three))).toEqual(three);
    expect(changed(three, 'a', { retries: 2 })._comment).toBe('mine');
  });

  it('is nothing while its text is no scenario', () => {
    for (const text of ['', '{', '[]', 'null', '{"name": "x"}', '{"tasks": {}}', '{"tasks": [5]}']) expect(parsed(text)).toBeNull();
  });

  it('loses a key that becomes empty', () => {
    const task = changed(changed(three, 'b', { retries: 2, pinned: true }), 'b', { retries: undefined, pinned: false, after: [] }).tasks[1]!;
    expect(task).toEqual({ id: 'b', robot: 'ur3', skill: 'pick' });
  });

  it('names new tasks so that no two are alike', () => {
    expect(freshId(three, 'Go To!')).toBe('go_to_');
    expect(freshId(three, 'a')).toBe('a_2');
    expect(freshId(emptyScenario(), '42')).toBe('task');
    expect(isFreeId(three, 'b', 'a')).toBe(false);
    expect(isFreeId(three, 'B', 'a')).toBe(false);
    expect(isFreeId(three, 'a', 'a')).toBe(true);
  });

  it('keeps the order of those around a task that is removed', () => {
    expect(withoutTask(three, 'b').tasks[1]!.after).toEqual(['a']);
    expect(withoutTask(three, 'a').tasks[0]).toEqual({ id: 'b', robot: 'ur3', skill: 'pick' });
  });

  it('follows a new name everywhere', () => {
    const after = renamed(three, 'a', 'search');
    expect(after.tasks[1]!.after).toEqual(['search']);
    expect(after.tasks[2]!.data).toEqual({ place: { from: 'search', value: 'place' } });
  });

  it('connects what makes no circle, once', () => {
    expect(wouldCircle(three, 'c', 'a')).toBe(true);
    expect(connected(three, 'c', 'a')).toBe(three);
    expect(connected(three, 'a', 'a')).toBe(three);
    expect(connected(three, 'a', 'b')).toBe(three);
    expect(disconnected(three, 'a', 'c').tasks[2]!.after).toEqual(['b']);
    expect(disconnected(three, 'c', 'a')).toBe(three);
  });

  it('copies a task with all it has', () => {
    const copy = copied(three, 'c');
    expect(copy.id).toBe('c_2');
    expect(copy.scenario.tasks[3]).toEqual({ ...three.tasks[2], id: 'c_2' });
    expect(copied(copy.scenario, 'c_2').id).toBe('c_3');
    expect(withTask(three, { id: 'd' }).tasks).toHaveLength(4);
  });

  it('takes what is no list of words for none: a scenario that was stored so can be mended', () => {
    const odd = { name: 'odd', tasks: [{ id: 'a', after: 5, requires: 'wheels' }, { id: 'b', after: ['a', 'a', 7] }, { id: 'b', after: 'a' }] } as unknown as Scenario;
    expect(afterOf(odd)).toEqual([[], [0, 0], []]);
    expect(wordsIn(odd.tasks[0]!.requires)).toEqual([]);
    expect(wouldCircle(odd, 'b', 'a')).toBe(false);
    expect(connected(odd, 'b', 'a').tasks[0]!.after).toEqual(['b']);
    expect(disconnected(odd, 'a', 'b').tasks[1]).toEqual({ id: 'b' });
    expect(renamed(odd, 'a', 'c').tasks.map((task) => task.after)).toEqual([5, ['c', 'c', 7], 'a']);
    expect(withoutTask(odd, 'a').tasks).toHaveLength(2);
  });

  it('tells the layout who follows whom, and leaves out who is not there', () => {
    expect(afterOf(three)).toEqual([[], [0], [1, 0]]);
    expect(afterOf(changed(three, 'b', { after: ['nobody'] }))[1]).toEqual([]);
  });
});
