import { onDestroy } from 'svelte';

/** The address after '#': #/robots/ur3 is the view `robots` with the part `ur3`. */
class Router {
  parts = $state<string[]>(partsOf(location.hash));

  constructor() {
    addEventListener('hashchange', () => (this.parts = partsOf(location.hash)));
  }
}

export function partsOf(hash: string): string[] {
  return hash.replace(/^#\/?/, '').split('/').filter((part) => part !== '').map(decoded);
}

/** The address of a view: hrefOf('robots', 'ur3'). */
export function hrefOf(...parts: string[]): string {
  return `#/${parts.map(encodeURIComponent).join('/')}`;
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part; // a wrong escape that somebody has typed
  }
}

export const router = new Router();

export function go(...parts: string[]): void {
  location.hash = hrefOf(...parts);
}

/**
 * go() for an answer that comes when it comes: who has left the component meanwhile stays where he is. True: he was
 * moved. Only while a component is being made.
 */
export function useGo(): (...parts: string[]) => boolean {
  let isHere = true;
  onDestroy(() => (isHere = false));
  return (...parts) => {
    if (isHere) go(...parts);
    return isHere;
  };
}
