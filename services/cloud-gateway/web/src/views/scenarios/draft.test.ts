import { describe, expect, it } from 'vitest';
import { Draft, Drafts } from './draft.svelte';
import { textOf, withTask } from '../../lib/scenario/scenario_model';

const begin = textOf({ name: 'x', tasks: [] });

describe('a draft', () => {
  it('goes back and forth step by step', () => {
    const draft = new Draft(begin);
    draft.change((one) => withTask(one, { id: 'a' }));
    draft.change((one) => withTask(one, { id: 'b' }));
    draft.undo();
    expect(draft.scenario?.tasks.map((task) => task.id)).toEqual(['a']);
    draft.redo();
    expect(draft.scenario?.tasks).toHaveLength(2);
    draft.undo();
    draft.change((one) => withTask(one, { id: 'c' }));
    expect(draft.canRedo).toBe(false);
    draft.undo();
    draft.undo();
    draft.undo();
    expect(draft.text).toBe(begin);
    expect(draft.canUndo).toBe(false);
  });

  it('takes what is typed in one go as one step', () => {
    const draft = new Draft(begin);
    draft.type(`${begin} `);
    draft.type(`${begin}  `);
    draft.endTyping();
    draft.type('{');
    expect(draft.scenario).toBeNull();
    draft.undo();
    expect(draft.text).toBe(`${begin}  `);
    draft.undo();
    expect(draft.text).toBe(begin);
  });

  it('is as it was saved until something changes', () => {
    const draft = new Draft(begin, '"1"');
    expect(draft.isChanged).toBe(false);
    draft.change((one) => one);
    expect(draft.canUndo).toBe(false);
    draft.change((one) => ({ ...one, name: 'y' }));
    expect(draft.isChanged).toBe(true);
    draft.wasSaved(draft.text, '"2"');
    expect([draft.isChanged, draft.etag]).toEqual([false, '"2"']);
    draft.undo();
    expect(draft.isChanged).toBe(true);
  });

  it('is not saved as far as it was typed after it was sent', () => {
    const draft = new Draft(begin, '"1"');
    draft.type(`${begin} `);
    const sent = draft.text;
    draft.type(`${begin}  `);
    draft.wasSaved(sent, '"2"');
    expect([draft.isChanged, draft.text, draft.etag]).toEqual([true, `${begin}  `, '"2"']);
    draft.type(sent);
    expect(draft.isChanged).toBe(false);
  });
});

describe('drafts of several people at one page', () => {
  it('are found again by who made them', () => {
    let user = 'ann';
    const drafts = new Drafts(() => user);
    const hers = new Draft(begin, '"1"');
    drafts.keep('s', hers);
    expect(drafts.areChanged).toBe(false);
    hers.type('{');
    expect(drafts.areChanged).toBe(true);
    user = 'bob';
    expect([drafts.get('s'), drafts.areChanged]).toEqual([undefined, false]);
    const his = new Draft(begin);
    drafts.keep('s', his);
    expect(drafts.get('s')).toBe(his);
    drafts.drop(his);
    user = 'ann';
    expect(drafts.get('s')).toBe(hers);
  });

  it('are read anew if there is nothing to save', () => {
    const drafts = new Drafts(() => 'ann');
    const draft = new Draft(begin, '"1"');
    drafts.keep('s', draft);
    expect(drafts.changed('s')).toBeUndefined();
    expect(drafts.get('s')).toBeUndefined();
    drafts.keep('s', draft);
    draft.type('{');
    expect(drafts.changed('s')).toBe(draft);
  });

  it('stay whose they were when a new one gets its id after somebody else has signed in', () => {
    let user = 'ann';
    const drafts = new Drafts(() => user);
    const hers = new Draft(begin);
    drafts.keep('new', hers);
    user = 'bob';
    drafts.rename(hers, 's');
    expect(drafts.get('s')).toBeUndefined();
    user = 'ann';
    expect([drafts.get('s'), drafts.get('new')]).toEqual([hers, undefined]);
  });
});
