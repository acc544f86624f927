/**
 * Starts and decisions that a person sends again because no answer came: the same request has the same key, so it is
 * done once.
 * Not for orders whose repeat is meant (stop, pause): they have a new key each.
 *
 * | The request's key | Event                                                     | Then    |
 * |-------------------|-----------------------------------------------------------|---------|
 * | none              | sent                                                      | open    |
 * | open              | the same again: sent with this key                        | open    |
 * | open              | no answer, or one that does not say what became of it     | open    |
 * | open              | done; refused; not confirmed, and the person was told so  | none    |
 * | open              | 15 min old, or 16 newer ones are open                     | none    |
 */
import { api, newKey, Problem, urlOf, type Answer, type Ask, type Client } from './client';

const LIFE_MS = 15 * 60_000; // the gateway keeps a key for 24 h
const MOST_OPEN = 16;

/** Codes of answers after which a start may have been done, or still be under way. */
const UNSETTLED = ['unreachable', 'unconfirmed', 'under_way', 'no_database', 'changed_meanwhile', 'not_written', 'no_answer', 'stopping'];

/** The gateway has said its last word of this key. What is no Problem was an answer that broke off. */
export function isSettled(error: unknown): boolean {
  if (!(error instanceof Problem)) return false;
  const isOfProxy = error.code === 'http' && error.status >= 500;
  return !isOfProxy && !UNSETTLED.includes(error.code);
}

type OnceAsk = Omit<Ask, 'idempotencyKey' | 'ifMatch'>;

export class Once {
  /** By the whole request, the one that was sent last at the end. */
  private readonly open = new Map<string, { key: string; since: number }>();

  constructor(private readonly client: Client, private readonly now: () => number) {}

  async post<T>(pattern: string, ask: OnceAsk): Promise<T> {
    return (await this.send<T>(pattern, ask)).data;
  }

  /** A POST. The answer to a repeat has no ETag. */
  async send<T>(pattern: string, ask: OnceAsk): Promise<Answer<T>> {
    const what = `${urlOf(pattern, ask.path, ask.query)}\n${ask.text ?? JSON.stringify(ask.body)}`;
    const idempotencyKey = this.keyOf(what);
    try {
      const answer = await this.client.send<T>('POST', pattern, { ...ask, idempotencyKey });
      this.open.delete(what);
      return answer;
    } catch (error) {
      if (isSettled(error)) this.open.delete(what);
      throw error;
    }
  }

  private keyOf(what: string): string {
    const now = this.now();
    const known = this.open.get(what);
    const kept = known !== undefined && now - known.since < LIFE_MS ? known : { key: newKey(), since: now };
    this.open.delete(what);
    this.open.set(what, kept);
    if (this.open.size > MOST_OPEN) this.open.delete(this.open.keys().next().value!);
    return kept.key;
  }
}

/** Of the whole page: who looks elsewhere whether it was done, and comes back, repeats the same. */
export const once = new Once(api, () => performance.now());
