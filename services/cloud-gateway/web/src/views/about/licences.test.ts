import { readdirSync, readFileSync } from 'node:fs';
import { expect, it } from 'vitest';
import { parts } from './licences';

interface Locked { version: string; license?: string; dependencies?: Record<string, string> }
const locked = (JSON.parse(readFileSync('package-lock.json', 'utf8')) as { packages: Record<string, Locked> }).packages;

/** The packages that the page's own files import, but for tests and types. */
function imported(): Set<string> {
  const files = readdirSync('src', { recursive: true, encoding: 'utf8' }).filter((name) => /\.(ts|svelte)$/.test(name) && !name.endsWith('.test.ts'));
  const names = files.flatMap((name) => [...readFileSync(`src/${name}`, 'utf8').matchAll(/^\s*(?:import|export)\s(?!type\b)(?:[^'\n]*\sfrom\s)?'([^'.][^']*)'/gm)].map((found) => found[1]!));
  return new Set(names.map((name) => name.split('/').slice(0, name.startsWith('@') ? 2 : 1).join('/')));
}

it('names each part with the version and the licence that are locked', () => {
  for (const part of parts) {
    const is = locked[`node_modules/${part.name}`];
    expect([part.name, is?.version, is?.license]).toEqual([part.name, part.version, part.licence]);
  }
});

it('names every package that the page imports', () => {
  const named = new Set(parts.map((part) => part.name));
  expect([...imported()].filter((name) => !named.has(name))).toEqual([]);
  expect(imported()).toContain('svelte');
});
