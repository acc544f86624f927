/** A value that changes often, for what need not follow each change. */
import { Calm } from './calm';

/** `now`: the newest value, but no sooner than so many ms after the last change that was shown; 0: at once. */
export function calmed<Value>(source: () => Value, waitOf: (value: Value) => number): { readonly now: Value } {
  let shown = $state.raw(source());
  const calm = new Calm<Value>((value) => (shown = value));
  $effect.pre(() => {
    const value = source();
    calm.take(value, waitOf(value), performance.now());
  });
  $effect(() => () => calm.stop());
  return {
    get now() {
      return shown;
    },
  };
}
