/** Looks at the live rows for what has become of the stop. Apart from the stop itself, which depends on none of it. */
import { untrack } from 'svelte';
import type { RobotContent } from '../api/types';
import { live, rowsOf, useTopic } from '../live/live.svelte';
import { useNow } from '../now.svelte';
import { stopAll } from './stop_all.svelte';

/** Only while a component is being made; as long as that is shown. */
export function watchStop(): void {
  const fleet = useTopic('fleet');
  const now = useNow();
  $effect(() => {
    const rows = rowsOf<RobotContent>(fleet.rows, 'robot');
    const isLive = fleet.isKnown && !live.isLost;
    const ms = now.ms;
    untrack(() => stopAll.see(rows, ms, isLive));
  });
}
