/**
 * Requests to the gateway. Cookies go by themselves; changes carry the CSRF value of the session. A refused request
 * throws a Problem. A 401 tells `onSignedOut` first, whatever view asked.
 * No request stays open for ever: who waits for it is told that no answer came. A change may then have been done, or
 * be done still.
 * All tabs share the cookie: a sign-in in another one leaves this one with the CSRF value of the session before. The
 * refused change is then sent once more, with the new value, unless it would be another user's.
 */
import { Problem, problemOf, silence, type Silence } from './problem';

export type Method = 'GET' | 'POST' | 'PUT' | 'PATCH' | 'DELETE';
export type Query = Record<string, string | number | boolean | undefined>;

export interface Ask {
  path?: Record<string, string>;
  query?: Query;
  body?: unknown;
  /** A body that goes byte by byte as it is: JSON that somebody else wrote. */
  text?: string;
  /** Of the version that a change is based on. */
  ifMatch?: string;
  /** A start, send or decision with it is done once, however often it is sent. */
  idempotencyKey?: string;
  signal?: AbortSignal;
  /** It changes nothing, though it is no GET. */
  isQuestion?: true;
  /** How long an answer is waited for, where that is not what is usual. */
  withinMs?: number;
}

export interface Answer<T> {
  data: T;
  etag: string;
  status: number;
}

/** A robot's node may take some seconds to confirm a change; a long list may have to come over a slow line. */
export const CHANGE_MS = 10_000;
const READ_MS = 30_000;

type Fetch = (url: string, init: RequestInit) => Promise<Response>;

export function urlOf(pattern: string, path: Record<string, string> = {}, query: Query = {}): string {
  const filled = pattern.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = path[name];
    if (value === undefined || value === '') throw new Error(`${pattern}: ${name} is missing`);
    return encodeURIComponent(value);
  });
  const pairs = Object.entries(query).filter(([, value]) => value !== undefined);
  const text = new URLSearchParams(pairs.map(([name, value]) => [name, String(value)])).toString();
  return text === '' ? filled : `${filled}?${text}`;
}

/** A new key for each action of a person. A start goes through `once`, where its repeat has the same one. */
export function newKey(): string {
  return crypto.randomUUID();
}

export class Client {
  csrf = '';
  /** Whose session it is. */
  user = '';
  /** `isTaken`: in another tab somebody else has signed in; his session goes on. */
  onSignedOut: (isTaken: boolean) => void = () => {};
  /** The words for who waited in vain, in his language. */
  sayOf: (silence: Silence, seconds: number) => string = (silence) => silence;
  /** A sign-in and the first look for a session are refused without telling anybody. */
  constructor(private readonly fetch: Fetch = (url, init) => globalThis.fetch(url, init)) {}

  async send<T>(method: Method, pattern: string, ask: Ask = {}): Promise<Answer<T>> {
    const url = urlOf(pattern, ask.path, ask.query);
    const ms = ask.withinMs ?? (method === 'GET' ? READ_MS : CHANGE_MS);
    const wait = new Wait(ms, ask.signal);
    try {
      return await this.exchange<T>(method, url, { ...ask, signal: wait.signal });
    } catch (error) {
      if (wait.isOver) throw this.silent(method === 'GET' || ask.isQuestion ? 'unanswered' : 'unconfirmed', ms / 1000);
      throw error;
    } finally {
      wait.end();
    }
  }

  private async exchange<T>(method: Method, url: string, ask: Ask): Promise<Answer<T>> {
    let response = await this.reach(method, url, ask);
    if (response.status === 403 && this.csrf !== '') {
      const refused = await problemOf(response);
      if (refused.code !== 'wrong_csrf' || !(await this.isRenewed(ask))) throw refused;
      response = await this.reach(method, url, ask);
    }
    if (response.status === 401 && this.csrf !== '') this.signedOut();
    if (!response.ok) throw await problemOf(response);
    const isJson = response.headers.get('Content-Type')?.startsWith('application/json') ?? false;
    const data = (isJson ? await response.json() : undefined) as T;
    return { data, etag: response.headers.get('ETag') ?? '', status: response.status };
  }

  get = async <T>(pattern: string, ask: Ask = {}): Promise<T> => (await this.send<T>('GET', pattern, ask)).data;
  post = async <T>(pattern: string, ask: Ask = {}): Promise<T> => (await this.send<T>('POST', pattern, ask)).data;

  signedOut(isTaken = false): void {
    this.csrf = this.user = '';
    this.onSignedOut(isTaken);
  }

  /** The request was refused and not done, as its session is over. */
  isOver(error: unknown): boolean {
    return error instanceof Problem && (error.status === 401 || error.status === 403) && this.csrf === '';
  }

  /** The cookie is of another session of the same user, whose CSRF value is taken. */
  private async isRenewed(ask: Ask): Promise<boolean> {
    const response = await this.reach('GET', '/api/v1/session', ask.signal ? { signal: ask.signal } : {});
    if (response.status === 401) this.signedOut();
    if (!response.ok) return false;
    const session = (await response.json()) as { user?: string; csrf?: string };
    if (this.csrf === '') return false; // meanwhile another request was told that the session is over
    if (session.user !== this.user) this.signedOut(true);
    else this.csrf = session.csrf ?? '';
    return session.user === this.user;
  }

  private async reach(method: Method, url: string, ask: Ask): Promise<Response> {
    try {
      return await this.fetch(url, this.initOf(method, ask));
    } catch (error) {
      if (error instanceof DOMException && error.name === 'AbortError') throw error;
      throw this.silent('unreachable', 0);
    }
  }

  private silent(what: Silence, seconds: number): Problem {
    return silence(what, this.sayOf(what, seconds));
  }

  private initOf(method: Method, ask: Ask): RequestInit {
    const headers: Record<string, string> = { Accept: 'application/json' };
    if (method !== 'GET' && this.csrf !== '') headers['X-CSRF-Token'] = this.csrf;
    if (ask.body !== undefined || ask.text !== undefined) headers['Content-Type'] = 'application/json';
    if (ask.ifMatch) headers['If-Match'] = ask.ifMatch;
    if (ask.idempotencyKey) headers['Idempotency-Key'] = ask.idempotencyKey;
    const init: RequestInit = { method, headers, credentials: 'same-origin', cache: 'no-cache' };
    if (ask.text !== undefined) init.body = ask.text;
    else if (ask.body !== undefined) init.body = JSON.stringify(ask.body);
    if (ask.signal) init.signal = ask.signal;
    return init;
  }
}

/** Ends a request after a while, or when its asker ends it. AbortSignal.any is too new for some browsers. */
class Wait {
  isOver = false;
  private readonly abort = new AbortController();
  private readonly timer: ReturnType<typeof setTimeout>;

  constructor(ms: number, private readonly asker: AbortSignal | undefined) {
    this.timer = setTimeout(() => {
      this.isOver = true;
      this.abort.abort();
    }, ms);
    if (asker?.aborted) this.follow();
    asker?.addEventListener('abort', this.follow);
  }

  get signal(): AbortSignal {
    return this.abort.signal;
  }

  end(): void {
    clearTimeout(this.timer);
    this.asker?.removeEventListener('abort', this.follow);
  }

  private readonly follow = (): void => this.abort.abort(this.asker!.reason);
}

/** The most that the gateway gives at once. */
const PAGE = 500;

/** The whole list, page by page. */
export async function allPages<T>(client: Client, pattern: string, signal?: AbortSignal): Promise<T[]> {
  const out: T[] = [];
  for (let cursor = ''; ; ) {
    const page = await client.get<{ items: T[]; next: string }>(pattern, {
      query: { limit: PAGE, cursor: cursor || undefined },
      ...(signal ? { signal } : {}),
    });
    out.push(...page.items);
    if (page.next === '' || page.items.length === 0) return out;
    cursor = page.next;
  }
}

export const api = new Client();
export { Problem };
