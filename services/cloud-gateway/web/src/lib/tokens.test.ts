import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';

const css = readFileSync(new URL('./tokens.css', import.meta.url), 'utf8');

function colours(theme: 'light' | 'dark'): Record<string, string> {
  const block = new RegExp(`data-theme='${theme}'\\] \\{([^}]*)\\}`).exec(css)?.[1] ?? '';
  return Object.fromEntries([...block.matchAll(/--([\w-]+): (#[0-9a-f]{6});/g)].map((m) => [m[1]!, m[2]!]));
}

/** WCAG 2.2, relative luminance. */
function luminance(colour: string): number {
  const parts = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255);
  const [r, g, b] = parts.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)) as [number, number, number];
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: string, b: string): number {
  const [dark, light] = [luminance(a), luminance(b)].sort((x, y) => x - y) as [number, number];
  return (light + 0.05) / (dark + 0.05);
}

const grounds = ['ground', 'surface', 'raised'];
const texts = ['text', 'text-muted', 'focus', 'stale', 'stopped', 'alarm-critical'];
const pairs: [string, string, number][] = [
  ...texts.flatMap((text) => grounds.map((ground): [string, string, number] => [text, ground, 4.5])),
  ...['critical', 'urgent', 'warning'].map((p): [string, string, number] => [`on-alarm-${p}`, `alarm-${p}`, 4.5]),
  ['on-stopped', 'stopped', 4.5],
  ['on-focus', 'focus', 4.5],
  ['text', 'selected', 4.5],
  ['text-muted', 'selected', 4.5],
  ['line', 'raised', 3],
  ['shape', 'ground', 3],
  ...[1, 2, 3, 4].map((n): [string, string, number] => [`chart-${n}`, 'surface', 3]),
];

describe.each(['light', 'dark'] as const)('the %s theme', (theme) => {
  const has = colours(theme);
  it.each(pairs)('shows %s on %s with a contrast of at least %d', (text, ground, least) => {
    expect(contrast(has[text]!, has[ground]!)).toBeGreaterThanOrEqual(least);
  });
});

describe('the themes', () => {
  it('have the same names', () => {
    expect(Object.keys(colours('dark'))).toEqual(Object.keys(colours('light')));
  });
});
