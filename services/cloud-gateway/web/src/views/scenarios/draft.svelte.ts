/** A scenario under work: its text, its steps back and forth, and the version of the gateway that it is based on. */
import { parsed, textOf, type Scenario } from '../../lib/scenario/scenario_model';

const MOST_STEPS = 100;

export class Draft {
  text = $state('');
  etag = $state('');
  private saved = $state('');
  private past = $state.raw<string[]>([]);
  private future = $state.raw<string[]>([]);
  private isTyping = false;
  private read: { text: string; scenario: Scenario | null } | undefined;

  constructor(text: string, etag = '') {
    this.text = text;
    this.saved = text;
    this.etag = etag;
  }

  // A draft outlives the component that made it: a $derived of its own would end with that one.
  /** Nothing, while the text is no scenario. The same object for the same text. */
  get scenario(): Scenario | null {
    const text = this.text;
    if (this.read?.text !== text) this.read = { text, scenario: parsed(text) };
    return this.read.scenario;
  }
  get isChanged(): boolean {
    return this.text !== this.saved;
  }
  get canUndo(): boolean {
    return this.past.length > 0;
  }
  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** A step of its own. A change that changes nothing is none. */
  change(to: (scenario: Scenario) => Scenario): void {
    const now = this.scenario;
    if (now === null) return;
    const next = to(now);
    if (next === now) return;
    this.isTyping = false;
    this.step(textOf(next));
  }

  /** Letters that follow each other are one step. */
  type(text: string): void {
    if (text === this.text) return;
    if (this.isTyping) {
      this.text = text;
      return;
    }
    this.isTyping = true;
    this.step(text);
  }

  endTyping(): void {
    this.isTyping = false;
  }

  undo(): void {
    const before = this.past.at(-1);
    if (before === undefined) return;
    this.past = this.past.slice(0, -1);
    this.future = [...this.future, this.text];
    this.show(before);
  }

  redo(): void {
    const next = this.future.at(-1);
    if (next === undefined) return;
    this.future = this.future.slice(0, -1);
    this.past = [...this.past, this.text];
    this.show(next);
  }

  /** `text`: what was sent; what was typed since then is not saved. */
  wasSaved(text: string, etag: string): void {
    this.saved = text;
    this.etag = etag;
  }

  private step(text: string): void {
    this.past = [...this.past, this.text].slice(-MOST_STEPS);
    this.future = [];
    this.text = text;
  }

  private show(text: string): void {
    this.isTyping = false;
    this.text = text;
  }
}

/** Drafts that are not saved yet stay while the page is open: who comes back finds his own, and nobody else's. */
export class Drafts {
  private readonly kept = new Map<Draft, { user: string; id: string }>();

  /** `user`: who is signed in. */
  constructor(private readonly user: () => string) {}

  get(id: string): Draft | undefined {
    const user = this.user();
    for (const [draft, of] of this.kept) if (of.user === user && of.id === id) return draft;
    return undefined;
  }

  /** One that has something to save. Another one is dropped: somebody may have stored a newer version since. */
  changed(id: string): Draft | undefined {
    const draft = this.get(id);
    if (draft === undefined || draft.isChanged) return draft;
    this.drop(draft);
    return undefined;
  }

  /** Of who is signed in; instead of another one of his. */
  keep(id: string, draft: Draft): void {
    const before = this.get(id);
    if (before !== undefined) this.kept.delete(before);
    this.kept.set(draft, { user: this.user(), id });
  }

  /** It has an id of its own now; it stays whose it was. */
  rename(draft: Draft, id: string): void {
    const of = this.kept.get(draft);
    if (of !== undefined) this.kept.set(draft, { ...of, id });
  }

  drop(draft: Draft): void {
    this.kept.delete(draft);
  }

  /** Who is signed in would lose something. */
  get areChanged(): boolean {
    const user = this.user();
    return [...this.kept].some(([draft, of]) => of.user === user && draft.isChanged);
  }
}
