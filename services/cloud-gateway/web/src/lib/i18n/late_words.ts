/** A view that imports this has the late words. */
import { late as english } from './en/late';
import { late as french } from './fr/late';
import { asShown, languages } from './i18n.svelte';

for (const [words, more] of [[languages.en.words, english], [languages.fr.words, asShown('fr', french)]] as const) {
  for (const [section, of] of Object.entries(more)) Object.assign(words[section as keyof typeof more], of);
}
