/** A simulation in words. */
import type { Key } from '../../lib/i18n/en';
import { formatNumber, t, tOr } from '../../lib/i18n/i18n.svelte';
import type { LateFault } from './plan_end';
import { faultCount, type Simulation } from './plan_job';

/** "5 robots, 9 tasks, TalkRoBots, Wi-Fi, 1 fault"; of a scenario its name first, and how many are beside it. */
export function titleOf({ job, robots, tasks, scenario, beside = [] }: Simulation): string {
  const faults = faultCount(job);
  return [
    scenario === undefined ? '' : t('plan.named', { name: scenario }), beside.length === 0 ? '' : t('plan.besideMore', { count: beside.length }), t('plan.fleet', { robots, tasks }),
    tOr('plan', `protocol_${job.protocol ?? 'paper'}`),
    job.protocol === 'talkrobots' ? tOr('plan', `link_${typeof job.link === 'object' ? 'own' : (job.link ?? 'lan')}`) : '', faults > 0 ? t('plan.withFaults', { count: faults }) : '',
    job.seed === undefined ? '' : t('plan.ofSeed', { seed: job.seed }),
  ].filter((part) => part !== '').join(', ');
}

/** "a link is cut: r0 – r1". */
export function faultText({ fault, place }: LateFault): string {
  if (fault === null) return t('plan.faultNumber', { number: place + 1 });
  const whom = fault.nodes?.join(', ') ?? [fault.node ?? '', fault.other ?? ''].filter((id) => id !== '').join(' – ');
  return t('plan.faultAt', { what: tOr('plan', `goes_${fault.kind}`), whom });
}

/** What is wrong with a field. */
export function sayWrong(wrong: { why: string; min?: number; max?: number }): string {
  const { why, min = 0, max = 0 } = wrong;
  return t(`plan.wrong_${why}` as Key, { min, max });
}

export function bytesOf(bytes: number): string {
  if (bytes < 1000) return `${formatNumber(bytes, 0)} B`;
  return bytes < 1e6 ? `${formatNumber(bytes / 1000, 1)} kB` : `${formatNumber(bytes / 1e6, 1)} MB`;
}
