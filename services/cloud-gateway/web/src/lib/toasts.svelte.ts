/** Short messages about what somebody did. Faults stay until they are closed, the rest for 6 s. */
import { Problem } from './api/client';
import { t } from './i18n/i18n.svelte';

export interface Toast {
  id: number;
  kind: 'done' | 'fault';
  text: string;
  hints: string[];
}

const MOST = 5;
const DONE_MS = 6000;

class Toasts {
  list = $state<Toast[]>([]);
  private last = 0;

  done(text: string): void {
    const id = this.add('done', text, []);
    setTimeout(() => this.close(id), DONE_MS);
  }

  fault(text: string, hints: string[] = []): void {
    this.add('fault', text, hints);
  }

  /** What a refused request says; `hintsOf`: which of its hints. */
  problem(error: unknown, hintsOf = (hints: string[]) => hints): void {
    if (error instanceof Problem) this.fault(error.isNotBuilt ? t('common.notBuilt') : error.detail, hintsOf(error.hints));
    else this.fault(String(error));
  }

  close(id: number): void {
    this.list = this.list.filter((toast) => toast.id !== id);
  }

  private add(kind: Toast['kind'], text: string, hints: string[]): number {
    const id = ++this.last;
    this.list = [...this.list, { id, kind, text, hints }].slice(-MOST);
    return id;
  }
}

export const toasts = new Toasts();
