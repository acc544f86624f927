/** What time it is, told anew each second as long as the component that asks is shown. */
import { onDestroy } from 'svelte';

const SECOND_MS = 1000;

/** In milliseconds since 1970. Only while a component is being made. */
export function useNow(): { readonly ms: number } {
  let ms = $state(Date.now());
  const timer = setInterval(() => (ms = Date.now()), SECOND_MS);
  onDestroy(() => clearInterval(timer));
  return {
    get ms() {
      return ms;
    },
  };
}
