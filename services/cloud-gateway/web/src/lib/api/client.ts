/**
 * Requests to the gateway. Cookies go by themselves; changes carry the CSRF value of the session. A refused request
 * throws a Problem. A 401 tells `onSignedOut` first, whatever view asked.
 */
import { Problem, problemOf, unreachable } from './problem';

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
}

export interface Answer<T> {
  data: T;
  etag: string;
  status: number;
}

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
  onSignedOut: () => void = () => {};
  /** A sign-in and the first look for a session are refused without telling anybody. */
  constructor(private readonly fetch: Fetch = (url, init) => globalThis.fetch(url, init)) {}

  async send<T>(method: Method, pattern: string, ask: Ask = {}): Promise<Answer<T>> {
    const response = await this.reach(method, urlOf(pattern, ask.path, ask.query), ask);
    if (response.status === 401 && this.csrf !== '') this.signedOut();
    if (!response.ok) throw await problemOf(response);
    const isJson = response.headers.get('Content-Type')?.startsWith('application/json') ?? false;
    const data = (isJson ? await response.json() : undefined) as T;
    return { data, etag: response.headers.get('ETag') ?? '', status: response.status };
  }

  get = async <T>(pattern: string, ask: Ask = {}): Promise<T> => (await this.send<T>('GET', pattern, ask)).data;
  post = async <T>(pattern: string, ask: Ask = {}): Promise<T> => (await this.send<T>('POST', pattern, ask)).data;

  signedOut(): void {
    this.csrf = '';
    this.onSignedOut();
  }

  private async reach(method: Method, url: string, ask: Ask): Promise<Response> {
    try {
      return await this.fetch(url, this.initOf(method, ask));
    } catch (error) {
      if (error instanceof DOMException && error.name === 'AbortError') throw error;
      throw unreachable();
    }
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

/** The whole list, page by page. */
export async function allPages<T>(client: Client, pattern: string, query: Query = {}): Promise<T[]> {
  const out: T[] = [];
  for (let cursor = ''; ; ) {
    const page = await client.get<{ items: T[]; next: string }>(pattern, {
      query: { ...query, limit: 100, cursor: cursor || undefined },
    });
    out.push(...page.items);
    if (page.next === '' || page.items.length === 0) return out;
    cursor = page.next;
  }
}

export const api = new Client();
export { Problem };
