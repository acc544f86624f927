/** Short messages about what somebody did, for 6 s, or while it is under way. Faults stay while their view is shown, or until they are closed. */
import { Problem } from './api/client';
import { t } from './i18n/i18n.svelte';

export interface Toast {
  id: number;
  kind: 'done' | 'fault' | 'busy';
  text: string;
  hints: string[];
  /** Only who closes it ends it: it must not be missed. */
  isKept: boolean;
  /** Since when it is shown, ms. */
  since: number;
}

const MOST = 5;
const READ_MS = 6000;

class Toasts {
  list = $state<Toast[]>([]);
  private last = 0;

  /** Is under way; who has asked for it closes it. */
  busy(text: string): number {
    return this.add('busy', text, [], true);
  }

  done(text: string): void {
    const id = this.add('done', text, [], false);
    setTimeout(() => this.close(id), READ_MS);
  }

  fault(text: string, hints: string[] = [], { isKept = false } = {}): void {
    this.add('fault', text, hints, isKept);
  }

  /** What a refused request says; `of`: what it was about, named if the answer does not; `hintsOf`: which of its hints. */
  problem(error: unknown, { of = '', isKept = false, hintsOf = (hints: string[]) => hints } = {}): void {
    const isKnown = error instanceof Problem;
    const text = isKnown ? (error.isNotBuilt ? t('common.notBuilt') : error.detail) : String(error);
    this.fault(of === '' || names(text, of) ? text : `${of}: ${text}`, isKnown ? hintsOf(error.hints) : [], { isKept });
  }

  /** Another view is shown: what was refused in the one before is not about it. What has come just now can still be read. */
  leave(): void {
    for (const { id, kind, isKept, since } of this.list) {
      if (kind === 'fault' && !isKept) this.closeIn(id, since + READ_MS - Date.now());
    }
  }

  close(id: number): void {
    this.list = this.list.filter((toast) => toast.id !== id);
  }

  private closeIn(id: number, ms: number): void {
    if (ms > 0) setTimeout(() => this.close(id), ms);
    else this.close(id);
  }

  private add(kind: Toast['kind'], text: string, hints: string[], isKept: boolean): number {
    const id = ++this.last;
    const all = [...this.list, { id, kind, text, hints, isKept, since: Date.now() }];
    const tooOld = all.length > MOST ? (all.find((toast) => !toast.isKept) ?? all[0]) : undefined;
    this.list = all.filter((toast) => toast !== tooOld);
    return id;
  }
}

function names(text: string, of: string): boolean {
  return text.includes(`'${of}'`) || text.startsWith(`${of}:`) || text.startsWith(`${of} `);
}

export const toasts = new Toasts();
