/** One part of the settings: read with its version, sent back with it; what is wrong stands at its field. */
import { api, Problem } from '../../lib/api/client';
import { t } from '../../lib/i18n/i18n.svelte';
import { toasts } from '../../lib/toasts.svelte';

export interface Read<T> {
  data: T;
  etag: string;
}

export async function readPart<T>(path: string, signal: AbortSignal): Promise<Read<T>> {
  const { data, etag } = await api.send<T>('GET', path, { signal });
  return { data, etag };
}

/** The service reads its file anew: so long may it take until it is up again. */
const IN_FORCE_MS = 20_000;

export class Part {
  isBusy = $state(false);
  private problem = $state.raw<Problem | null>(null);

  constructor(
    private readonly path: string,
    private readonly saved: () => void,
  ) {}

  /** What is wrong with a member, by its JSON pointer. */
  at(pointer: string): string {
    return (this.problem?.at(pointer) ?? []).map((one) => `${one.detail}. ${one.hint}`).join(' ');
  }

  /** What is wrong with no field of the form. */
  otherThan(pointers: string[]): string[] {
    return (this.problem?.faults ?? [])
      .filter((one) => !pointers.includes(one.pointer))
      .map((one) => `${one.pointer} ${one.detail}. ${one.hint}`.trim());
  }

  async save(body: unknown, etag: string): Promise<void> {
    this.isBusy = true;
    try {
      await api.send('PUT', this.path, { body, ifMatch: etag, withinMs: IN_FORCE_MS });
      this.problem = null;
      toasts.done(t('settings.inForce'));
      this.saved();
    } catch (problem) {
      this.problem = problem instanceof Problem && problem.status === 422 ? problem : null;
      if (problem instanceof Problem && problem.status === 412) toasts.fault(t('settings.changed'));
      else toasts.problem(problem);
      // The file is written, and has a new version.
      if (problem instanceof Problem && problem.code === 'not_in_force') this.saved();
    }
    this.isBusy = false;
  }
}
