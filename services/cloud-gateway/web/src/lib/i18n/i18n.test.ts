import { describe, expect, it } from 'vitest';
import { en } from './en';
import { late as lateEn } from './en/late';
import { fr } from './fr';
import { late as lateFr } from './fr/late';

function flat(words: Record<string, Record<string, string>>): Map<string, string> {
  return new Map(Object.entries(words).flatMap(([section, of]) =>
    Object.entries(of).map(([key, text]): [string, string] => [`${section}.${key}`, text])));
}

const places = (text: string) => [...text.matchAll(/\{(\w+)\}/g)].map((match) => match[1]).sort();

describe('the languages', () => {
  const [english, french] = [new Map([...flat(en), ...flat(lateEn)]), new Map([...flat(fr), ...flat(lateFr)])];

  it('have the same keys', () => {
    expect([...french.keys()].sort()).toEqual([...english.keys()].sort());
  });

  it.each([...english.keys()])('%s: has words, and the same values are filled in', (key) => {
    expect(english.get(key)).not.toBe('');
    expect(french.get(key)).not.toBe('');
    expect(places(french.get(key) ?? '')).toEqual(places(english.get(key) ?? ''));
  });
});
