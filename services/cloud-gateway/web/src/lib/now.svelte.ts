/** What time it is, by the gateway's clock, told anew each second as long as the component that asks is shown. */
import { onDestroy } from 'svelte';
import { live } from './live/live.svelte';

const SECOND_MS = 1000;

/** In milliseconds since 1970. Only while a component is being made. */
export function useNow(): { readonly ms: number } {
  let ms = $state(live.utcMs());
  const timer = setInterval(() => (ms = live.utcMs()), SECOND_MS);
  onDestroy(() => clearInterval(timer));
  return {
    get ms() {
      return ms;
    },
  };
}
