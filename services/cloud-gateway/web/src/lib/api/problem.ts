/** RFC 9457, as the gateway answers each refused request. */
export interface Fault {
  pointer: string;
  detail: string;
  hint: string;
}

export class Problem extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    readonly detail: string,
    readonly faults: Fault[] = [],
    readonly retryAfterS = 0,
  ) {
    super(detail);
    this.name = 'Problem';
  }

  /** The gateway has the route, but it does nothing yet. */
  get isNotBuilt(): boolean {
    return this.status === 501;
  }

  /** No answer came: the gateway cannot be reached. */
  get isUnreachable(): boolean {
    return this.status === 0;
  }

  /** Each once: what is wrong at several places has the same hint at each. */
  get hints(): string[] {
    return [...new Set(this.faults.map((fault) => fault.hint).filter((hint) => hint !== ''))];
  }

  /** The faults of one member of the request, by its JSON pointer. */
  at(pointer: string): Fault[] {
    return this.faults.filter((fault) => fault.pointer === pointer);
  }
}

/** Hints for who sits at a command line are none for who looks at a page. */
export function pageHints(hints: string[]): string[] {
  return hints.filter((hint) => !/(^|\W)--[a-z]|\btrb /.test(hint));
}

/** No answer came: no way to the gateway, or not in time. `unconfirmed`: what was asked for may be done still. */
export type Silence = 'unreachable' | 'unanswered' | 'unconfirmed';

export function silence(what: Silence, words: string): Problem {
  return new Problem(0, what, words);
}

export async function problemOf(response: Response): Promise<Problem> {
  const retry = Number(response.headers.get('Retry-After') ?? 0) || 0;
  try {
    const body = await response.json();
    const code = String(body.type ?? '').split('/').pop() ?? '';
    return new Problem(response.status, code, String(body.detail ?? body.title ?? ''), body.errors ?? [], retry);
  } catch {
    return new Problem(response.status, 'http', `HTTP ${response.status}`, [], retry);
  }
}
